#include <algorithm>
#include <titop/compiler/realization/proportional.hpp>
#include <titop/graph/linalg/rounding.hpp>

namespace titop {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

/// Eigenvectors of one frequency may be rotated: takes those that diagonalise the damping, if it is
/// symmetric.
void turn_by_damping(const MatrixXd& Z, GradedModes& e) {
  for (const auto& [first, count] : equal_frequencies(e, linalg::kSameFrequency)) {
    if (count == 1) continue;
    auto V = e.modes.V.middleCols(first, count);
    const MatrixXd in = V.transpose() * Z * V;
    const double size = in.cwiseAbs().maxCoeff(),
                 skew = (in - in.transpose()).cwiseAbs().maxCoeff();
    if (skew <= linalg::kMatrixDigits * size) V = (V * eigh((in + in.transpose()) / 2).V).eval();
  }
}

}  // namespace

std::vector<ModeRange> equal_frequencies(const GradedModes& e, double same) {
  const VectorXd& lambda = e.modes.lambda;
  const double all_alike = 100 * linalg::kEpsilon * lambda.cwiseAbs().maxCoeff();
  std::vector<ModeRange> result;
  for (Index i = 0; i < lambda.size(); ++i) {
    const double size = std::abs(lambda(i));
    const double rounding = e.graded ? std::min(all_alike, 4 * e.relative * size) : all_alike;
    if (i == 0 || lambda(i) - lambda(i - 1) > rounding + same * size)
      result.push_back({i, 1});
    else
      ++result.back().count;
  }
  return result;
}

std::optional<ProportionalModes> proportional_modes(const SecondOrder& form) {
  GradedModes e = eigh_graded(form.S);
  std::optional<VectorXd> z = diagonal_in(e, form.Z);
  if (!z) {
    turn_by_damping(form.Z, e);
    z = diagonal_in(e, form.Z);
  }
  if (!z || !symmetric_in(e, form.S, form.skew)) return std::nullopt;
  return ProportionalModes{std::move(e), std::move(*z)};
}

}  // namespace titop
