#include <algorithm>
#include <cmath>
#include <titop/compiler/passes/open/differences.hpp>
#include <titop/graph/error.hpp>
#include <titop/graph/linalg/index.hpp>
#include <titop/graph/opened.hpp>

namespace titop::passes {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using linalg::at;

/// [A, B; C, D]
MatrixXd matrices(const Dynamics& d) {
  MatrixXd m(d.A.rows() + d.C.rows(), d.A.cols() + d.B.cols());
  m << d.A, d.B, d.C, d.dense_direct();
  return m;
}

bool moves_points(const Block& block, ParameterValues a, ParameterValues b) {
  const auto before = block.kinematics(a), now = block.kinematics(b);
  return before && (before->tau != now->tau || before->Phi != now->Phi);
}

constexpr double kStep = 0x1p-8;

double step_of(double value) { return kStep * (value == 0 ? 1 : std::abs(value)); }

/// Derivative of [A, B; C, D] by the parameter; none if it moves points, or if values near it are
/// refused.
std::optional<MatrixXd> by_differences(const Block& block, ParameterValues given, int parameter) {
  std::vector<double> values(given.begin(), given.end());
  double& p = values[at(parameter)];
  const double here = p, step = step_of(here);
  const auto central = [&](double h) {
    p = here + h;
    const bool moves = moves_points(block, given, values);
    const MatrixXd more = matrices(*block.dynamics(values));
    p = here - h;
    if (moves) throw Error(Code::not_rational, "", "");
    return MatrixXd((more - matrices(*block.dynamics(values))) / (2 * h));
  };
  try {
    const MatrixXd a = central(step), b = central(step / 2), c = central(step / 4);
    const MatrixXd ab = (4 * b - a) / 3, bc = (4 * c - b) / 3;
    return (16 * bc - ab) / 15;
  } catch (const Error&) {
    return std::nullopt;
  }
}

/// The pairs of a derivative: one per row of it that is not 0.
void add_pairs(Opened& o, const MatrixXd& derivative, int parameter) {
  Dynamics& d = o.dynamics;
  const Index n = d.A.rows(), more = static_cast<Index>(o.parameter.size()), nu = d.B.cols() - more;
  for (Index i = 0; i < derivative.rows(); ++i) {
    if (derivative.row(i).isZero(0)) continue;
    d.B.conservativeResize(n, d.B.cols() + 1), d.C.conservativeResize(d.C.rows() + 1, n);
    d.D.conservativeResize(d.D.rows() + 1, d.D.cols() + 1);
    d.B.rightCols(1).setZero(), d.D.rightCols(1).setZero(), d.D.bottomRows(1).setZero();
    d.C.bottomRows(1) = derivative.row(i).head(n);
    d.D.bottomRows(1).leftCols(nu) = derivative.row(i).tail(nu);
    if (i < n)
      d.B(i, d.B.cols() - 1) = 1;
    else
      d.D(i - n, d.D.cols() - 1) = 1;
    o.parameter.push_back(parameter);
  }
}

}  // namespace

bool moves_points_unsaid(const Block& block, ParameterValues given, int parameter) {
  std::vector<double> values(given.begin(), given.end());
  values[at(parameter)] += step_of(values[at(parameter)]);
  if (!moves_points(block, given, values)) return false;
  const auto o = block.opened(given, std::span(&parameter, 1));
  return !o || o->motions.empty();
}

bool is_opened_by(const Block& block, ParameterValues values, int parameter) {
  const auto o = block.opened(values, std::span(&parameter, 1));
  return o && !o->parameter.empty();
}

std::optional<Opened> opened_to_first_order(const Block& block, ParameterValues values,
                                            std::span<const int> parameters, bool differences) {
  std::optional<Opened> o = block.opened(values, parameters);
  if (!differences) return o;
  if (!o) o = with_pairs(*block.dynamics(values), {}, parameters);
  for (const int p : parameters)
    if (std::find(o->parameter.begin(), o->parameter.end(), p) == o->parameter.end())
      if (const auto derivative = by_differences(block, values, p)) add_pairs(*o, *derivative, p);
  return o;
}

}  // namespace titop::passes
