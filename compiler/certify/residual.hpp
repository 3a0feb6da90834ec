#pragma once

#include <titop/compiler/system_data.hpp>

/// How well the equations hold, as the user wrote them and as the blocks state them. For the
/// compiler's own files only.
namespace titop::detail {

inline constexpr double kWarn = 1e-9;  ///< what is worse than this is said in the log

/// All signals of one input, at one real s or at one instant.
struct Signals {
  std::vector<int> first = {};             ///< of every signal in `values`, and the end
  solve::RowMatrix<double> values = {};    ///< one column
  solve::RowMatrix<double> unknowns = {};  ///< of the joint system as written
  solve::RowMatrix<double> rounding = {};  ///< one sample of it, as `values`; none: not known
  double s = 0;  ///< xdot = s x, positions are accelerations over s^2. 0: an instant, where xdot is
                 ///< A x + B u by definition and positions there must be none
};

/// Where signal i begins among all, and the end.
std::vector<int> first_of_signals(const Graph& graph);

struct WrittenResidual {
  double worst = 0;   ///< Certificate::residual
  std::string where;  ///< the equation or block that has it
};

/// Largest |left - right| over (sum of magnitudes of the terms) of all equations of Stage::source
/// and all rows of all blocks. What is 0 but for rounding does not count, nor does, where a sample
/// of rounding is known, a difference below 1e4 times what it makes of the terms, or below 1e-14 of
/// the largest of its kind where chains are closed twice. What is not finite counts as 1. O(terms).
WrittenResidual written_residual(const SystemData& d, const Signals& signals);

/// What rounding leaves of a 0, beside size_around(): some hundred units of the last place, for it
/// comes from sums over a front.
inline constexpr double kLeftOfZero = 1e-13;

/// Size of the neighbours of an entry of an unknown in its front of the elimination, in the entry's
/// own unit (both by the scaling of the front's columns). Of the joint system as written. O(front).
double size_around(const SystemData& d, const solve::RowMatrix<double>& unknowns, int variable,
                   Eigen::Index entry);

/// The same of an entry of a signal that unknowns stand for; 0 of a known one.
double size_around_signal(const SystemData& d, const solve::RowMatrix<double>& unknowns, int signal,
                          Eigen::Index entry);

}  // namespace titop::detail
