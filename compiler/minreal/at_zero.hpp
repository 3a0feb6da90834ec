#pragma once

#include <string>
#include <titop/compiler/minreal/minimize.hpp>
#include <titop/compiler/minreal/sampled.hpp>
#include <vector>

/// States without effect on the transfer that leave before any eigenvalue is computed: by the
/// pattern of the matrices, and at s = 0, such as conserved momenta, rigid motions that no output
/// sees, positions that are functions of other states. For the compiler's own files.
namespace titop::minreal {

/// States that were removed, and doubtful ones.
struct RemovedStates {
  std::vector<JudgedMode> removed;
  int hidden = 0;                    ///< of these, possibly hidden by rounding
  std::vector<JudgedMode> doubtful;  ///< kept, but possibly rounding alone
  std::vector<std::string> notes;
};

/// Removes the states that no input reaches, or that reach no output, through entries of A, B and C
/// that are not 0; `energy` as below. O(n^2).
RemovedStates take_out_by_pattern(detail::Sampled& sampled, Eigen::MatrixXd& energy);

/// Removes the uncontrollable and the unobservable part at s = 0 [Popov, Belevitch, Hautus]: a row
/// of [A B] that depends on the other rows belongs to a state that follows from the others (a rate
/// from the other rates, since their momentum is constant); a column of [A; C] that depends on the
/// other columns to a state that outputs and other states see only relative to the others. Both are
/// repeated until no row or column depends on others: so chains of integrators leave step by step.
/// Each rank is decided by independent_rows.hpp, against the rounding of each entry; no eigenvalue
/// takes part, so that slow poles cannot be taken for poles at 0. States keep their names, and
/// their meaning except as noted. `energy` (see MinimizeOptions; or empty) follows. Without inputs,
/// or without outputs, that side removes nothing.
///
/// Of several states that could be removed, integrators are removed first, from the end of their
/// chains, then those with the smallest rows (columns) in units of
/// linalg::similarity_scaling_of_parts: a removed state is a sum of the others with small
/// coefficients. O(n^3) for each repetition.
RemovedStates take_out_at_zero(detail::Sampled& sampled, Eigen::MatrixXd& energy);

/// True if A of these states alone has a pole at 0: a row depends on the others, by the same
/// criterion. O(n^3).
bool has_pole_at_zero(const detail::Sampled& sampled, const std::vector<int>& states);

/// A (of a model's n x n) without its poles at 0: of each row that depends on the others the state
/// is eliminated, which follows from the others and a constant. `rounding` of each entry; empty:
/// 2.2e-16 of it. O(n^3) for each repetition.
Eigen::MatrixXd without_poles_at_zero(const StateSpace& model, const Eigen::MatrixXd& rounding);

}  // namespace titop::minreal
