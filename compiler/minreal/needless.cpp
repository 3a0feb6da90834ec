#include <algorithm>
#include <titop/compiler/minreal/clusters.hpp>
#include <titop/compiler/minreal/independent_rows.hpp>
#include <titop/compiler/minreal/needless.hpp>
#include <titop/compiler/minreal/take_out.hpp>
#include <titop/graph/linalg/index.hpp>

namespace titop::modes {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;

using linalg::at;

/// [B, N B, ...] up to the last power of N.
MatrixXd driven(const MatrixXd& N, const MatrixXd& B, int powers) {
  MatrixXd all(B.rows(), powers * B.cols()), block = B;
  for (int i = 0; i < powers; ++i) {
    all.middleCols(i * B.cols(), B.cols()) = block;
    block = (N * block).eval();
  }
  return all;
}

/// Number of powers of N that are not 0, counting N^0.
int powers_of(const MatrixXd& N) {
  MatrixXd power = MatrixXd::Identity(N.rows(), N.cols());
  int count = 0;
  while (count < N.rows() && (power.array() != 0).any()) power = (power * N).eval(), ++count;
  return count;
}

/// Number of steps of each integrator from those on which no integrator acts.
std::vector<int> levels(const MatrixXd& N) {
  std::vector<int> level(static_cast<std::size_t>(N.rows()), 0);
  for (Index sweep = 0; sweep < N.rows(); ++sweep)
    for (int i = 0; i < N.rows(); ++i)
      for (int j = 0; j < N.cols(); ++j)
        if (N(i, j) != 0) level[at(i)] = std::max(level[at(i)], level[at(j)] + 1);
  return level;
}

/// A model and its samples, decoupled.
struct Apart {
  Decoupled model;
  std::vector<Decoupled> off;
};
std::optional<Apart> apart(const Sampled& s, const IntegratorSplit& states) {
  const auto model = decouple(s.model, states);
  if (!model) return std::nullopt;
  Apart result{*model, {}};
  for (const StateSpace& m : s.off) {
    const auto off = decouple(m, states);
    if (!off) return std::nullopt;
    result.off.push_back(*off);
  }
  return result;
}

/// The removed integrators: their indices among the integrators, and as states of the model.
struct LeavingIntegrators {
  std::vector<int> rows, states;
  LeavingIntegrators(const IndependentRows& independent, const IntegratorSplit& of) {
    for (const IndependentRows::RowRemainder& out : independent.out) {
      rows.push_back(out.row);
      states.push_back(of.integrators[at(out.row)]);
    }
  }
};

std::vector<int> pick(const std::vector<int>& of, const std::vector<int>& which) {
  std::vector<int> result;
  for (const int i : which) result.push_back(of[at(i)]);
  return result;
}

/// Coefficients at `columns` of all states, for the kept states.
MatrixXd on_others(const MatrixXd& T, const std::vector<int>& columns, Index states,
                   const std::vector<int>& out) {
  MatrixXd all = MatrixXd::Zero(T.rows(), states);
  all(Eigen::all, columns) = T;
  return all(Eigen::all, others(states, out));
}

void report(const IndependentRows& rows, const char* why, Needless& n) {
  for (const IndependentRows::RowRemainder& o : rows.doubtful)
    n.doubtful.push_back({0, 1, o.own, o.bound, kAtZero});
  for (const IndependentRows::RowRemainder& o : rows.out) {
    n.removed.push_back({0, 1, o.own, o.bound, why});
    n.hidden += o.bound > kHides;
  }
}

/// Integrators that inputs move independently of each other.
IndependentRows moved(const StateSpace& model, const Apart& d, const IntegratorSplit& states) {
  const int powers = powers_of(d.model.N);
  const auto moved_by = [&](const Decoupled& part) { return driven(part.N, part.B, powers); };
  const MatrixXd K = moved_by(d.model),
                 terms = driven(d.model.N.cwiseAbs(), terms_of_B(model, states), powers);
  const MatrixXd rounding = rounding_of(d.off, K, moved_by).cwiseMax(kEps * terms);
  return independent_rows(K, rounding, terms, levels(d.model.N));
}

/// States that follow from the others: out = T keep + (X_out - T X_keep) rest.
bool take_out_undriven(Sampled& s, const IntegratorSplit& states, Needless& n) {
  const std::optional<Apart> d = apart(s, states);
  if (!d) return false;
  const IndependentRows rows = moved(s.model, *d, states);
  report(rows, "no input moves it", n);
  if (rows.out.empty()) return true;
  const LeavingIntegrators leaving(rows, states);
  const MatrixXd& T = rows.T;
  const auto by_rest = [&](const Decoupled& part) {
    return MatrixXd(part.X(leaving.rows, Eigen::all) - T * part.X(rows.keep, Eigen::all));
  };
  const MatrixXd Y = by_rest(d->model), X = d->model.X.cwiseAbs();
  const MatrixXd terms = X(leaving.rows, Eigen::all) + T.cwiseAbs() * X(rows.keep, Eigen::all);
  const MatrixXd clear = cleared(Y, rounding_of(d->off, Y, by_rest).cwiseMax(kEps * terms));
  const Index all = s.model.A.rows();
  const MatrixXd follow = on_others(T, pick(states.integrators, rows.keep), all, leaving.states) +
                          on_others(clear, states.rest, all, leaving.states);
  n.notes.push_back(note_of_dependent(s.model, leaving.states));
  take_out_dependent(s.model, leaving.states, follow);
  for (int i = 0; i < std::ssize(s.off); ++i)
    take_out_dependent(s.off[at(i)], leaving.states, jittered(follow, i));
  clear_rounding(s);
  return true;
}

/// States that outputs see only together with others, or not at all.
void leave_out_unseen(Sampled& s, const IntegratorSplit& states, Needless& n) {
  const auto part = [&](const StateSpace& m) {
    return MatrixXd(m.A(states.integrators, states.integrators).transpose());
  };
  const int powers = powers_of(part(s.model));
  const auto seen = [&](const StateSpace& m) {
    return driven(part(m), m.C(Eigen::all, states.integrators).transpose(), powers);
  };
  const MatrixXd O = seen(s.model), rounding = rounding_of(s.off, O, seen);
  // The cancelling terms of entries that are 0 are unknown.
  const MatrixXd any = MatrixXd::Zero(O.rows(), O.cols());
  const IndependentRows rows = independent_rows(O, rounding, any, levels(part(s.model)));
  report(rows, "no output sees it", n);
  if (rows.out.empty()) return;
  const LeavingIntegrators leaving(rows, states);
  const MatrixXd P =
      on_others(rows.T, pick(states.integrators, rows.keep), s.model.A.rows(), leaving.states)
          .transpose();
  n.notes.push_back(note_of_unseen(s.model, leaving.states));
  modes::take_out_unseen(s.model, leaving.states, P);
  for (int i = 0; i < std::ssize(s.off); ++i)
    modes::take_out_unseen(s.off[at(i)], leaving.states, jittered(P, i));
  clear_rounding(s);
}

}  // namespace

std::optional<StateSpace> decoupled_rest(const Sampled& s, const IntegratorSplit& states) {
  const std::optional<Apart> d = apart(s, states);
  if (!d) return std::nullopt;
  const auto seen = [](const Decoupled& part) { return part.C_rest; };
  StateSpace rest = without_integrators(s.model, states);
  const MatrixXd terms =
      s.model.C(Eigen::all, states.rest).cwiseAbs() +
      s.model.C(Eigen::all, states.integrators).cwiseAbs() * d->model.X.cwiseAbs();
  rest.C =
      cleared(d->model.C_rest, rounding_of(d->off, d->model.C_rest, seen).cwiseMax(kEps * terms));
  rest.D = s.model.D;
  rest.outputs = s.model.outputs;
  return rest;
}

std::optional<Needless> take_out_needless(Sampled& s) {
  Needless n;
  IntegratorSplit states = find_integrators(s.model);
  if (!s.model.inputs.empty() && !states.integrators.empty()) {
    if (!take_out_undriven(s, states, n)) return std::nullopt;
    states = find_integrators(s.model);
  }
  if (!s.model.outputs.empty() && !states.integrators.empty()) leave_out_unseen(s, states, n);
  return n;
}

}  // namespace titop::modes
