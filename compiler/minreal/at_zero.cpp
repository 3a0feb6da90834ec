#include <fmt/format.h>

#include <algorithm>
#include <titop/compiler/minreal/at_zero.hpp>
#include <titop/compiler/minreal/clusters.hpp>
#include <titop/compiler/minreal/independent_rows.hpp>
#include <titop/compiler/minreal/integrators.hpp>
#include <titop/compiler/minreal/take_out.hpp>
#include <titop/graph/linalg/index.hpp>
#include <titop/graph/linalg/similarity_scaling.hpp>
#include <titop/graph/name_order.hpp>

namespace titop::minreal {
namespace {

using Eigen::MatrixXd;
using linalg::at;

/// States are removed from the highest level on: 0 for all but integrators, of which each is above
/// those that act on it by A.
std::vector<int> levels(const MatrixXd& A, const std::vector<int>& integrators) {
  std::vector<int> level(static_cast<std::size_t>(A.rows()), 0);
  for (const int i : integrators) level[at(i)] = 1;
  for (std::size_t sweep = 0; sweep < integrators.size(); ++sweep)
    for (const int i : integrators)
      for (const int j : integrators)
        if (A(i, j) != 0) level[at(i)] = std::max(level[at(i)], level[at(j)] + 1);
  return level;
}

/// [A B]: which states inputs and other states move independently of each other.
MatrixXd driven(const StateSpace& m) {
  MatrixXd rows(m.A.rows(), m.A.cols() + m.B.cols());
  rows << m.A, m.B;
  return rows;
}

/// [A; C]': which states other states and outputs see independently of each other.
MatrixXd seen(const StateSpace& m) {
  MatrixXd rows(m.A.cols(), m.A.rows() + m.C.rows());
  rows << m.A.transpose(), m.C.transpose();
  return rows;
}

std::vector<int> rows_of(const std::vector<IndependentRows::RowRemainder>& out) {
  std::vector<int> rows;
  for (const IndependentRows::RowRemainder& o : out) rows.push_back(o.row);
  return rows;
}

/// The energy of the model without the states `out`, which are T times the others.
MatrixXd energy_without(const MatrixXd& energy, const std::vector<int>& out, const MatrixXd& T) {
  if (energy.size() == 0) return energy;
  const std::vector<int> keep = others(energy.rows(), out);
  MatrixXd all = MatrixXd::Zero(energy.rows(), T.cols());
  all(keep, Eigen::all).setIdentity();
  all(out, Eigen::all) = T;
  return all.transpose() * energy * all;
}

/// Adds removed states to the result; doubts of an earlier repetition are decided anew.
void report(const IndependentRows& rows, const char* why, RemovedStates& result) {
  for (const IndependentRows::RowRemainder& o : rows.doubtful)
    result.doubtful.push_back({0, 1, o.own, o.bound, kAtZero});
  for (const IndependentRows::RowRemainder& o : rows.out) {
    result.removed.push_back({0, 1, o.own, o.bound, why});
    result.hidden += o.bound > kHides;
  }
}

using RowsOfModel = MatrixXd (*)(const StateSpace&);

/// Rows of one side, against the rounding of each entry.
IndependentRows rows_at_zero(const detail::Sampled& s, RowsOfModel rows_of_model, bool by_inputs) {
  const MatrixXd M = rows_of_model(s.model);
  const MatrixXd rounding =
      detail::rounding_of(s.off, M, rows_of_model).cwiseMax(kEpsilon * M.cwiseAbs());
  const MatrixXd A = by_inputs ? s.model.A : MatrixXd(s.model.A.transpose());
  MatrixXd balanced = A;
  const Eigen::VectorXd unit = linalg::similarity_scaling_of_parts(balanced);
  return independent_rows(M, rounding, unit, levels(A, find_integrators(s.model).integrators));
}

/// One repetition for one side; false if all states count.
bool take_out_once(detail::Sampled& s, RowsOfModel rows_of_model, bool by_inputs, MatrixXd& energy,
                   RemovedStates& result) {
  const IndependentRows rows = rows_at_zero(s, rows_of_model, by_inputs);
  report(rows, by_inputs ? "no input moves it" : "no output sees it", result);
  const std::vector<int> out = rows_of(rows.out);
  if (out.empty()) return false;
  const MatrixXd none = MatrixXd::Zero(rows.T.rows(), rows.T.cols());
  result.notes.push_back(by_inputs ? note_of_dependent(s.model, out)
                                   : note_of_unseen(s.model, out));
  const auto remove = [&](StateSpace& m, const MatrixXd& T) {
    if (by_inputs)
      take_out_dependent(m, out, T);
    else
      take_out_unseen(m, out, T.transpose());
  };
  remove(s.model, rows.T);
  for (int i = 0; i < std::ssize(s.off); ++i) remove(s.off[at(i)], detail::jittered(rows.T, i));
  detail::clear_rounding(s);
  energy = energy_without(energy, out, by_inputs ? rows.T : none);
  return true;
}

/// These states alone, without inputs and outputs.
StateSpace without_ports(const StateSpace& m, const std::vector<int>& states) {
  const MatrixXd none(std::ssize(states), 0);
  return {m.A(states, states), none, none.transpose(), {}, names_at(m.states, states), {}, {}};
}

/// States that inputs reach through A, step by step.
std::vector<char> reached(const MatrixXd& A, const MatrixXd& B) {
  std::vector<char> found(at(A.rows()), 0);
  std::vector<Eigen::Index> open;
  const auto take = [&](Eigen::Index i) {
    if (!found[at(i)]) found[at(i)] = 1, open.push_back(i);
  };
  for (Eigen::Index i = 0; i < B.rows(); ++i)
    if ((B.row(i).array() != 0).any()) take(i);
  while (!open.empty()) {
    const Eigen::Index j = open.back();
    open.pop_back();
    for (Eigen::Index i = 0; i < A.rows(); ++i)
      if (A(i, j) != 0) take(i);
  }
  return found;
}

}  // namespace

RemovedStates take_out_by_pattern(detail::Sampled& s, MatrixXd& energy) {
  RemovedStates result;
  for (const bool by_inputs : {true, false}) {
    const StateSpace& m = s.model;
    if (by_inputs ? m.inputs.empty() : m.outputs.empty()) continue;
    const std::vector<char> count =
        by_inputs ? reached(m.A, m.B) : reached(m.A.transpose(), m.C.transpose());
    std::vector<int> out;
    for (int i = 0; i < std::ssize(count); ++i)
      if (!count[at(i)]) out.push_back(i);
    if (out.empty()) continue;
    result.notes.push_back(fmt::format(
        "states that {}: {}", by_inputs ? "no input reaches" : "no output sees", names_of(m, out)));
    for (const int i : out)
      result.removed.push_back(
          {std::abs(m.A(i, i)), 1, 0, 0, by_inputs ? "no input moves it" : "no output sees it"});
    const MatrixXd none = MatrixXd::Zero(std::ssize(out), m.A.rows() - std::ssize(out));
    energy = energy_without(energy, out, none);
    take_out_dependent(s.model, out, none);
    for (StateSpace& off : s.off) take_out_dependent(off, out, none);
  }
  return result;
}

RemovedStates take_out_at_zero(detail::Sampled& s, MatrixXd& energy) {
  RemovedStates result;
  for (bool again = true; again && s.model.order() > 0;) {
    again = false;
    result.doubtful.clear();
    if (!s.model.inputs.empty()) again = take_out_once(s, driven, true, energy, result);
    if (!s.model.outputs.empty() && s.model.order() > 0)
      again = take_out_once(s, seen, false, energy, result) || again;
  }
  return result;
}

bool has_pole_at_zero(const detail::Sampled& s, const std::vector<int>& states) {
  detail::Sampled part{without_ports(s.model, states), {}};
  for (const StateSpace& off : s.off) part.off.push_back(without_ports(off, states));
  return !rows_at_zero(part, driven, true).out.empty();
}

MatrixXd without_poles_at_zero(const StateSpace& model, const MatrixXd& rounding) {
  detail::Sampled s = detail::sampled(without_ports(model, others(model.A.rows(), {})),
                                      {rounding, {}, {}, {}, {}, {}, {}});
  MatrixXd energy;
  RemovedStates unused;
  while (s.model.order() > 0 && take_out_once(s, driven, true, energy, unused)) {
  }
  return s.model.A;
}

}  // namespace titop::minreal
