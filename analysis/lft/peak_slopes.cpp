#include <fmt/format.h>

#include <cmath>
#include <numeric>
#include <titop/analysis/lft/paths.hpp>
#include <titop/graph/error.hpp>
#include <titop/graph/linalg/rounding.hpp>

namespace titop {
namespace {

using Eigen::Index;

void require_simple(const HinfNorm& n) {
  if (!(n.value > 0))
    throw Error(Code::bad_value, "the largest gain is 0, where it has no derivatives",
                "take inputs and outputs that are connected");
  if (!n.others.empty())
    throw Error(
        Code::bad_value,
        fmt::format("two peaks are equal, at {:.9g} and {:.9g} rad/s: the larger one has no "
                    "derivative there",
                    n.omega, n.others.front()),
        "take one of them by band_hz, or both as two bounds");
  if (n.second >= (1 - linalg::kHalfDigits) * n.value)  // their vectors have no digits
    throw Error(Code::bad_value,
                fmt::format("two singular values are equal at {:.9g} rad/s, {:.9g} and {:.9g}: the "
                            "larger one has no derivative there",
                            n.omega, n.value, n.second),
                "take fewer inputs or outputs, or h2(), which is smooth");
}

}  // namespace

PeakSlopes Derivatives::peak(const HinfOptions& options) const {
  const Index ny = m_.D.rows() - all_pairs_, nu = m_.D.cols() - all_pairs_;
  const HinfNorm n = norm_hinf(system_.state_space(), options);
  require_simple(n);
  Paths M;
  if (std::isinf(n.omega)) {
    M.yw = m_.D.bottomLeftCorner(ny, all_pairs_), M.zu = m_.D.topRightCorner(all_pairs_, nu);
    M.yu = m_.D.bottomRightCorner(ny, nu);
  } else {
    std::vector<int> all(pairs_.size());
    std::iota(all.begin(), all.end(), 0);
    M = paths({0, n.omega}, all, false, true);
  }
  const Eigen::RowVectorXcd from_w = n.left.adjoint() * M.yw;
  const Eigen::VectorXcd to_z = M.zu * n.right;
  PeakSlopes result;
  result.omega = n.omega;
  result.value = (n.left.adjoint() * M.yu * n.right).value().real();
  result.slopes.resize(static_cast<Index>(pairs_.size()));
  for (Index i = 0; i < result.slopes.size(); ++i) {
    const Pairs& p = pairs_[static_cast<std::size_t>(i)];
    result.slopes(i) =
        p.slope * (from_w.segment(p.first, p.size) * to_z.segment(p.first, p.size)).value().real();
  }
  return result;
}

}  // namespace titop
