#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <optional>
#include <titop/emit/report/units.hpp>
#include <titop/graph/declared.hpp>
#include <titop/graph/linalg/index.hpp>

namespace titop::report {
namespace {

using linalg::at;

/// Along or about an axis.
enum class Nature { unknown, linear, angular };

std::string unit(Quantity quantity, Nature nature) {
  if (nature == Nature::unknown) return {};
  const bool angular = nature == Nature::angular;
  switch (quantity) {
    case Quantity::force: return angular ? "N m" : "N";
    case Quantity::acceleration: return angular ? "rad/s²" : "m/s²";
    case Quantity::velocity: return angular ? "rad/s" : "m/s";
    case Quantity::position: return angular ? "rad" : "m";
    case Quantity::plain: return {};
  }
  return {};
}

/// Signs, rotations and selections only: the unit is preserved.
bool keeps_units(const Term& term) {
  if (std::abs(term.sign) != 1) return false;
  return std::all_of(term.factors.begin(), term.factors.end(), [](const Factor& f) {
    if (const auto* k = std::get_if<Value>(&f))
      return !k->is_parameter() && std::abs(k->nominal()) == 1;
    return !std::holds_alternative<Matrix>(f);
  });
}

/// Nature of a pattern's line over the six degrees of freedom of a dual vector.
Nature of_line(const Pattern& line) {
  const bool linear = line.topRows(3).any(), angular = line.bottomRows(3).any();
  return linear == angular ? Nature::unknown : linear ? Nature::linear : Nature::angular;
}

/// Classifies scalar signals as angular or linear. Of a joint's axes by its feedthrough; of
/// blocks of one axis (a SpringMass) by their connections, else linear.
class Natures {
 public:
  explicit Natures(const Graph& g) : g_(g), of_node_(g.nodes.size(), Nature::unknown) {
    for (bool found = true; found;) {
      found = false;
      for (const Equation& e : g.equations)
        for (const Term& t : e.terms) found = spread(e, t) || found;
    }
  }

  /// Nature of one row of a signal.
  Nature operator()(int signal, int row) const {
    const Signal& s = g_.signals[at(signal)];
    if (s.size == 6) return row < 3 ? Nature::linear : Nature::angular;
    if (s.size != 1 || s.node < 0) return Nature::unknown;
    if (has_vectors(s.node)) return of_axis(s);
    return of_node_[at(s.node)] == Nature::angular ? Nature::angular : Nature::linear;
  }

  /// Natures of the rows of the signal that a term reads: row by row of the term.
  std::vector<Nature> of(const Term& term) const {
    const Pattern p = structure(g_, term);
    std::vector<Nature> result;
    for (Eigen::Index i = 0; i < p.rows(); ++i) {
      if (g_.signals[at(term.signal)].size == 6)
        result.push_back(of_line(p.row(i).transpose()));
      else
        result.push_back(p.size() == 1 ? (*this)(term.signal, 0) : Nature::unknown);
    }
    return result;
  }

  /// Nature of the part of its equation's target that column `k` of a term drives.
  Nature driven(const Equation& e, const Term& term, int k) const {
    const Pattern p = structure(g_, term);
    if (g_.signals[at(e.target)].size != 6)
      return p.rows() == 1 ? (*this)(e.target, 0) : Nature::unknown;
    if (e.part.whole()) return p.rows() == 6 ? of_line(p.col(k)) : Nature::unknown;
    const Pattern rows = e.part.rows().array() != 0;
    if (rows.rows() != p.rows()) return Nature::unknown;
    Pattern line = Pattern::Constant(6, 1, false);
    for (Eigen::Index i = 0; i < p.rows(); ++i)
      if (p(i, k)) line = line || rows.row(i).transpose();
    return of_line(line);
  }

 private:
  bool has_vectors(int node) const {
    const auto& channels = g_.nodes[at(node)].block->interface().channels;
    return std::any_of(channels.begin(), channels.end(),
                       [](const ChannelSpec& c) { return c.size == 6; });
  }

  /// Nature of an axis of a joint: its force or torque is the component of the child's wrench along
  /// it.
  Nature of_axis(const Signal& s) const {
    const Block& block = *g_.nodes[at(s.node)].block;
    const Interface& face = block.interface();
    std::vector<int> axes;
    for (std::size_t c = 0; c < face.channels.size(); ++c)
      if (face.channels[c].size == 1) axes.push_back(static_cast<int>(c));
    if (axes.empty()) return Nature::unknown;
    int channel = s.spec;
    if (s.channel < 0) {
      if (face.outputs.size() != 2 * axes.size()) return Nature::unknown;
      channel = axes[at(s.spec) % axes.size()];
    }
    int row = 0;
    for (int c = 0; c < channel; ++c) row += face.channels[at(c)].size;
    const Pattern p = block.feedthrough();
    return face.channels.front().size == 6 && p.cols() >= 6 && row < p.rows()
               ? of_line(p.row(row).head(6).transpose())
               : Nature::unknown;
  }

  /// True if one end of the term determines the other.
  bool spread(const Equation& e, const Term& t) {
    if (e.target < 0 || t.signal < 0 || !keeps_units(t)) return false;
    const Signal &to = g_.signals[at(e.target)], &from = g_.signals[at(t.signal)];
    bool found = false;
    if (open(to)) {
      const std::vector<Nature> n = of(t);
      const bool known = from.size == 6 || (from.node >= 0 && !open(from));
      if (known && n.size() == 1) found = set(to.node, n.front());
    }
    if (open(from) && !open(to) && to.node >= 0) found = set(from.node, driven(e, t, 0)) || found;
    return found;
  }

  bool open(const Signal& s) const {
    return s.size == 1 && s.node >= 0 && s.quantity != Quantity::plain && !has_vectors(s.node) &&
           of_node_[at(s.node)] == Nature::unknown;
  }

  bool set(int node, Nature nature) {
    if (nature == Nature::unknown) return false;
    of_node_[at(node)] = nature;
    return true;
  }

  const Graph& g_;
  std::vector<Nature> of_node_;
};

/// The one unit that all uses agree on.
class Agreed {
 public:
  void add(const std::string& unit) {
    if (!unit_) unit_ = unit;
    if (*unit_ != unit) unit_ = "";
  }
  std::string get() const { return unit_.value_or(""); }

 private:
  std::optional<std::string> unit_;
};

std::string input_unit(const Graph& g, const Natures& natures, int signal, int row) {
  Agreed agreed;
  for (const Equation& e : g.equations)
    for (const Term& t : e.terms) {
      if (t.signal != signal || e.target < 0) continue;
      if (!structure(g, t).col(row).any()) continue;
      agreed.add(keeps_units(t) ? unit(g.signals[at(e.target)].quantity, natures.driven(e, t, row))
                                : "");
    }
  return agreed.get();
}

std::string output_unit(const Graph& g, const Natures& natures, const Output& output, int row) {
  Agreed agreed;
  for (const Term& t : output.terms) {
    if (t.signal < 0) continue;
    const Quantity quantity = t.of == Term::Of::position ? Quantity::position
                              : t.of == Term::Of::rate   ? Quantity::velocity
                                                         : g.signals[at(t.signal)].quantity;
    const std::vector<Nature> n = natures.of(t);
    const bool fits = keeps_units(t) && at(row) < n.size();
    agreed.add(fits ? unit(quantity, n[at(row)]) : "");
  }
  return agreed.get();
}

void add(std::vector<ScalarSignal>& list, const std::string& name, int size, int row,
         std::string unit) {
  list.push_back({size == 1 ? name : fmt::format("{}({})", name, row + 1), name, std::move(unit),
                  static_cast<int>(list.size())});
}

constexpr std::size_t kNamed = 4;  ///< more are counted

std::string listed(const std::vector<std::string>& names) {
  std::string text;
  for (std::size_t i = 0; i < names.size() && i < kNamed; ++i) text += (i ? ", " : "") + names[i];
  if (names.size() > kNamed) text += fmt::format(" and {} more", names.size() - kNamed);
  return text;
}

}  // namespace

std::vector<ScalarSignal> scalar_inputs(const Stage& stage) {
  const Graph& g = *stage.source;
  const Natures natures(g);
  std::vector<ScalarSignal> list;
  for (const int i : detail::as_declared(g.inputs)) {
    const Input& input = g.inputs[at(i)];
    for (int row = 0; row < input.size; ++row)
      add(list, input.name, input.size, row, input_unit(g, natures, input.signal, row));
  }
  return list;
}

std::vector<ScalarSignal> scalar_outputs(const Stage& stage) {
  const Graph& g = *stage.source;
  const Natures natures(g);
  std::vector<ScalarSignal> list;
  for (const int i : detail::as_declared(g.outputs)) {
    const Output& output = g.outputs[at(i)];
    for (int row = 0; row < output.size; ++row)
      add(list, output.name, output.size, row, output_unit(g, natures, output, row));
  }
  return list;
}

std::string drives(const Stage& stage, int input) {
  const Graph& g = *stage.source;
  std::vector<std::string> names;
  for (const Equation& e : g.equations)
    for (const Term& t : e.terms)
      if (e.target >= 0 && t.signal == g.inputs[at(input)].signal)
        names.push_back(name_of(g, e.target) + e.part.name());
  std::sort(names.begin(), names.end(),
            [](const auto& a, const auto& b) { return natural_compare(a, b) < 0; });
  names.erase(std::unique(names.begin(), names.end()), names.end());
  return listed(names);
}

std::string reads(const Stage& stage, int output) {
  const Graph& g = *stage.source;
  std::vector<std::string> names;
  for (const Term& t : g.outputs[at(output)].terms)
    if (t.signal >= 0) names.push_back(print(g, t));
  return listed(names);
}

}  // namespace titop::report
