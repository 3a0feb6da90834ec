#pragma once

#include <complex>
#include <string>
#include <titop/analysis/norms/hinf.hpp>
#include <titop/compiler/system/system.hpp>
#include <titop/compiler/system/transfer_part.hpp>
#include <vector>

/// Exact derivatives of a model by its parameters, from the opened model (lft.hpp): with w and z of
/// parameter i and M(s) from [w; u] to [z; y],
///
///     dH/dp_i = M_yw_i M_z_iu,   d2H/dp_i dp_j = M_yw_i M_z_iw_j M_z_ju + M_yw_j M_z_jw_i M_z_iu.
///
/// No difference quotient is taken and no eigenvector is differentiated; only the slopes of poles
/// treat equal poles separately.
namespace titop {

/// A pole, or poles that are equal, and how fast they move with each parameter.
struct PoleSlopes {
  std::complex<double> s;  ///< [rad/s]
  int count = 1;           ///< equal poles
  /// Per parameter, in the order of Derivatives::parameters(): `count` slopes [rad/s per unit of
  /// the parameter], those of the poles into which the equal ones split. Empty for a defective
  /// pole, which has none.
  std::vector<Eigen::VectorXcd> slopes;
  bool defective = false;  ///< fewer eigenvectors than poles, as of a double integrator
};

/// A number and its derivatives by the parameters, in the order of Derivatives::parameters().
struct Slopes {
  double value = 0;
  Eigen::VectorXd slopes;
};

/// The largest gain over a band, and its derivatives.
struct PeakSlopes : Slopes {
  double omega = 0;  ///< where it is reached [rad/s]; infinite: of the direct term
};

/// Derivatives at the parameter values of the system from which it was made. Const, may be shared
/// between threads.
class Derivatives {
 public:
  const std::vector<std::string>& parameters() const { return names_; }
  /// Parameters of blocks without Block::opened, each with its block: "shaft of rotor". Their
  /// derivatives are those of the block's matrices by differences, never of the solved model: right
  /// to 1e-12 of an entry that changes by its own size over p, at worst to 1e-9 of the derivative's
  /// row or to 1e-11 of the matrices' row over p (compiler/passes/open/differences.hpp).
  const std::vector<std::string>& by_differences() const { return by_differences_; }
  /// The system with w and z among its inputs and outputs, from which all derivatives follow: its
  /// certificate() applies to them, with the list of by_differences().
  System opened() const { return System(opened_); }

  /// dH/dp at s, outputs x inputs [unit of H per unit of p]: the product of M_yw and M_zu, each
  /// accurate to 1e-12 of its blocks as System::transfer is. Throws unknown_name, and singular if s
  /// is a pole. (At s = 0, if a block has a pole there, from the dense model.) One factorisation,
  /// then solves of O(bodies) each: for M_zu one per input, or one per occurrence through the
  /// transposed factors, whichever are fewer; for M_yw one per output through the transposed
  /// factors, or one per occurrence. `cost`, if given, receives the counts.
  Eigen::MatrixXcd transfer(std::complex<double> s, const std::string& p,
                            TransferCost* cost = nullptr) const;
  /// dH/dp at s for all parameters, in their order, however many there are: one factorisation and
  /// three solves per input and per output (two of them estimate errors), more where digits are
  /// lost; factored again in finer arithmetic if double has no pivot.
  std::vector<Eigen::MatrixXcd> transfers(std::complex<double> s,
                                          TransferCost* cost = nullptr) const;
  /// d2H/dp dq at s, outputs x inputs; p and q may be the same. Errors as above; one solve per
  /// occurrence of both more. Throws not_rational for a parameter by differences, of which only the
  /// first derivative is known.
  Eigen::MatrixXcd transfer(std::complex<double> s, const std::string& p,
                            const std::string& q) const;
  /// dA, dB, dC, dD by p of the dense model before `minimize` (System::write), with its names.
  /// Throws unknown_name. O(states^2 occurrences of p).
  StateSpace matrices(const std::string& p) const;
  /// Poles of the dense model before `minimize` with their slopes, those of the upper half plane.
  /// Poles that rounding does not separate count as equal: their slopes are the eigenvalues of L'
  /// dA R, L' R = I, in their invariant subspace. O(states^3).
  std::vector<PoleSlopes> poles() const;
  /// H2 norm of the transfer (root mean square of the outputs under white noise of unit intensity),
  /// by two Lyapunov equations for all parameters together [Zhou, Doyle, Glover 1996, ch. 4].
  /// Throws singular if a pole is not left of the axis, or if there is a direct term here or at
  /// neighbouring values, or if the norm is 0. O(states^3).
  Slopes h2() const;
  /// The largest singular value of the transfer over a band (norm_hinf), with slopes Re(u^H dH v),
  /// u and v its singular vectors: the shift of the peak's frequency has no effect of first order.
  /// Found on System::state_space(): poles on the axis that no input reaches or no output sees do
  /// not count, unless omega itself is one. Throws as norm_hinf does (also for more than 600
  /// states), and bad_value where the peak has no derivative: two peaks of one height, or two equal
  /// singular values, up to 1.5e-8, or a gain that is constant over the band. Cost: that of
  /// state_space() once, and O(200 states^3) per level.
  PeakSlopes peak(const HinfOptions& options = {}) const;

 private:
  friend Derivatives derivatives(const System&, const std::vector<std::string>&);
  Derivatives(System system, std::shared_ptr<const detail::SystemData> opened)
      : system_(std::move(system)), opened_(std::move(opened)) {}
  struct Pairs {
    Eigen::Index first = 0, size = 0;
    double slope = 1;                  ///< of the deviation by the parameter: 1, of an angle 1/2
    bool exact = true;                 ///< all from Block::opened
    std::vector<int> inputs, outputs;  ///< ports of the opened graph
  };
  struct Paths;
  int index_of(const std::string& p) const;
  Paths paths(std::complex<double> s, const std::vector<int>& parameters, bool both = false,
              bool direct = false) const;
  Paths paths_of_factors(std::complex<double> s, const std::vector<int>& parameters, bool both,
                         bool direct) const;
  Paths paths_of_model(std::complex<double> s, const std::vector<int>& parameters) const;

  System system_;
  std::shared_ptr<const detail::SystemData> opened_;
  StateSpace m_;                        ///< of `opened_`, inputs [w; u], outputs [z; y]
  std::vector<Eigen::Index> in_, out_;  ///< places of its inputs and outputs in `opened_`
  std::vector<std::string> names_, by_differences_;
  std::vector<Pairs> pairs_;
  std::vector<int> inputs_, outputs_;  ///< ports of u and y in the opened graph
  Eigen::Index all_pairs_ = 0;
};

/// Derivatives by these parameters at the system's present values. Throws unknown_name,
/// duplicate_name, and not_rational as `lft` does; for blocks without `opened` only if their
/// derivative is not known (Derivatives::by_differences): values near the present one are refused,
/// or the matrices are not smooth there. Cost: that of `compile`; then that of each
/// function, which depends on the occurrences of the parameters, not on their number.
///
///     const Derivatives g = derivatives(system, {"m", "tilt"});
///     const Eigen::MatrixXcd dH = g.transfer({0, 2.5}, "tilt");
Derivatives derivatives(const System& system, const std::vector<std::string>& parameters);

}  // namespace titop
