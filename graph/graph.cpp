#include <fmt/format.h>

#include <atomic>
#include <cmath>
#include <optional>
#include <titop/graph/graph.hpp>

namespace titop {

std::uint64_t next_graph_id() {
  static std::atomic<std::uint64_t> last = 0;
  return ++last;
}

using Eigen::MatrixXd;

std::string name_of(const Graph& graph, int signal) {
  if (signal < 0) return "(nothing)";
  const Signal& s = graph.signals[static_cast<std::size_t>(signal)];
  if (s.role == Signal::Role::external) return graph.inputs[static_cast<std::size_t>(s.spec)].name;
  const Node& node = graph.nodes[static_cast<std::size_t>(s.node)];
  if (s.channel >= 0) {
    const Channel& c = graph.channels[static_cast<std::size_t>(s.channel)];
    const auto& spec = node.block->interface().channels[static_cast<std::size_t>(c.spec)];
    return fmt::format("{}.{}", channel_name(graph, s.channel),
                       signal == c.accel ? spec.accel_name : spec.force_name);
  }
  if (s.role == Signal::Role::state) return node.name + ".x";
  const Interface& face = node.block->interface();
  const auto& ports = s.role == Signal::Role::input ? face.inputs : face.outputs;
  return fmt::format("{}.{}", node.name, ports[static_cast<std::size_t>(s.spec)].name);
}

std::string channel_name(const Graph& graph, int channel) {
  const Channel& c = graph.channels[static_cast<std::size_t>(channel)];
  const Node& node = graph.nodes[static_cast<std::size_t>(c.node)];
  const auto& spec = node.block->interface().channels[static_cast<std::size_t>(c.spec)];
  if (spec.name.empty()) return node.name;
  if (spec.takes == Takes::force && spec.name != "child")
    return fmt::format("{}.child(\"{}\")", node.name, spec.name);
  return fmt::format("{}.{}", node.name, spec.name);
}

bool is_outward(const Graph& g, int channel) {
  const Channel& c = g.channels[static_cast<std::size_t>(channel)];
  const Node& node = g.nodes[static_cast<std::size_t>(c.node)];
  return is_outward(node.block->interface().channels[static_cast<std::size_t>(c.spec)]);
}

std::string frame_name(const Graph& graph, int frame) {
  if (frame == kNoFrame) return "no frame";
  if (frame == kUnknownFrame) return "an unknown frame";
  return fmt::format("frame {}", graph.nodes[static_cast<std::size_t>(frame)].name);
}

Part::Part(MatrixXd rows, std::string name) {
  if (rows.size() > 0)
    held_ = std::make_shared<const NamedRows>(NamedRows{std::move(rows), std::move(name)});
}

const Part::NamedRows& Part::held() const {
  static const NamedRows all;
  return held_ ? *held_ : all;
}

std::vector<double> nominal_values(const Graph& graph) {
  std::vector<double> values;
  for (const Parameter& p : graph.parameters) values.push_back(p.value);
  return values;
}

namespace {

/// A rotation on a vector of 3 or a dual vector of 6.
MatrixXd on_vector(const Matrix3d& T, int size) {
  if (size == 3) return T;
  MatrixXd both = MatrixXd::Zero(6, 6);
  both.topLeftCorner<3, 3>() = T;
  both.bottomRightCorner<3, 3>() = T;
  return both;
}

int rows_after(const Factor& factor, int rows) {
  if (const auto* m = std::get_if<Matrix>(&factor))
    return m->value->cols() == rows ? static_cast<int>(m->value->rows()) : -1;
  if (const auto* p = std::get_if<Part>(&factor))
    return p->whole() ? rows : p->rows().cols() == rows ? static_cast<int>(p->rows().rows()) : -1;
  if (const auto* T = std::get_if<Rotation>(&factor))
    return rows == 3 || rows == 6 || T->is_identity() ? rows : -1;
  return rows;
}

}  // namespace

int rows_of(const Graph& graph, const Term& term) {
  int rows = graph.signals[static_cast<std::size_t>(term.signal)].size;
  for (auto f = term.factors.rbegin(); f != term.factors.rend() && rows >= 0; ++f)
    rows = rows_after(*f, rows);
  return rows;
}

MatrixXd coefficient(const Graph& graph, const Term& term, ParameterValues values) {
  const int size = graph.signals[static_cast<std::size_t>(term.signal)].size;
  std::optional<MatrixXd> result;  // none: the identity
  const auto apply = [&](MatrixXd m) { result = result ? MatrixXd(m * *result) : std::move(m); };
  double scale = term.sign;
  for (auto f = term.factors.rbegin(); f != term.factors.rend(); ++f) {
    if (const auto* k = std::get_if<Value>(&*f)) {
      scale *= k->at(values);
    } else if (const auto* m = std::get_if<Matrix>(&*f)) {
      apply(*m->value);
    } else if (const auto* p = std::get_if<Part>(&*f)) {
      if (!p->whole()) apply(p->rows());
    } else if (const auto& T = std::get<Rotation>(*f); !T.is_identity()) {
      apply(on_vector(T.at(values), result ? static_cast<int>(result->rows()) : size));
    }
  }
  if (!result) return scale * MatrixXd::Identity(size, size);
  if (scale != 1) *result *= scale;
  return std::move(*result);
}

Pattern structure(const Graph& graph, const Term& term) {
  const int size = graph.signals[static_cast<std::size_t>(term.signal)].size;
  const auto product = [](const Pattern& a, const Pattern& b) {
    return Pattern((a.cast<int>() * b.cast<int>()).array() > 0);
  };
  std::optional<Pattern> result;  // none: the identity
  const auto apply = [&](Pattern p) { result = result ? product(p, *result) : std::move(p); };
  for (auto f = term.factors.rbegin(); f != term.factors.rend(); ++f) {
    if (const auto* m = std::get_if<Matrix>(&*f)) {
      apply(m->pattern ? *m->pattern : Pattern(m->value->array() != 0));
    } else if (const auto* p = std::get_if<Part>(&*f)) {
      if (!p->whole()) apply(p->rows().array() != 0);
    } else if (const auto* T = std::get_if<Rotation>(&*f); T && !T->is_identity()) {
      const int rows = result ? static_cast<int>(result->rows()) : size;
      apply(on_vector(Matrix3d::Ones(), rows).array() != 0);
    }
  }
  return result ? std::move(*result) : Pattern(Pattern::Identity(size, size));
}

namespace {

/// k if the matrix is k times the identity (`lower` makes such a matrix of a number), else NaN.
double multiple_of_identity(const MatrixXd& m) {
  if (m.rows() != m.cols() || m.size() == 0) return std::nan("");
  const double k = m(0, 0);
  return m == MatrixXd(k * MatrixXd::Identity(m.rows(), m.cols())) ? k : std::nan("");
}

/// The term without its sign; `negative` takes the sign.
std::string print_unsigned(const Graph& graph, const Term& term, bool& negative) {
  std::string text, parts;
  negative = term.sign < 0;
  for (const Factor& f : term.factors) {
    if (const auto* k = std::get_if<Value>(&f)) {
      const double number = k->is_parameter() ? k->scale() : k->nominal();
      negative = negative != (number < 0);
      if (!k->is_parameter() || std::abs(number) != 1)
        text += fmt::format("{:.6g} * ", std::abs(number));
      if (const auto i = static_cast<std::size_t>(k->index()); k->is_parameter())
        text += (i < graph.parameters.size() ? graph.parameters[i].name : "(no parameter)") + " * ";
    } else if (const auto* T = std::get_if<Rotation>(&f)) {
      if (!T->is_identity() || !T->to().empty())
        text += T->to().empty() ? "T * " : fmt::format("T({}<-{}) * ", T->to(), T->from());
    } else if (const auto* m = std::get_if<Matrix>(&f)) {
      const double gain = multiple_of_identity(*m->value);
      negative = negative != (gain < 0);
      if (std::isnan(gain))
        text += "M * ";
      else if (std::abs(gain) != 1)
        text += fmt::format("{:.6g} * ", std::abs(gain));
    } else {
      parts += std::get<Part>(f).name();
    }
  }
  text += term.of == Term::Of::signal
              ? name_of(graph, term.signal)
              : channel_name(graph, graph.signals[static_cast<std::size_t>(term.signal)].channel) +
                    (term.of == Term::Of::reaction   ? ".reaction"
                     : term.of == Term::Of::position ? ".position"
                                                     : ".rate");
  return text + parts;
}

}  // namespace

std::string print(const Graph& graph, const Term& term) {
  bool negative = false;
  const std::string text = print_unsigned(graph, term, negative);
  return negative ? "-" + text : text;
}

std::string print(const Graph& graph, const Equation& equation) {
  std::string text = name_of(graph, equation.target) + equation.part.name();
  text += equation.accumulate ? " +=" : " =";
  if (equation.terms.empty()) return text + " 0";
  for (std::size_t i = 0; i < equation.terms.size(); ++i) {
    bool negative = false;
    const std::string term = print_unsigned(graph, equation.terms[i], negative);
    if (i == 0)
      text += negative ? " -" : " ";
    else
      text += negative ? " - " : " + ";
    text += term;
  }
  return text;
}

int add_node(Graph& graph, std::string name, BlockPtr block, SourceLine where) {
  const int node = static_cast<int>(graph.nodes.size());
  const Interface& face = block->interface();
  const bool framed = block->has_frame();
  graph.nodes.push_back({.name = std::move(name),
                         .block = block,
                         .first_signal = static_cast<int>(graph.signals.size()),
                         .first_channel = static_cast<int>(graph.channels.size()),
                         .declared = node,
                         .where = where});
  int u = 0, y = 0;
  for (int i = 0; i < static_cast<int>(face.channels.size()); ++i) {
    const ChannelSpec& spec = face.channels[static_cast<std::size_t>(i)];
    const int first = static_cast<int>(graph.signals.size());
    const bool takes_force = spec.takes == Takes::force;
    Signal s{.node = node, .spec = i, .size = spec.size};
    s.frame = framed && spec.size == 6 ? node : kNoFrame;
    s.channel = static_cast<int>(graph.channels.size());
    s.quantity = Quantity::acceleration;
    s.role = takes_force ? Signal::Role::output : Signal::Role::input;
    s.first = takes_force ? y : u;
    graph.signals.push_back(s);
    s.quantity = Quantity::force;
    s.role = takes_force ? Signal::Role::input : Signal::Role::output;
    s.first = takes_force ? u : y;
    graph.signals.push_back(s);
    graph.channels.push_back({node, i, spec.size, first, first + 1, spec.takes});
    u += spec.size;
    y += spec.size;
  }
  for (const bool in : {true, false}) {
    const auto& ports = in ? face.inputs : face.outputs;
    for (int i = 0; i < static_cast<int>(ports.size()); ++i) {
      const PortSpec& spec = ports[static_cast<std::size_t>(i)];
      Signal s{.role = in ? Signal::Role::input : Signal::Role::output,
               .quantity = spec.quantity,
               .node = node,
               .spec = i,
               .size = spec.size,
               .first = in ? u : y};
      s.frame = framed && spec.size == 6 ? node : kNoFrame;
      graph.signals.push_back(s);
      (in ? u : y) += spec.size;
    }
  }
  if (const int n = static_cast<int>(face.states.size()); n > 0) {
    graph.nodes.back().state = static_cast<int>(graph.signals.size());
    graph.signals.push_back(Signal{.role = Signal::Role::state, .node = node, .size = n});
  }
  graph.nodes.back().end_signal = static_cast<int>(graph.signals.size());
  return node;
}

int add_input(Graph& graph, std::string name, int size, SourceLine where) {
  const int index = static_cast<int>(graph.inputs.size());
  const int signal = static_cast<int>(graph.signals.size());
  graph.signals.push_back(Signal{.role = Signal::Role::external, .spec = index, .size = size});
  graph.inputs.push_back({std::move(name), signal, size, index, where});
  return signal;
}

int input_signal(const Graph& g, int node, int column) {
  const Node& n = g.nodes[static_cast<std::size_t>(node)];
  const auto first = g.channels.begin() + n.first_channel;
  const auto last = first + static_cast<std::ptrdiff_t>(n.block->interface().channels.size());
  const auto taken = [&](const Channel& c) { return c.takes == Takes::force ? c.force : c.accel; };
  const auto first_row = [&](int s) { return g.signals[static_cast<std::size_t>(s)].first; };
  const auto found = std::partition_point(
      first, last, [&](const Channel& c) { return first_row(taken(c)) < column; });
  if (found != last && first_row(taken(*found)) == column) return taken(*found);
  for (int s = n.first_signal; s < end_signal(g, node); ++s)
    if (g.signals[static_cast<std::size_t>(s)].role == Signal::Role::input &&
        first_row(s) == column)
      return s;
  return -1;
}

int natural_compare(std::string_view a, std::string_view b) {
  std::size_t i = 0, j = 0;
  const auto digit = [](char c) { return c >= '0' && c <= '9'; };
  while (i < a.size() && j < b.size()) {
    if (digit(a[i]) && digit(b[j])) {
      std::size_t i0 = i, j0 = j;
      while (i0 < a.size() && a[i0] == '0') ++i0;
      while (j0 < b.size() && b[j0] == '0') ++j0;
      std::size_t i1 = i0, j1 = j0;
      while (i1 < a.size() && digit(a[i1])) ++i1;
      while (j1 < b.size() && digit(b[j1])) ++j1;
      if (i1 - i0 != j1 - j0) return i1 - i0 < j1 - j0 ? -1 : 1;
      if (const int c = a.substr(i0, i1 - i0).compare(b.substr(j0, j1 - j0)); c != 0) return c;
      i = i1;
      j = j1;
    } else if (a[i] != b[j]) {
      return a[i] < b[j] ? -1 : 1;
    } else {
      ++i, ++j;
    }
  }
  if (i < a.size() || j < b.size()) return i < a.size() ? 1 : -1;
  return a.compare(b);  // "z01" and "z1" are different names
}

}  // namespace titop
