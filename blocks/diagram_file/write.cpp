#include <fmt/format.h>

#include <fstream>
#include <map>
#include <set>
#include <titop/blocks/diagram_file/blocks.hpp>
#include <titop/blocks/diagram_file/diagram_file.hpp>
#include <titop/blocks/diagram_file/json.hpp>

namespace titop {

using diagram_file::Json;

namespace {

class DiagramWriter {
 public:
  explicit DiagramWriter(const Graph& graph) : g_(graph) {}

  Json all() {
    require_distinct();
    Json blocks = Json::array();
    for (const Node& node : g_.nodes) blocks.push_back(block(node));
    Json json = {{"format", "titop scene 1"}, {"name", g_.name}, {"parameters", Json::array()}};
    for (const Parameter& p : g_.parameters)
      json["parameters"].push_back({{"name", p.name}, {"value", p.value}});
    json["bodies"] = bodies_;
    json["blocks"] = std::move(blocks);
    json["inputs"] = Json::array();
    for (const Input& in : g_.inputs)
      json["inputs"].push_back({{"name", in.name}, {"size", in.size}});
    json["equations"] = Json::array();
    for (const Equation& e : g_.equations) json["equations"].push_back(equation(e));
    json["outputs"] = Json::array();
    for (const Output& o : g_.outputs) json["outputs"].push_back(output(o));
    return json;
  }

 private:
  /// Names are how the file points to things.
  void require_distinct() const {
    std::vector<Mistake> mistakes = g_.mistakes;
    const auto look = [&](const auto& list, const char* subject) {
      std::set<std::string> seen;
      for (const auto& item : list)
        if (!seen.insert(item.name).second)
          mistakes.push_back({Code::duplicate_name,
                              fmt::format("a second {} is called \"{}\"", subject, item.name),
                              {"at " + to_string(item.where)},
                              "give each a name of its own"});
    };
    look(g_.nodes, "block");
    look(g_.inputs, "input");
    look(g_.parameters, "parameter");
    if (!mistakes.empty()) throw Error(std::move(mistakes));
  }

  Json value(const Value& v) const {
    if (!v.is_parameter()) return v.nominal();
    Json json = {{"parameter", g_.parameters[static_cast<std::size_t>(v.index())].name}};
    if (v.scale() != 1) json["scale"] = v.scale();
    return json;
  }

  Json block(const Node& node) {
    Json json = {{"name", node.name}};
    const auto body = [&](const ModalData& data) {
      const auto [at, is_new] =
          body_names_.insert({&data, fmt::format("body{}", body_names_.size() + 1)});
      if (is_new) bodies_[at->second] = diagram_file::body_json(data);
      return at->second;
    };
    diagram_file::write_block(
        *node.block, [&](const Value& v) { return value(v); }, body, json);
    return json;
  }

  Json signal(int index) const {
    const Signal& s = g_.signals[static_cast<std::size_t>(index)];
    if (s.role == Signal::Role::external)
      return Json::array({g_.inputs[static_cast<std::size_t>(s.spec)].name});
    const Node& node = g_.nodes[static_cast<std::size_t>(s.node)];
    const Interface& face = node.block->interface();
    if (s.channel >= 0) {
      const Channel& c = g_.channels[static_cast<std::size_t>(s.channel)];
      return Json::array({node.name, face.channels[static_cast<std::size_t>(c.spec)].name,
                          index == c.accel ? "accel" : "force"});
    }
    const auto& ports = s.role == Signal::Role::input ? face.inputs : face.outputs;
    return Json::array({node.name, ports[static_cast<std::size_t>(s.spec)].name});
  }

  static Json part(const Part& p) {
    return {{"part", p.name()}, {"rows", diagram_file::rows(p.rows())}};
  }

  Json rotation(const Rotation& T) const {
    Json steps = Json::array();
    for (const Rotation::Step& step : T.steps()) {
      if (const auto* M = std::get_if<Matrix3d>(&step)) {
        steps.push_back(diagram_file::rows(*M));
      } else {
        const auto& turn = std::get<Rotation::Turn>(step);
        steps.push_back({{"about", diagram_file::list(turn.axis)}, {"angle", value(turn.angle)}});
      }
    }
    return {{"rotation", std::move(steps)}, {"to", T.to()}, {"from", T.from()}};
  }

  Json factor(const Factor& f) const {
    if (const auto* v = std::get_if<Value>(&f)) return value(*v);
    if (const auto* T = std::get_if<Rotation>(&f)) return rotation(*T);
    if (const auto* M = std::get_if<Matrix>(&f)) return {{"matrix", diagram_file::rows(*M->value)}};
    return part(std::get<Part>(f));
  }

  Json terms(const std::vector<Term>& list) const {
    Json result = Json::array();
    for (const Term& t : list) {
      Json json = {{"signal", signal(t.signal)}};
      if (t.of != Term::Of::signal)
        json["read"] = t.of == Term::Of::reaction   ? "reaction"
                       : t.of == Term::Of::position ? "position"
                                                    : "rate";
      if (t.sign != 1) json["sign"] = t.sign;
      if (!t.factors.empty()) json["factors"] = Json::array();
      for (const Factor& f : t.factors) json["factors"].push_back(factor(f));
      result.push_back(std::move(json));
    }
    return result;
  }

  Json equation(const Equation& e) const {
    Json json = {{"of", signal(e.target)}};
    if (!e.part.whole()) json["part"] = part(e.part);
    if (e.accumulate) json["add"] = true;
    if (e.of_spec) json["of_spec"] = true;
    json["terms"] = terms(e.terms);
    return json;
  }

  Json output(const Output& o) const {
    Json json = {{"name", o.name}, {"size", o.size}};
    if (o.set) json["terms"] = terms(o.terms);
    return json;
  }

  const Graph& g_;
  std::map<const ModalData*, std::string> body_names_;
  Json bodies_ = Json::object();
};

}  // namespace

std::string diagram_json(const Diagram& diagram) {
  try {
    return DiagramWriter(diagram.graph()).all().dump(1) + "\n";
  } catch (const Json::exception&) {
    throw Error(Code::bad_value,
                fmt::format("a name in the diagram {} is no UTF-8 text", diagram.name()),
                "write names in UTF-8");
  }
}

void write_diagram(const Diagram& diagram, const std::filesystem::path& path) {
  const std::string text = diagram_json(diagram);
  std::ofstream file(path, std::ios::binary);
  file << text;
  file.flush();
  if (!file)
    throw Error(Code::bad_file, fmt::format("{}: cannot be written", path.string()),
                "check that the folder exists and may be written to");
}

}  // namespace titop
