#include <fmt/format.h>

#include <algorithm>
#include <titop/compiler/index_reduction/undetermined.hpp>
#include <titop/compiler/index_reduction/watched.hpp>
#include <titop/compiler/solve/null_columns.hpp>
#include <titop/graph/linalg/index.hpp>
#include <titop/graph/linalg/rounding.hpp>

namespace titop::detail {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::RowVectorXd;
using linalg::at;
using solve::KeptMatrix;

/// rows of `to` from `first` on += c * m
template <class C, class Block>
void add(KeptMatrix& to, Index first, const C& c, const Block& value, const Block& size) {
  to.value.middleRows(first, c.rows()) += c * value;
  to.size.middleRows(first, c.rows()) += c.cwiseAbs() * size;
}

/// Sets entries at rounding level to 0.
void clean(KeptMatrix& m, Index column) {
  for (Index i = 0; i < m.value.rows(); ++i) m.set(i, column, solve::settled(m.at(i, column)));
}

KeptMatrix cleaned(KeptMatrix m) {
  for (Index j = 0; j < m.value.cols(); ++j) clean(m, j);
  return m;
}

bool is_seen(const KeptMatrix& seen, Index column) { return !seen.value.col(column).isZero(0); }

/// Effects of some motions (columns, over the unknowns).
class Motions {
 public:
  Motions(const Skeleton& k, const Factored& d) : k_(k), d_(d), g_(k.stage.graph) {}

  /// Value of a signal.
  KeptMatrix value(int signal, const KeptMatrix& z) const {
    KeptMatrix result(g_.signals[at(signal)].size, z.value.cols());
    for (const solve::SignalTerm& m : k_.joint.meaning(signal)) {
      const int v = k_.joint.variable_of[at(m.signal)];
      if (v < 0) continue;  // a state or an input
      const Index first = k_.joint.plan->first[at(v)], size = g_.signals[at(m.signal)].size;
      const MatrixXd one = MatrixXd::Identity(size, size);
      add(result, 0,
          m.coefficient < 0 ? one : MatrixXd(*d_.numbers.coefficients[at(m.coefficient)]),
          z.value.middleRows(first, size), z.size.middleRows(first, size));
    }
    return cleaned(std::move(result));
  }

  /// Rates of the blocks' states.
  KeptMatrix rates(const KeptMatrix& z) const {
    KeptMatrix result(d_.layout().order(), z.value.cols());
    for (const int i : d_.layout().state_nodes) {
      const Node& node = g_.nodes[at(i)];
      for (int s = node.first_signal; s < node.state; ++s)
        if (const Signal& u = g_.signals[at(s)]; u.role == Signal::Role::input && u.active) {
          const KeptMatrix v = value(s, z);
          add(result, d_.layout().state_first[at(i)],
              d_.numbers.blocks[at(i)]->B.middleCols(u.first, u.size), v.value, v.size);
        }
    }
    return cleaned(std::move(result));
  }

  KeptMatrix outputs(const KeptMatrix& z) const {
    KeptMatrix result(static_cast<Index>(d_.layout().outputs.size()), z.value.cols());
    for (std::size_t o = 0; o < g_.outputs.size(); ++o)
      for (std::size_t t = 0; t < g_.outputs[o].terms.size(); ++t) {
        const int signal = g_.outputs[o].terms[t].signal;
        if (g_.signals[at(signal)].role == Signal::Role::state) continue;
        const KeptMatrix v = value(signal, z);
        add(result, d_.layout().output_first[o],
            *d_.numbers.coefficients[at(k_.joint.output_coefficient[o]) + t], v.value, v.size);
      }
    return cleaned(std::move(result));
  }

 private:
  const Skeleton& k_;
  const Factored& d_;
  const Graph& g_;
};

KeptMatrix watched_rows(KeptMatrix rates, const StateMarks& watched) {
  for (Index i = 0; i < rates.value.rows(); ++i)
    if (!watched[at(i)]) rates.value.row(i).setZero();
  return rates;
}

/// Combinations of the motions z that move none of the rows of `seen`.
KeptMatrix unseen(const KeptMatrix& z, const KeptMatrix& seen) {
  solve::SparseRows by_motion(at(seen.value.cols()));
  for (Index j = 0; j < seen.value.cols(); ++j)
    for (Index i = 0; i < seen.value.rows(); ++i)
      if (seen.size(i, j) != 0) by_motion[at(j)][static_cast<int>(i)] = seen.at(i, j);
  const std::vector<solve::SparseRow> by = solve::left_null(std::move(by_motion)).y;
  KeptMatrix result(z.value.rows(), std::ssize(by));
  for (Index k = 0; k < result.value.cols(); ++k)
    for (const auto& [j, factor] : by[at(k)]) {
      result.value.col(k) += factor * z.value.col(j);
      result.size.col(k) += std::abs(factor) * z.size.col(j);
    }
  return cleaned(std::move(result));
}

/// A part of a port that moves.
struct MovingPart {
  int signal = -1;
  int first = 0, size = 0;  ///< translation, rotation, or all of a scalar
  RowVectorXd direction;    ///< over the whole signal, of length 1
};

/// Place of the largest part of a motion: rotations first, whose unit is no length, then
/// translations, then axes of joints and scalar points; of equals a parent's of a body without
/// states (no joint), then the first in the graph. No signal if it is no motion of a port.
class Showing {
 public:
  Showing(const Skeleton& k, const Motions& motions) : k_(k), g_(k.stage.graph), motions_(motions) {
    for (int s = 0; s < static_cast<int>(g_.signals.size()); ++s)
      if (moves(s)) signals_.push_back(s);
  }

  MovingPart of(const KeptMatrix& z, Index column) const {
    KeptMatrix one;
    one.value = z.value.col(column), one.size = z.size.col(column);
    for (const auto& [size, first, count] : {std::tuple{6, 3, 3}, {6, 0, 3}, {1, 0, 1}})
      if (MovingPart p = largest(one, size, first, count); p.signal >= 0) return p;
    return {};
  }

 private:
  /// An acceleration of a channel, in terms of unknowns alone.
  bool moves(int signal) const {
    const Signal& s = g_.signals[at(signal)];
    if (!s.active || s.channel < 0 || s.quantity != Quantity::acceleration) return false;
    const auto meaning = k_.joint.meaning(signal);
    return !meaning.empty() &&
           std::all_of(meaning.begin(), meaning.end(), [&](const solve::SignalTerm& m) {
             return k_.joint.variable_of[at(m.signal)] >= 0;
           });
  }

  bool is_of_body(const Channel& c) const {
    return c.takes == Takes::accel && g_.nodes[at(c.node)].state < 0;
  }

  MovingPart largest(const KeptMatrix& z, int size, int first, int count) const {
    MovingPart best;
    double most = 0;
    bool best_of_body = false;
    for (const int s : signals_) {
      if (g_.signals[at(s)].size != size) continue;
      const Eigen::VectorXd part = motions_.value(s, z).value.col(0).segment(first, count);
      const double length = part.norm();
      const bool equal = length * linalg::kTie >= most && length <= linalg::kTie * most;
      const bool of_body = is_of_body(g_.channels[at(g_.signals[at(s)].channel)]);
      if (length == 0 || !(length > linalg::kTie * most || (equal && of_body && !best_of_body)))
        continue;
      most = length, best_of_body = of_body;
      best = {s, first, count, RowVectorXd::Zero(size)};
      best.direction.segment(first, count) = part.transpose() / length;
    }
    return best;
  }

  const Skeleton& k_;
  const Graph& g_;
  const Motions& motions_;
  std::vector<int> signals_;
};

/// The other motions less a multiple of this one, so that they do not show at its place.
void take_out(KeptMatrix& z, Index column, const MovingPart& p, const Motions& motions) {
  const KeptMatrix v = motions.value(p.signal, z);
  const RowVectorXd along = p.direction * v.value;
  for (Index j = column + 1; j < z.value.cols(); ++j) {
    if (along(j) == 0) continue;
    const double share = along(j) / along(column);
    z.value.col(j) -= share * z.value.col(column);
    z.size.col(j) += std::abs(share) * z.size.col(column);
    clean(z, j);
  }
}

// --- words --------------------------------------------------------------------------------------

std::string axis(RowVectorXd v) {
  for (Index i = 0; i < v.size(); ++i)
    if (std::abs(v(i)) < linalg::kMatrixDigits) v(i) = 0;  // and no -0
  Index first = 0;
  while (v(first) == 0) ++first;
  if (v(first) < 0) v = (-v).array() + 0.0;
  if (v(first) > 1 - linalg::kMatrixDigits) return std::string(1, "xyz"[first]);
  return fmt::format("({:.3g}, {:.3g}, {:.3g})", v(0), v(1), v(2));
}

/// "the rotation of strut.parent about x", for all places at one part of a port together.
std::string words(const Graph& g, const std::vector<MovingPart>& places) {
  const MovingPart& p = places.front();
  const std::string name = channel_name(g, g.signals[at(p.signal)].channel);
  if (p.size == 1) return "the motion of " + name;
  std::string text = (p.first == 3 ? "the rotation of " : "the translation of ") + name;
  for (std::size_t i = 0; i < places.size() && places.size() < 3; ++i)
    text += (i > 0          ? " and "
             : p.first == 3 ? " about "
                            : " along ") +
            axis(places[i].direction.segment(p.first, 3));
  return text;
}

/// One line per part of a port, in the order in which they were found.
std::vector<std::string> lines(const Graph& g, const std::vector<MovingPart>& places) {
  std::vector<std::string> result;
  std::vector<char> done(places.size(), 0);
  for (std::size_t i = 0; i < places.size(); ++i) {
    if (done[i]) continue;
    std::vector<MovingPart> same;
    for (std::size_t j = i; j < places.size(); ++j)
      if (places[j].signal == places[i].signal && places[j].first == places[i].first)
        same.push_back(places[j]), done[j] = 1;
    result.push_back("nothing determines " + words(g, same));
  }
  return result;
}

/// "output a(1), a(2) and 3 more depend on it"
std::string depends(const char* subject, const KeptMatrix& seen, Index column,
                    const std::vector<std::string>& names) {
  std::string text;
  int count = 0;
  for (Index i = 0; i < seen.value.rows(); ++i)
    if (seen.value(i, column) != 0 && ++count <= 4) text += (count > 1 ? ", " : "") + names[at(i)];
  if (count > 4) text += fmt::format(" and {} more", count - 4);
  return fmt::format("{}{} {} {} on it", subject, count > 1 ? "s" : "", text,
                     count > 1 ? "depend" : "depends");
}

}  // namespace

Undetermined undetermined(const Skeleton& k, const Factored& d, const std::vector<int>& rows) {
  const Motions motions(k, d);
  const Showing showing(k, motions);
  const KeptMatrix all = solve::null_columns(*d.factors);
  const StateMarks watched = watched_states(k, d);
  const KeptMatrix rates = watched_rows(motions.rates(all), watched);
  const KeptMatrix free = unseen(all, rates);
  const KeptMatrix outputs = motions.outputs(free);
  KeptMatrix still = unseen(free, outputs);
  const auto count = static_cast<Index>(rows.size());
  Undetermined result;
  const auto name = [&](const char* subject, const KeptMatrix& z, const KeptMatrix& seen,
                        const std::vector<std::string>& names) {
    for (Index j = 0; j < z.value.cols(); ++j)
      if (const MovingPart p = showing.of(z, j); p.signal >= 0 && is_seen(seen, j))
        result.lines.push_back(fmt::format("{}, and {}", lines(k.stage.graph, {p}).front(),
                                           depends(subject, seen, j, names)));
  };
  if (free.value.cols() < count) {
    name("state", all, rates, d.layout().states);
    if (!result.lines.empty() && all.value.cols() > count)
      result.lines.insert(
          result.lines.begin(),
          fmt::format("{} of these motions, or of their combinations, {} undetermined:", count,
                      count > 1 ? "are" : "is"));
    return result;
  }
  if (still.value.cols() < count) {
    name("output", free, outputs, d.layout().outputs);
    return result;
  }
  std::vector<MovingPart> places;
  for (Index j = 0; j < still.value.cols() && static_cast<Index>(places.size()) < count; ++j) {
    const MovingPart p = showing.of(still, j);
    if (p.signal < 0) continue;  // forces alone
    take_out(still, j, p, motions);
    places.push_back(p);
  }
  if (static_cast<Index>(places.size()) < count) return result;
  for (std::size_t i = 0; i < places.size(); ++i)
    result.held.push_back({rows[i], places[i].signal, places[i].direction});
  result.lines = lines(k.stage.graph, places);
  const KeptMatrix moved = motions.rates(still);
  StateMarks marks(at(moved.value.rows()), 0);
  for (Index i = 0; i < moved.value.rows(); ++i) marks[at(i)] = !moved.value.row(i).isZero(0);
  result.states = moved_with(k, d, std::move(marks));
  return result;
}

}  // namespace titop::detail
