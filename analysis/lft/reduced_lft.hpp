#pragma once

#include <titop/analysis/lft/lft.hpp>
#include <titop/analysis/reduction/reduced_system.hpp>

namespace titop {

/// An Lft whose M has fewer states, and the error of M. Const.
///
/// On the scene's ray, at frequencies of its band, |E| <= bound().pairs * bound().peak for every
/// entry of E = M - M_r, by theorem or, by default, as an estimate between samples
/// (ErrorBound::kind): M from [w; u] to [z; y], w and z of the normalised deltas. The bound of the
/// closed model H (`error`) follows from it by algebra, and is an estimate if bound() is:
///
///     H - H_r = [M_r,yw Delta N_r, I] E [Delta N M_zu; I],  N = (I - M_zw Delta)^-1, N_r likewise,
///
/// taken entry by entry with Neumann's series for N [small gain theorem: Zhou, Doyle, Glover 1996,
/// ch. 9]. It is infinite where the series does not converge, such as near poles that the
/// parameters move through the frequency, and not valid outside of the band.
class ReducedLft {
 public:
  /// The one with the reduced M: occurrences, maps and names as before; without lower bounds.
  const Lft& lft() const { return lft_; }
  /// Of M: outputs [z; y], inputs [w; u], in the order of lft().m().
  const ErrorBound& bound() const { return bound_; }
  const Scene& scene() const { return scene_; }
  /// The s of the scene's ray at omega [rad/s]: (zeta + j sqrt(1 - zeta^2)) omega.
  std::complex<double> on_ray(double omega) const;

  /// Bound of |H - H_r|, outputs x inputs, at on_ray(omega) for all |delta| <= 1 together:
  /// Neumann's series for |M_r,zw| + bound of |E_zw|. Infinite if its spectral radius is not below
  /// 1: the parameters' loop gain is too large there for a statement about all of them. Throws
  /// bad_value for an omega outside of the band. O(occurrences^3).
  Eigen::MatrixXd error(double omega) const;
  /// The same at these values alone, with N_r as it is: Neumann's series is that of Delta N_r E.
  /// Infinite if its spectral radius is not below 1. Throws as Lft::at, and singular if that s is a
  /// pole there.
  Eigen::MatrixXd error(double omega, const ParameterList& values) const;

 private:
  friend ReducedLft reduce(const Lft&, const Scene&, const Options&);
  ReducedLft(Lft lft, ErrorBound bound, Scene scene)
      : lft_(std::move(lft)), bound_(std::move(bound)), scene_(std::move(scene)) {}
  /// |M_r| and the bound of |E| at on_ray(omega).
  struct Sizes;
  Sizes sizes(double omega) const;

  Lft lft_;
  ErrorBound bound_;
  Scene scene_;
};

/// Reduces M over the band and to the accuracy of the scene, w and z among its inputs and outputs
/// (Scene::inputs and outputs name some of u and y; empty: all). As `compile(diagram, scene)` of
/// one Lti with M's matrices: its states are balanced, unless M has uncoupled modal blocks. Every
/// pair of w and z is kept to the accuracy of its own size, which may leave little to reduce: few
/// parameters in many modes are the case for it. Throws unknown_name; bad_value for an accuracy
/// that cannot be met; singular for a pole of M at 0 (a free position that is read) in a band from
/// 0. O(100 states^3) and some hundred transfers of M.
///
///     const ReducedLft r = reduce(lft(system, ranges), {.band_hz = {0.01, 2}, .accuracy = 1e-4});
ReducedLft reduce(const Lft& f, const Scene& scene, const Options& options = {});

}  // namespace titop
