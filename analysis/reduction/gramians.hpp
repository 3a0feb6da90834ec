#pragma once

#include <titop/analysis/reduction/split.hpp>

/// Balanced coordinates of a stable part. For the library's own files only.
namespace titop::detail {

/// A stable model in balanced coordinates: both Gramians are diag(sigma). The first r coordinates
/// form a model, as do the first r with the others at rest (below).
struct Balancing {
  Eigen::MatrixXd A, B, C;
  Eigen::VectorXd sigma;        ///< Hankel singular values, descending, down to rounding
  Eigen::MatrixXd left, right;  ///< z = left x, x = right z, of the split model's states
  bool weighted = false;        ///< behind low-passes: sigma is no bound
};

/// Sizes by which inputs and outputs are scaled to 1.
struct PortSizes {
  Eigen::VectorXd input, output;
};

/// Balances split.stable, inputs and outputs over their sizes, by square roots: Gramians P = L L',
/// Q = R R' as factors from Hammarling's method, sigma and the projection from the singular values
/// of R' L [Laub et al. 1987; Tombs, Postlethwaite 1987]. With `corner` > 0 [rad/s] each input and
/// output passes a low-pass corner^2 / (s^2 + sqrt(2) corner s + corner^2) first, which gives
/// frequencies far above the corner little weight [Enns 1984]. O(10 n^3).
Balancing balance(const Split& split, const PortSizes& sizes, double corner = 0);

/// The model of the first r coordinates. Truncated: the others are 0, exact at infinite frequency;
/// otherwise the others are at rest, A_22 z_2 + A_21 z_1 + B_2 u = 0 (singular perturbation), exact
/// at 0. Both are stable if sigma(r - 1) > sigma(r), and wrong by 2 (sigma(r) + sigma(r + 1) +
/// ...) at most, on the axis and everywhere right of it, for both are analytic there and the error
/// is largest on the axis [Enns, Glover 1984; Liu, Anderson 1989]; not so if `weighted`.
struct Cut {
  SpectralPart part;
  Eigen::MatrixXd D;  ///< direct term with the residual of the others
};
Cut cut(const Balancing& balancing, Eigen::Index r, bool truncated);

/// 2 (sigma(r) + sigma(r + 1) + ...), from the smallest up.
double cut_bound(const Balancing& balancing, Eigen::Index r);

}  // namespace titop::detail
