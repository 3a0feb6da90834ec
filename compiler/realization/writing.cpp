#include <algorithm>
#include <span>
#include <titop/compiler/realization/writing.hpp>
#include <titop/compiler/solve/factored.hpp>
#include <titop/compiler/solve/layout.hpp>
#include <titop/graph/linalg/index.hpp>

namespace titop::detail {
namespace {

using Eigen::Index;
using linalg::at;
using solve::Piece;

struct WritingBuilder {
  Writing& w;
  const Factored& d;
  const Skeleton& k = *d.skeleton;
  const Graph& g = d.graph();
  const Layout& layout = d.layout();

  Index modes(int node) const {
    const auto& modal = d.numbers.blocks[at(node)]->modal;
    return modal ? modal->W.rows() : 0;
  }

  // --- sources ---------------------------------------------------------------------------------

  void find_sources() {
    std::vector<int> source_of(g.signals.size(), -1);
    const auto add = [&](int signal, int node, bool modal) {
      source_of[at(signal)] = static_cast<int>(w.sources.size());
      w.sources.push_back(
          {node, layout.known_first[at(signal)], g.signals[at(signal)].size, modal});
    };
    for (const int i : layout.state_nodes) add(g.nodes[at(i)].state, i, modes(i) > 0);
    for (const Input& in : g.inputs) add(in.signal, -1, false);
    // A body whose states are also read by equations acts through all of them.
    for (const Piece& p : k.joint.pieces)
      if (p.entry < 0 && p.of != Piece::Left::state)
        w.sources[at(source_of[at(p.signal)])].modal = false;
    for (Writing::Source& s : w.sources) {
      if (s.modal) s.columns = modes(s.node);
      s.front = static_cast<int>(k.joint.plan->fronts.size());
    }
    for (int r = 0; r < static_cast<int>(k.joint.rows.size()); ++r)
      for (int p = k.joint.piece_begin[at(r)]; p < k.joint.piece_begin[at(r) + 1]; ++p) {
        const Piece& piece = k.joint.pieces[at(p)];
        if (piece.entry >= 0) continue;
        Writing::Source& s = w.sources[at(source_of[at(piece.signal)])];
        s.acts.emplace_back(r, p);
        s.front = std::min(s.front, k.joint.plan->front_of_row[at(r)]);
      }
    std::stable_sort(
        w.sources.begin(), w.sources.end(),
        [](const Writing::Source& a, const Writing::Source& b) { return a.front < b.front; });
  }

  void find_batches() {
    Index columns = Writing::kBatch;
    for (std::size_t i = 0; i < w.sources.size(); ++i) {
      if (columns + w.sources[i].columns > Writing::kBatch) w.batches.push_back(i), columns = 0;
      columns += w.sources[i].columns;
    }
    w.batches.push_back(w.sources.size());
    // Neighbours in the model come together.
    for (std::size_t i = 0; i + 1 < w.batches.size(); ++i)
      std::ranges::sort(std::span(w.sources).subspan(w.batches[i], w.batches[i + 1] - w.batches[i]),
                        {}, [](const Writing::Source& s) { return std::pair(s.modal, s.first); });
  }

  // --- targets ---------------------------------------------------------------------------------

  void find_targets() {
    for (const int i : layout.state_nodes) {
      const Node& node = g.nodes[at(i)];
      // Coordinates move with their rates, in any case: no input enters their rows.
      Writing::Target t;
      t.still = modes(i);
      t.row = layout.state_first[at(i)] + t.still;
      t.rows = g.signals[at(node.state)].size - t.still;
      for (int s = node.first_signal; s < node.state; ++s)
        if (const Signal& in = g.signals[at(s)]; in.role == Signal::Role::input && in.active)
          read(t, s, {.node = i, .column = in.first, .size = in.size});
      w.targets.push_back(std::move(t));
    }
    for (std::size_t o = 0; o < g.outputs.size(); ++o) {
      Writing::Target t;
      t.row = layout.order() + layout.output_first[o];
      t.rows = g.outputs[o].size;
      const auto& terms = g.outputs[o].terms;
      for (std::size_t n = 0; n < terms.size(); ++n)
        read(t, terms[n].signal,
             {.coefficient = k.joint.output_coefficient[o] + static_cast<int>(n),
              .size = g.signals[at(terms[n].signal)].size});
      w.targets.push_back(std::move(t));
    }
    std::sort(w.targets.begin(), w.targets.end(),
              [](const Writing::Target& a, const Writing::Target& b) { return a.row < b.row; });
    for (Writing::Target& t : w.targets) place_coefficients(t);
  }

  /// `to` is the signal until coefficients have their place.
  void read(Writing::Target& t, int signal, Writing::TargetTerm term) const {
    for (const solve::SignalTerm& m : k.joint.meaning(signal)) {
      term.times = m.coefficient;
      term.known = k.joint.variable_of[at(m.signal)] < 0;
      term.to = m.signal;
      t.terms.push_back(term);
    }
  }

  /// Sorts the coefficients of a target in the order of the unknowns.
  void place_coefficients(Writing::Target& t) {
    const solve::Plan& plan = *k.joint.plan;
    std::vector<int> variables;
    for (const Writing::TargetTerm& term : t.terms)
      if (!term.known) variables.push_back(k.joint.variable_of[at(term.to)]);
    std::sort(variables.begin(), variables.end(),
              [&](int a, int b) { return plan.first[at(a)] < plan.first[at(b)]; });
    variables.erase(std::unique(variables.begin(), variables.end()), variables.end());
    std::vector<Index> place(variables.size());
    for (std::size_t i = 0; i < variables.size(); ++i) {
      const Index first = plan.first[at(variables[i])],
                  size = plan.structure.variable_size[at(variables[i])];
      place[i] = t.inner;
      t.inner += size;
      Writing::add_range(t.unknowns, {first, size});
    }
    t.coefficients = w.coefficients;
    w.coefficients += t.rows * t.inner;
    for (Writing::TargetTerm& term : t.terms) {
      const int v = k.joint.variable_of[at(term.to)];
      const auto found = std::find(variables.begin(), variables.end(), v);
      term.to = term.known ? layout.known_first[at(term.to)] : place[at(found - variables.begin())];
    }
  }
};

}  // namespace

Writing::Writing(const Factored& data) {
  WritingBuilder builder{*this, data};
  builder.find_sources();
  builder.find_batches();
  builder.find_targets();
  for (const int i : data.layout().state_nodes) modal.emplace_back(i, builder.modes(i) > 0);
}

void Writing::add_range(std::vector<IndexRange>& ranges, const IndexRange& next) {
  if (!ranges.empty() && ranges.back().first + ranges.back().size == next.first)
    ranges.back().size += next.size;
  else
    ranges.push_back(next);
}

bool Writing::fits(const Factored& data) const {
  return std::all_of(modal.begin(), modal.end(), [&](const auto& m) {
    return (data.numbers.blocks[at(m.first)]->modal != nullptr) == m.second;
  });
}

Index Writing::width(std::size_t batch) const {
  Index m = 0;
  for (std::size_t i = batches[batch]; i < batches[batch + 1]; ++i) m += sources[i].columns;
  return (m + 7) / 8 * 8;
}

std::shared_ptr<const Writing> writing_of(const Factored& data) {
  const auto make = [&] { return std::make_shared<const Writing>(data); };
  const std::shared_ptr<const Writing>& common = data.skeleton->writing.get(make);
  return common->fits(data) ? common : make();
}

}  // namespace titop::detail
