#include <fmt/format.h>

#include <cmath>
#include <map>
#include <set>
#include <titop/blocks/diagram_file/blocks.hpp>
#include <titop/blocks/diagram_file/diagram_file.hpp>
#include <titop/blocks/diagram_file/json.hpp>
#include <titop/blocks/fe/text_file.hpp>
#include <titop/graph/linalg/rounding.hpp>
#include <type_traits>

namespace titop {

using diagram_file::Json;
using diagram_file::JsonPlace;

namespace {

/// No source line: later messages give the place in the file instead.
constexpr SourceLine kRead = {};

/// A block that is made already.
struct Ready {
  BlockPtr block;
  struct Handle {
    Handle(Graph* graph_of, int node_of) : graph(graph_of), node(node_of) {}
    Graph* graph;
    int node;
  };
};
BlockPtr as_block(const Ready& ready) { return ready.block; }

class DiagramReader {
 public:
  explicit DiagramReader(const JsonPlace& all) : diagram(all.at("name").text()) {
    all.only(
        {"format", "name", "parameters", "bodies", "blocks", "inputs", "equations", "outputs"});
    if (all.at("format").text() != "titop scene 1") all.at("format").refuse("\"titop scene 1\"");
    each(all.at("parameters"), [&](const JsonPlace& p) { read_parameter(p); });
    for (const std::string& name : all.at("bodies").keys()) {
      const JsonPlace body = all.at("bodies").at(name.c_str());
      bodies_.insert_or_assign(name,
                               named(body, name, [&] { return diagram_file::read_body(body); }));
    }
    each(all.at("blocks"), [&](const JsonPlace& p) { read_block(p); });
    each(all.at("inputs"), [&](const JsonPlace& p) { read_input(p); });
    each(all.at("equations"), [&](const JsonPlace& p) { read_equation(p); });
    each(all.at("outputs"), [&](const JsonPlace& p) { read_output(p); });
  }

  Diagram diagram;

 private:
  template <class Read>
  static void each(const JsonPlace& list, Read read) {
    for (std::size_t i = 0; i < list.size(); ++i) read(list.item(i));
  }

  /// Returns make(); adds place and name to mistakes in its numbers.
  template <class Make>
  static std::invoke_result_t<Make> named(const JsonPlace& place, const std::string& name,
                                          Make make) {
    try {
      return make();
    } catch (const Error& error) {
      place.rethrow(error, name);
    }
  }

  void read_parameter(const JsonPlace& p) {
    p.only({"name", "value"});
    const std::string name = p.at("name").text();
    if (parameters_.contains(name)) p.at("name").refuse("a name that no parameter before has");
    parameters_[name] = diagram.param(name, p.at("value").number(), kRead);
  }

  Value read_value(const JsonPlace& p) const {
    if (p.is_number()) return p.number();
    if (!p.has("parameter")) p.refuse("a number or {\"parameter\": name}");
    p.only({"parameter", "scale"});
    const auto at = parameters_.find(p.at("parameter").text());
    if (at == parameters_.end()) p.at("parameter").refuse("the name of a parameter");
    return {p.has("scale") ? p.at("scale").number() : 1, at->second};
  }

  void read_block(const JsonPlace& p) {
    const std::string name = p.at("name").text();
    if (nodes_.contains(name)) p.at("name").refuse("a name that no block before has");
    const auto body = [&](const JsonPlace& place) {
      const auto at = bodies_.find(place.text());
      if (at == bodies_.end()) place.refuse("a name among the bodies");
      return at->second;
    };
    const auto value = [&](const JsonPlace& place) { return read_value(place); };
    const Ready ready{named(p, name, [&] { return diagram_file::read_block(p, value, body); })};
    const Ready::Handle handle = diagram.add(name, ready, kRead);
    graph_ = handle.graph;
    nodes_[name] = handle.node;
  }

  void read_input(const JsonPlace& p) {
    p.only({"name", "size"});
    const std::string name = p.at("name").text();
    if (inputs_.contains(name)) p.at("name").refuse("a name that no input before has");
    const InputRef input = diagram.input(name, p.at("size").signal_size(), kRead);
    graph_ = input.graph();
    inputs_[name] = input.signal();
  }

  int channel_signal(const JsonPlace& p, const Node& node) const {
    const int spec = node.block->interface().find_channel(p.item(1).text());
    if (spec < 0) p.item(1).refuse("a channel of " + node.name);
    const std::string which = p.item(2).text();
    if (which != "accel" && which != "force") p.item(2).refuse("accel or force");
    const Channel& c = graph_->channels[static_cast<std::size_t>(node.first_channel + spec)];
    return which == "accel" ? c.accel : c.force;
  }

  int read_signal(const JsonPlace& p) const {
    if (p.size() < 1 || p.size() > 3)
      p.refuse("[block, channel, \"accel\" or \"force\"], [block, port] or [input]");
    const std::string name = p.item(0).text();
    if (p.size() == 1) {
      const auto at = inputs_.find(name);
      if (at == inputs_.end()) p.item(0).refuse("the name of an input");
      return at->second;
    }
    const auto at = nodes_.find(name);
    if (at == nodes_.end()) p.item(0).refuse("the name of a block");
    const Node& node = graph_->nodes[static_cast<std::size_t>(at->second)];
    if (p.size() == 3) return channel_signal(p, node);
    try {
      return detail::port_signal(*graph_, at->second, p.item(1).text());
    } catch (const Error&) {
      p.item(1).refuse("a one-way port of " + name);
    }
  }

  static Part read_part(const JsonPlace& p) {
    p.only({"part", "rows"});
    const Eigen::MatrixXd rows = p.at("rows").matrix(-1, -1);
    if (rows.rows() == 0 || !(rows * rows.transpose()).isIdentity(linalg::kMatrixDigits))
      p.at("rows").refuse("orthonormal rows, at least one");
    return {rows, p.at("part").text()};
  }

  Rotation read_rotation(const JsonPlace& p) const {
    p.only({"rotation", "to", "from"});
    std::vector<Rotation::Step> steps;
    each(p.at("rotation"), [&](const JsonPlace& step) {
      if (!step.has("about")) {
        steps.emplace_back(Matrix3d(step.matrix(3, 3)));
        return;
      }
      step.only({"about", "angle"});
      steps.emplace_back(Rotation::Turn{step.at("about").vector(3), read_value(step.at("angle"))});
    });
    return named(p, "rotation", [&] { return Rotation::of_steps(std::move(steps)); })
        .named(p.at("to").text(), p.at("from").text());
  }

  Factor read_factor(const JsonPlace& p) const {
    if (p.has("rotation")) return read_rotation(p);
    if (p.has("part")) return read_part(p);
    if (!p.has("matrix")) return read_value(p);
    p.only({"matrix"});
    return Matrix{std::make_shared<const Eigen::MatrixXd>(p.at("matrix").matrix(-1, -1)), nullptr};
  }

  Term::Of read_of(const JsonPlace& p) const {
    if (!p.has("read")) return Term::Of::signal;
    const std::string subject = p.at("read").text();
    if (subject == "reaction") return Term::Of::reaction;
    if (subject == "position") return Term::Of::position;
    if (subject != "rate") p.at("read").refuse("reaction, position or rate");
    return Term::Of::rate;
  }

  std::vector<Term> read_terms(const JsonPlace& list) const {
    std::vector<Term> terms;
    each(list, [&](const JsonPlace& p) {
      p.only({"signal", "read", "sign", "factors"});
      Term term{.signal = read_signal(p.at("signal")), .of = read_of(p)};
      const Signal& s = graph_->signals[static_cast<std::size_t>(term.signal)];
      if (term.of != Term::Of::signal && s.channel < 0)
        p.at("read").refuse("nothing: only channels have reactions, positions and rates");
      if (term.of == Term::Of::reaction && s.quantity != Quantity::force)
        p.at("read").refuse("position or rate: the reaction of a channel is read from its force");
      if ((term.of == Term::Of::position || term.of == Term::Of::rate) &&
          s.quantity != Quantity::acceleration)
        p.at("read").refuse("reaction: positions and rates are read from the acceleration");
      if (p.has("sign")) term.sign = p.at("sign").number();
      if (std::abs(term.sign) != 1) p.at("sign").refuse("1 or -1; other numbers are factors");
      if (p.has("factors"))
        each(p.at("factors"), [&](const JsonPlace& f) { term.factors.push_back(read_factor(f)); });
      terms.push_back(std::move(term));
    });
    return terms;
  }

  void read_equation(const JsonPlace& p) {
    p.only({"of", "part", "add", "of_spec", "terms"});
    Equation e{.target = read_signal(p.at("of"))};
    const Signal& s = graph_->signals[static_cast<std::size_t>(e.target)];
    if (s.channel < 0 && s.role != Signal::Role::input)
      p.at("of").refuse("a signal that can be driven: a channel's, or a port that goes in");
    if (p.has("part")) e.part = read_part(p.at("part"));
    if (!e.part.whole() && e.part.rows().cols() != s.size)
      p.at("part").refuse(fmt::format("rows of {} numbers", s.size));
    e.accumulate = p.has("add") && p.at("add").yes();
    if (e.accumulate && s.quantity != Quantity::force)
      p.at("add").refuse("forces only to be added to");
    e.of_spec = p.has("of_spec") && p.at("of_spec").yes();
    e.terms = read_terms(p.at("terms"));
    graph_->equations.push_back(std::move(e));
  }

  void read_output(const JsonPlace& p) {
    p.only({"name", "size", "terms"});
    const OutputRef output = diagram.output(p.at("name").text(), p.at("size").signal_size(), kRead);
    if (!p.has("terms")) return;
    output = Rhs(Expr{}, kRead);
    if (p.at("terms").size() == 0) return;
    if (!graph_) p.at("terms").refuse("none, in a scene without blocks and inputs");
    graph_->outputs.back().terms = read_terms(p.at("terms"));
  }

  Graph* graph_ = nullptr;  ///< of the diagram, once it has a block or an input
  std::map<std::string, Param> parameters_;
  std::map<std::string, FlexibleBody> bodies_;
  std::map<std::string, int> nodes_, inputs_;
};

/// Refuses an object with a repeated key: the parser would drop one of the two values. It parses
/// the text separately: a parser with a callback visits all items of a list after each.
class KeysOnce : public nlohmann::json_sax<Json> {
 public:
  explicit KeysOnce(std::string file) : file_(std::move(file)) {}

  bool start_object(std::size_t) override { return open(false); }
  bool start_array(std::size_t) override { return open(true); }
  bool end_object() override { return close(); }
  bool end_array() override { return close(); }
  bool null() override { return next(); }
  bool boolean(bool) override { return next(); }
  bool number_integer(std::int64_t) override { return next(); }
  bool number_unsigned(std::uint64_t) override { return next(); }
  bool number_float(double, const std::string&) override { return next(); }
  bool string(std::string&) override { return next(); }
  bool binary(Json::binary_t&) override { return next(); }
  bool key(std::string& name) override {
    open_.back().key = name;
    if (open_.back().keys.insert(name).second) return true;
    throw Error(Code::bad_file, fmt::format("{}: {}: the key is given twice", file_, path()),
                "keep one of them");
  }
  /// Json::parse reports it.
  bool parse_error(std::size_t, const std::string&, const Json::exception&) override {
    return false;
  }

 private:
  struct NestingLevel {
    bool list = false;
    std::ptrdiff_t item = -1;
    std::string key = {};
    std::set<std::string> keys = {};
  };

  bool next() {
    if (!open_.empty()) ++open_.back().item;
    return true;
  }
  bool open(bool list) {
    next();
    open_.push_back({.list = list});
    return true;
  }
  bool close() {
    open_.pop_back();
    return true;
  }

  std::string path() const {
    std::string path;
    for (const NestingLevel& l : open_)
      path += l.list ? fmt::format("[{}]", l.item) : (path.empty() ? "" : ".") + l.key;
    return path;
  }

  std::string file_;
  std::vector<NestingLevel> open_;
};

}  // namespace

Diagram parse_diagram(std::string_view json, const std::string& file) {
  Json all;
  try {
    KeysOnce keys(file);
    Json::sax_parse(json, &keys);
    all = Json::parse(json);
  } catch (const Json::parse_error& error) {
    throw Error(Code::bad_file, fmt::format("{}: no JSON text at byte {}", file, error.byte),
                "look at it with a JSON program such as jq, which shows the place");
  } catch (const Json::out_of_range&) {
    throw Error(Code::bad_file, fmt::format("{}: a number is too large for a double", file),
                "look for an exponent above 308");
  }
  return std::move(DiagramReader(JsonPlace(all, file)).diagram);
}

Diagram read_diagram(const std::filesystem::path& path) {
  const fe::TextFile file = fe::read_text(path);
  return parse_diagram(file.content, file.name);
}

}  // namespace titop
