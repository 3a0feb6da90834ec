#pragma once

#include <functional>
#include <string>
#include <titop/compiler/system/system.hpp>
#include <utility>
#include <vector>

namespace titop {

/// How all interfaces of many nodes in a scene follow their nodes: `constrained` by fe::rigid and
/// fe::shapes, or `released`, by fe::average and fe::moments.
enum class Lumping { constrained, released };

/// Options of `interface_bracket`.
struct BracketOptions {
  int modes = 6;  ///< frequencies, of the slowest elastic modes
  /// Pairs of an input and an output, counted from 0, that are a force and the displacement of the
  /// same point along it (or a torque and its angle): their static compliance.
  std::vector<std::pair<int, int>> compliances = {};
  /// Frequencies at which the transfers are compared [rad/s]; none: they are not.
  std::vector<double> omega = {};
};

/// Bounds of the scene in which every node of an interface has its own joint, by two models with
/// lumped interfaces; their width is the error of lumping.
struct InterfaceBracket {
  struct Interval {
    double below = 0, above = 0;
    double width() const { return above - below; }
  };
  std::vector<Interval> omega;       ///< [rad/s], ascending
  std::vector<Interval> compliance;  ///< as BracketOptions::compliances [m/N, rad/(N m)]
  /// Largest difference of an entry of both transfers at these frequencies, relative to the entry's
  /// largest value there. An estimate of the error, no bound.
  double transfer_difference = 0;
};

/// Compiles the scene with both lumpings, of the same meshes. A theorem [Courant and Hilbert,
/// *Methods of Mathematical Physics* 1, VI]: constraints raise, and releases lower, each natural
/// frequency of an undamped structure, in ascending order, and each static stiffness. It applies to
/// meshes with all their modes (a few modes with residual vectors change the bounds by their own
/// error). Damping, also that of the bodies' modes, changes |s| in second order of its ratio: leave
/// it out if the intervals are not wide beside that.
///
/// Throws the errors of `scene` and `compile`; bad_value if the two have different inputs or
/// outputs or numbers of motions without stiffness, or less than `modes` modes, for a pair that
/// is not there, for real poles (filters, modes damped beyond critical), if all intervals have the
/// width 0 (the scene does not use its argument), and if an interval would be negative: the theorem
/// does not apply to this scene (bodies without most of their modes, laws in the loop, pairs of
/// different points); singular if a compliance is that of a free structure. Cost of the poles:
/// O(n^3) for n states, twice.
///
///     const InterfaceBracket b = interface_bracket([](Lumping l) { return wing(l); });
InterfaceBracket interface_bracket(const std::function<Diagram(Lumping)>& scene,
                                   const BracketOptions& options = {});

/// One frequency [Hz] per line with its relative width, then compliances and the difference.
std::string to_string(const InterfaceBracket& bracket);

}  // namespace titop
