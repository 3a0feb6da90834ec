#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <titop/compiler/passes/moves_points.hpp>
#include <titop/compiler/passes/open/differences.hpp>
#include <titop/graph/closed_form.hpp>
#include <titop/graph/linalg/index.hpp>
#include <titop/graph/linalg/rounding.hpp>
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

constexpr double kStep = 0x1p-8;

/// A power of two: value + step and value - step are then exact.
double step_of(double value) { return value == 0 ? kStep : std::ldexp(kStep, std::ilogb(value)); }

/// Largest error of a row of the derivative by the estimate of extrapolation, relative to the row.
using linalg::kWarn;

/// A derivative of [A, B; C, D], or why it is not known.
struct BlockDerivative {
  MatrixXd derivative;
  std::optional<Mistake> why_not;
};

BlockDerivative unknown(std::string why, std::string hint) {
  return {{}, Mistake{Code::not_rational, std::move(why), {}, std::move(hint)}};
}

/// `error` is small for each row of the derivative, or as small as rounding of the block's own row
/// makes it at this step.
bool is_small(const MatrixXd& error, const MatrixXd& derivative, const MatrixXd& matrix,
              double step) {
  for (Index i = 0; i < error.rows(); ++i)
    if (!(error.row(i).norm() <= kWarn * derivative.row(i).norm() +
                                     linalg::kProductRounding * matrix.row(i).norm() / step))
      return false;
  return true;
}

/// Derivative of [A, B; C, D] by the parameter; unknown if it moves points, if values near it are
/// refused, or if the extrapolation does not converge.
BlockDerivative by_differences(const Block& block, ParameterValues given, int parameter) {
  if (closed_form_of(block))
    return unknown("its transfer is a closed form, and it has no matrices", "use sweep");
  std::vector<double> values(given.begin(), given.end());
  double& p = values[at(parameter)];
  const double here = p, step = step_of(here);
  bool moves = false;
  const auto central = [&](double h) {
    p = here + h;
    moves = moves || moves_points(block, given, values);
    const MatrixXd more = matrices(*block.dynamics(values));
    p = here - h;
    return MatrixXd((more - matrices(*block.dynamics(values))) / (2 * h));
  };
  try {
    const MatrixXd a = central(step), b = central(step / 2), c = central(step / 4);
    const MatrixXd ab = (4 * b - a) / 3, bc = (4 * c - b) / 3, all = (16 * bc - ab) / 15;
    if (moves)
      return unknown("it moves the block's points",
                     "give Opened::motions (OpenedPair::moves), or use sweep");
    if (is_small(all - bc, all, matrices(*block.dynamics(given)), step / 4)) return {all, {}};
    return unknown(
        fmt::format("its matrices are not smooth in it: differences at steps of {:.3g}, {:.3g} and "
                    "{:.3g} do not agree to {:.0e}",
                    step, step / 2, step / 4, kWarn),
        "write Block::opened for it, or use sweep");
  } catch (const Error& error) {
    const Mistake& m = error.mistakes().front();
    return unknown(
        fmt::format("at a distance of {:.3g} or less from {:.6g} it is refused: {}", step, here,
                    m.message),
        "write Block::opened for it, or take a value farther inside of its range; " + m.hint);
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
      if (const BlockDerivative d = by_differences(block, values, p); !d.why_not)
        add_pairs(*o, d.derivative, p);
  return o;
}

std::optional<Mistake> why_no_differences(const Block& block, ParameterValues values,
                                          int parameter) {
  return by_differences(block, values, parameter).why_not;
}

}  // namespace titop::passes
