#pragma once

#include <string>
#include <titop/compiler/minreal/judge.hpp>
#include <titop/compiler/minreal/modes.hpp>
#include <vector>

/// Removal of modes, as relations between states: the remaining states keep name and meaning.
namespace titop::minreal {

/// Takes out these states (in ascending order): they follow from the others, x_out = T x_others.
void take_out_dependent(StateSpace& model, const std::vector<int>& out, const Eigen::MatrixXd& T);
/// Takes out these states: the others are now relative to them, x_others + P x_out, on which alone
/// outputs depend.
void take_out_unseen(StateSpace& model, const std::vector<int>& out, const Eigen::MatrixXd& P);
/// All states but these, which are in ascending order.
std::vector<int> others(Eigen::Index states, const std::vector<int>& out);
/// Names of states for a note; of many the first ones and their number.
std::string names_of(const StateSpace& model, const std::vector<int>& states);
/// The notes on such states.
std::string note_of_dependent(const StateSpace& model, const std::vector<int>& out);
std::string note_of_unseen(const StateSpace& model, const std::vector<int>& out);

/// Removes the modes of which Verdict::drop is true. Adds a note that lists the states that are now
/// sums of others, and one that lists those to which others are now relative. O(n^2) per mode.
void take_out(const Symmetric& s, const std::vector<Verdict>& verdicts, StateSpace& model,
              std::vector<std::string>& notes);
void take_out(const General& g, const std::vector<Verdict>& verdicts, StateSpace& model,
              std::vector<std::string>& notes);

}  // namespace titop::minreal
