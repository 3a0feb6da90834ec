#pragma once

#include <span>
#include <titop/analysis/lft/ranges.hpp>
#include <titop/compiler/system/system.hpp>

/// Parameters isolated from the model: y = F(s, delta) u as a linear fractional transformation,
///
///     xdot = A x + B [w; u],   [z; y] = C x + D [w; u],   w = Delta z,
///
/// Delta = diag(delta_1 I, ..., delta_q I) with delta_i in [-1, 1] for the range of parameter i, 0
/// at its nominal value [Zhou, Doyle, Glover 1996, ch. 10]; co-design as in [Alazard 2015].
namespace titop {

namespace detail {
struct IsolatedParameter;
struct Structured;
}  // namespace detail

class ReducedLft;
struct Scene;

/// A parameter in an Lft.
struct Delta {
  std::string parameter;
  int first = 0;  ///< of its w among [w; u], and of its z among [z; y]
  int size = 0;   ///< occurrences: an upper bound of the least possible number
  int built = 0;  ///< occurrences before the reduction
  /// Lower bound of the least number: the degree of the transfer in this parameter at random values
  /// of the others and of s, in exact arithmetic. 0 if it was not computed (Lft::not_decided): a
  /// closed chain, more than 200 states or 4000 unknowns.
  int at_least = 0;
  ParameterMap map;
  std::vector<std::string> where;  ///< blocks and equations with it: "hub", "wing.parent.accel"

  /// No realization has fewer occurrences of it, whatever the others have.
  bool minimal() const { return size == at_least; }
};

/// Singular values on both sides of the rank decisions of the reduction, relative to their rows.
struct RankMargin {
  double kept = 1;     ///< the smallest one taken for a direction
  double dropped = 0;  ///< the largest one taken for 0
};

/// Result of `lft`. Const, cheap to read; may be shared between threads.
class Lft {
 public:
  /// M in the units of the diagram: inputs [w; u], outputs [z; y].
  const StateSpace& m() const { return m_; }
  const std::vector<Delta>& deltas() const { return deltas_; }
  int occurrences() const;  ///< of all parameters: the size of w
  /// Lower bound of the order; 0 if it was not computed (more than 60 states and occurrences).
  int states_at_least() const { return states_at_least_; }
  /// The model with its parameters as inputs and outputs before reduction and normalisation: w is
  /// a deviation times z.
  const System& opened() const { return opened_; }
  const RankMargin& rank_margin() const { return margin_; }
  /// Why there are no lower bounds: "" if there are.
  const std::string& not_decided() const { return not_decided_; }

  /// The model with Delta closed at these values; parameters not named are at their nominal ones.
  /// Equal to System::update(values).state_space() as a transfer, computed another way. Throws
  /// unknown_name, duplicate_name, bad_value outside of the range, singular at a pole of F(.,
  /// delta) with direct terms (I - D_zw Delta singular). Values are not checked by the blocks:
  /// `lft` has checked the corners of the ranges, and a matrix that depends linearly on the
  /// parameters is definite between the corners if it is definite at all of them. O((states +
  /// occurrences)^3).
  StateSpace at(const ParameterList& values) const;
  /// The transfer at s with Delta closed at each of these values, as of `at`: M(s) once,
  /// O(occurrences^3) for each. For worst cases over many designs. Throws as `at`, and singular if
  /// s is a pole at nominal values or at one of these, which the message has.
  std::vector<Eigen::MatrixXcd> transfers(std::complex<double> s,
                                          std::span<const ParameterList> values) const;

 private:
  friend Lft lft(const System&, const ParameterRanges&);
  friend ReducedLft reduce(const Lft&, const Scene&, const Options&);
  friend class ReducedLft;
  explicit Lft(System opened) : opened_(std::move(opened)) {}
  void take(detail::Structured model);
  /// M with fewer states, its pairs as they are.
  void take_reduced(StateSpace m);
  /// At all pairs.
  Eigen::VectorXd deltas_at(const ParameterList& values) const;
  void find_lower_bounds(const std::vector<detail::IsolatedParameter>& parameters);

  System opened_;
  StateSpace m_;
  std::vector<Delta> deltas_;
  int states_at_least_ = 0;
  RankMargin margin_;
  std::string not_decided_;
};

/// Isolates parameters, at the system's present values as nominal ones.
///
/// Occurrences: those of the blocks (Block::opened) and of the factors of equations
/// (compiler/passes/open/open.hpp), then reduced over states and parameters together: least
/// subspaces of x and of every z that u can reach, then those that y sees, in turn until nothing
/// changes. The result is minimal among realizations for parameters that may vary in time; for
/// constant ones fewer may do where the lower bound is smaller [Beck, Doyle 1999; D'Andrea, Khatri
/// 1997]. Ranks are those of singular values above 1e-9 of their rows, in the invariant subspaces
/// of the poles (`rank_margin()`). If the reduced model differs from the other one by 1e-9 at some
/// points, or has fewer occurrences than a lower bound, the model before reduction is kept: `size`
/// equals `built` then.
///
/// Throws unknown_name, duplicate_name; bad_value for a range without the nominal value inside, for
/// one at whose end a block refuses the value (the others at nominal ones), for corners that a
/// block of several parameters refuses (the first twelve at all their ends, more ones at their
/// least values), for an angle half a turn away without `full_turn`, and for `full_turn` of a
/// number; not_rational for a block without `opened`, an angle or a length that moves a closed
/// chain, an angle that is a fraction of its parameter; ill_posed if I - D_zw Delta is singular at
/// a corner of the ranges (the first twelve parameters at all their ends, more ones at their least
/// values), or on the line from the nominal values to it. Cost: that of
/// `compile`, O((states + occurrences)^3), and for the lower bounds some solutions of that size in
/// exact arithmetic: 0.1 s for 12 states and 25 occurrences.
///
///     const Lft f = lft(compile(d), {{"m", percent(20)}, {"tilt", between(-1.2, 1.9)}});
Lft lft(const System& system, const ParameterRanges& ranges);

/// A table: occurrences, lower bound ("minimal" only if both are equal), range and map of each
/// parameter.
std::string to_string(const Lft& f);

}  // namespace titop
