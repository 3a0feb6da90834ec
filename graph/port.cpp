#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <titop/graph/port.hpp>

namespace titop::detail {
namespace {

int size_of(const Graph& graph, int signal, const Part& part) {
  if (!part.whole()) return static_cast<int>(part.rows().rows());
  return signal < 0 ? 6 : graph.signals[static_cast<std::size_t>(signal)].size;
}

std::string text_of(const Graph& graph, const Expr& signal) {
  return print(graph, signal.terms().front());
}

const Interface& face_of(const Graph& graph, int node) {
  return graph.nodes[static_cast<std::size_t>(node)].block->interface();
}

/// The identity without names, alone between two frames, is the rotation from one to the other.
void name_identity(const Graph& g, Term& term, int target) {
  const auto frame = [&](int s) {
    return s < 0 ? kNoFrame : g.signals[static_cast<std::size_t>(s)].frame;
  };
  const int to = frame(target), from = frame(term.signal);
  if (to < 0 || from < 0 || to == from) return;
  Rotation* alone = nullptr;
  for (Factor& f : term.factors) {
    auto* T = std::get_if<Rotation>(&f);
    if (std::holds_alternative<Matrix>(f) || (T && alone)) return;
    if (T) alone = T;
  }
  if (!alone || !alone->is_identity() || !alone->nameless()) return;
  const auto name = [&](int node) { return g.nodes[static_cast<std::size_t>(node)].name; };
  *alone = alone->named(name(to), name(from));
}

}  // namespace

Expr SignalRef::expr() const {
  if (signal_ < 0) return Expr(graph_, Term{.signal = signal_});
  Term term{.signal = signal_, .of = of_};
  if (!part_.whole()) term.factors.emplace_back(part_);
  return Expr(graph_, std::move(term));
}

void SignalRef::set(const Rhs& rhs, bool accumulate, double sign) const {
  if (!graph_) return;
  if (rhs.expr().graph() && rhs.expr().graph() != graph_)
    throw Error(Code::unknown_name,
                fmt::format("the equation of {} takes a signal from another diagram",
                            name_of(*graph_, signal_)),
                "take both sides from the same Diagram", {"written at " + to_string(rhs.where())});
  note_missing(*graph_, {Term{.signal = signal_}}, rhs.where());
  note_missing(*graph_, rhs.expr().terms(), rhs.where());
  if (signal_ < 0) return;
  Equation equation{.target = signal_,
                    .accumulate = accumulate,
                    .part = part_,
                    .terms = rhs.expr().terms(),
                    .where = rhs.where()};
  for (Term& term : equation.terms) {
    term.sign *= sign;
    name_identity(*graph_, term, signal_);
  }
  note_foreign_parameters(*graph_, equation.terms, rhs.where());
  graph_->equations.push_back(std::move(equation));
}

SignalRef SignalRef::half(std::string name, Eigen::Index first) const {
  if (!part_.whole())
    throw Error(Code::size, fmt::format("{} has no part {}", text_of(*graph_, expr()), name),
                ".linear and .angular belong to whole dual vectors of 6");
  SignalRef half = *this;
  half.part_ = {Eigen::MatrixXd::Identity(6, 6).middleRows(first, 3), std::move(name)};
  return half;
}

SignalRef SignalRef::linear() const { return half(".linear", 0); }

SignalRef SignalRef::angular() const { return half(".angular", 3); }

SignalRef SignalRef::along(const Vector3d& r) const {
  const std::string name = fmt::format(".along({}, {}, {})", r.x(), r.y(), r.z());
  if (!(r.norm() > 0) || !std::isfinite(r.norm()))
    throw Error(Code::bad_value, fmt::format("{}{}: no direction", text_of(*graph_, expr()), name),
                "give a finite vector other than 0");
  if (const int size = size_of(*graph_, signal_, part_); size != 3)
    throw Error(
        Code::size,
        fmt::format("{} has size {} and no part {}", text_of(*graph_, expr()), size, name),
        "along(r) belongs to vectors of 3: take .linear or .angular of a dual vector first");
  SignalRef component = *this;
  component.part_ = {part_.whole() ? Eigen::MatrixXd(r.normalized().transpose())
                                   : Eigen::MatrixXd(r.normalized().transpose() * part_.rows()),
                     part_.name() + name};
  return component;
}

namespace {

/// Position of the port of this name, -1 if there is none. Ports in1, in2, ... (Sum) mostly are at
/// the position of their number: all of them are found in linear time.
int find_port(const std::vector<PortSpec>& ports, std::string_view name) {
  std::size_t number = 0;
  const std::size_t digits = name.find_first_of("123456789");
  if (digits != std::string_view::npos)
    std::from_chars(name.data() + digits, name.data() + name.size(), number);
  if (number > 0 && number <= ports.size() && ports[number - 1].name == name)
    return static_cast<int>(number) - 1;
  const auto at =
      std::find_if(ports.begin(), ports.end(), [&](const PortSpec& p) { return p.name == name; });
  return at == ports.end() ? -1 : static_cast<int>(at - ports.begin());
}

}  // namespace

int port_signal(const Graph& graph, int node, std::string_view name) {
  const Node& n = graph.nodes[static_cast<std::size_t>(node)];
  const Interface& face = n.block->interface();
  int first = n.first_signal + 2 * static_cast<int>(face.channels.size());
  for (const auto* ports : {&face.inputs, &face.outputs}) {
    if (const int port = find_port(*ports, name); port >= 0) return first + port;
    first += static_cast<int>(ports->size());
  }
  std::string names;
  for (const auto* ports : {&face.inputs, &face.outputs})
    for (const PortSpec& p : *ports) names += (names.empty() ? "" : ", ") + p.name;
  throw Error(Code::unknown_name, fmt::format("{}.{} does not exist", n.name, name),
              fmt::format("the one-way ports of this {} are: {}", n.block->type(), names));
}

int find_channel(const Graph& graph, int node, std::string_view name) {
  return face_of(graph, node).find_channel(name);
}

namespace {

bool is_child(const ChannelSpec& c, int size) { return c.takes == Takes::force && c.size == size; }

}  // namespace

int find_child(const Graph& graph, int node, std::string_view name, int size) {
  const int spec = find_channel(graph, node, name);
  const auto& channels = face_of(graph, node).channels;
  return spec >= 0 && is_child(channels[static_cast<std::size_t>(spec)], size) ? spec : -1;
}

bool belongs_to(const Value& v, const Graph& graph) {
  return v.owner() == graph.id && v.index() < static_cast<int>(graph.parameters.size());
}

void note_foreign_parameters(Graph& graph, const std::vector<Term>& terms, const SourceLine& at) {
  const auto look_at = [&](const Value& v) {
    if (!v.is_parameter() || belongs_to(v, graph)) return;
    graph.mistakes.push_back(
        {Code::unknown_name,
         fmt::format("a parameter of another diagram, nominally {}, is used", v.parameter()),
         {"written at " + to_string(at)},
         "make the parameter with param(...) of this diagram"});
  };
  for (const Term& term : terms)
    for (const Factor& factor : term.factors) {
      if (const auto* k = std::get_if<Value>(&factor)) look_at(*k);
      if (const auto* T = std::get_if<Rotation>(&factor))
        for (const Value& angle : T->values()) look_at(angle);
    }
}

int only_child(const Graph& graph, int node, int size) {
  int found = -1;
  const auto& channels = face_of(graph, node).channels;
  for (std::size_t i = 0; i < channels.size(); ++i) {
    if (channels[i].name == "parent" || !is_child(channels[i], size)) continue;
    if (found >= 0) return -1;
    found = static_cast<int>(i);
  }
  return found;
}

void note_missing(Graph& graph, const std::vector<Term>& terms, const SourceLine& at) {
  for (const Term& term : terms) {
    if (term.signal > -2) continue;
    const int node = -2 - term.signal;
    int size = 0;  // child points have as many degrees of freedom as the parent, shapes have one
    for (const ChannelSpec& c : face_of(graph, node).channels) size = std::max(size, c.size);
    note_unknown_channel(graph, node, "child", size, at);
  }
}

void note_unknown_channel(Graph& graph, int node, std::string_view name, int size, SourceLine at) {
  std::string names;
  for (const ChannelSpec& c : face_of(graph, node).channels)
    if (is_child(c, size)) names += (names.empty() ? "" : ", ") + c.name;
  const std::string& who = graph.nodes[static_cast<std::size_t>(node)].name;
  Mistake mistake{Code::unknown_name, {}, {}, {}};
  mistake.message = name == "child"
                        ? fmt::format("{}.child: {} has not exactly one child point", who, who)
                        : fmt::format("{} has no child point \"{}\"", who, name);
  mistake.details.push_back("written at " + to_string(at));
  mistake.hint = names.empty() ? fmt::format("{} has no child points; add one to its data", who)
                               : fmt::format("its child points are: {}", names);
  // mount reads a port twice.
  const bool known =
      std::any_of(graph.mistakes.begin(), graph.mistakes.end(), [&](const Mistake& m) {
        return m.message == mistake.message && m.details == mistake.details;
      });
  if (!known) graph.mistakes.push_back(std::move(mistake));
}

}  // namespace titop::detail
