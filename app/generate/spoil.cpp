#include <functional>
#include <map>
#include <stdexcept>

#include "generate/generate.hpp"

/// Plants one mistake into a valid scene. The place determines the names that the message must
/// contain. If the scene has no place for it, the exception names the option that brings one.
namespace titop::generate {
namespace {

using Names = std::vector<std::string>;

Json parse(const char* json) { return Json::parse(json); }

/// The last equation that gives a parent point another point's acceleration.
Json& mounting(Json& scene) {
  for (std::size_t i = scene["equations"].size(); i-- > 0;) {
    Json& e = scene["equations"][i];
    if (e["of"].size() == 3 && e["of"][1] == "parent" && e["of"][2] == "accel" &&
        !e["terms"].empty() && e["terms"][0]["signal"].size() == 3)
      return e;
  }
  throw std::domain_error("nothing is mounted; take more --bodies");
}
std::string mounted(Json& scene) { return mounting(scene)["of"][0]; }

Json& spring_mass(Json& scene) {
  for (Json& b : scene["blocks"])
    if (b["type"] == "SpringMass") return b;
  throw std::domain_error("there is no SpringMass; take --family scalar");
}

constexpr const char* kNotTurned = "nothing is turned; take --family spatial and more --bodies";

/// Adds lists of blocks, inputs, equations, outputs.
void add(Json& scene, const Json& more) {
  for (const auto& [key, list] : more.items())
    for (const Json& item : list) scene[key].push_back(item);
}

Names no_equation(Json& scene) {
  const Json gone = mounting(scene);
  Json rest = Json::array();
  for (const Json& e : scene["equations"])
    if (e != gone) rest.push_back(e);
  scene["equations"] = rest;
  return {gone["of"][0].get<std::string>() + ".parent.accel"};
}

Names two_equations(Json& scene) {
  const std::string name = mounted(scene);
  scene["equations"].push_back({{"of", {name, "parent", "force"}}, {"terms", Json::array()}});
  return {name + ".parent.accel", name + ".parent.force"};
}

Names size(Json& scene) {
  Json& input = scene["inputs"][0];
  input["size"] = input["size"].get<int>() + 1;
  return {input["name"]};
}

Names quantity(Json& scene) {
  Json& e = mounting(scene);
  e["terms"][0]["signal"][2] = "force";
  return {e["of"][0].get<std::string>() + ".parent.accel"};
}

Names frame(Json& scene) {
  for (Json& e : scene["equations"]) {
    if (e["of"][1] != "parent" || e["terms"].empty() || !e["terms"][0].contains("factors") ||
        !e["terms"][0]["factors"][0].contains("rotation"))
      continue;
    e["terms"][0].erase("factors");
    return {"frame " + e["of"][0].get<std::string>(),
            "frame " + e["terms"][0]["signal"][0].get<std::string>()};
  }
  throw std::domain_error(kNotTurned);
}

Names structure(Json& scene) {
  add(scene, parse(R"({"blocks": [{"name": "held twice", "type": "RigidBody", "mass": 2,
      "inertia": [[1, 0, 0], [0, 1, 0], [0, 0, 1]], "PA": [0, 0, 0],
      "children": [{"name": "C", "PC": [1, 0, 0]}]}],
    "inputs": [{"name": "here", "size": 6}, {"name": "there", "size": 6}],
    "equations": [{"of": ["held twice", "parent", "accel"], "terms": [{"signal": ["here"]}]},
                  {"of": ["held twice", "C", "accel"], "terms": [{"signal": ["there"]}]}],
    "outputs": [{"name": "pull", "size": 6,
                 "terms": [{"signal": ["held twice", "C", "force"]}]}]})"));
  return {"held twice.parent.accel", "held twice.child(\"C\").accel"};
}

Names ill_posed(Json& scene) {
  add(scene, parse(R"({"blocks": [{"name": "there", "type": "Gain", "gain": 4, "size": 1},
                                  {"name": "back", "type": "Gain", "gain": 0.25, "size": 1}],
    "inputs": [{"name": "push", "size": 1}],
    "equations": [{"of": ["there", "in"],
                   "terms": [{"signal": ["back", "out"]}, {"signal": ["push"]}]},
                  {"of": ["back", "in"], "terms": [{"signal": ["there", "out"]}]}],
    "outputs": [{"name": "round", "size": 1, "terms": [{"signal": ["there", "out"]}]}]})"));
  return {"there", "back"};
}

Names improper(Json& scene) {
  add(scene, parse(R"({"blocks": [{"name": "light", "type": "SpringMass", "mass": 3,
      "stiffness": 5, "damping": 0, "parent_mass": 0}],
    "inputs": [{"name": "push", "size": 1}],
    "equations": [{"of": ["light", "parent", "force"],
                   "terms": [{"signal": ["push"], "sign": -1}]}],
    "outputs": [{"name": "moved", "size": 1,
                 "terms": [{"signal": ["light", "parent", "accel"]}]}]})"));
  return {"push", "light.parent.force"};
}

Names kinematic_loop(Json& scene) {
  add(scene, parse(R"({"blocks": [
      {"name": "frame", "type": "RigidBody", "mass": 2, "PA": [0, 0, 0],
       "inertia": [[1, 0, 0], [0, 1, 0], [0, 0, 1]],
       "children": [{"name": "A", "PC": [1, 0, 0]}, {"name": "B", "PC": [2, 0.125, 0]}]},
      {"name": "bar", "type": "RigidBody", "mass": 1, "PA": [0.5, 0, 0],
       "inertia": [[1, 0, 0], [0, 1, 0], [0, 0, 1]], "children": [{"name": "T", "PC": [1, 0, 0]}]}],
    "inputs": [{"name": "push", "size": 6}],
    "equations": [
      {"of": ["frame", "parent", "force"], "terms": [{"signal": ["push"], "sign": -1}]},
      {"of": ["bar", "parent", "accel"], "terms": [{"signal": ["frame", "A", "accel"],
       "factors": [{"rotation": [], "to": "bar", "from": "frame"}]}]},
      {"of": ["frame", "A", "force"], "add": true, "terms": [{"signal": ["bar", "parent", "force"],
       "factors": [{"rotation": [], "to": "frame", "from": "bar"}]}]},
      {"of": ["bar", "T", "accel"], "terms": [{"signal": ["frame", "B", "accel"],
       "factors": [{"rotation": [], "to": "bar", "from": "frame"}]}]},
      {"of": ["frame", "B", "force"], "add": true, "terms": [{"signal": ["bar", "T", "force"],
       "read": "reaction", "sign": -1,
       "factors": [{"rotation": [], "to": "frame", "from": "bar"}]}]}],
    "outputs": [{"name": "moved", "size": 6,
                 "terms": [{"signal": ["frame", "parent", "accel"]}]}]})"));
  return {"bar.child(\"T\")", "frame"};
}

Names bad_inertia(Json& scene) {
  Json& b = scene["blocks"][0];
  if (!b.contains("mass")) throw std::domain_error("the first body has modes; take another --seed");
  b["mass"] = -1;
  return {b["name"]};
}

Names bad_modes(Json& scene) {
  if (scene["bodies"].empty())
    throw std::domain_error("nothing has modes; take --family spatial and more --bodies");
  const std::string name = scene["bodies"].items().begin().key();
  Json& L = scene["bodies"][name]["L_P"];
  L[0][0] = 1000;  // the mode's participation exceeds the body's mass
  return {name};
}

Names bad_value(Json& scene) {
  Json& b = spring_mass(scene);
  b["stiffness"] = -4;
  return {b["name"]};
}

Names not_a_rotation(Json& scene) {
  Json& e = mounting(scene);
  if (!e["terms"][0].contains("factors") || !e["terms"][0]["factors"][0].contains("rotation"))
    throw std::domain_error(kNotTurned);
  e["terms"][0]["factors"][0]["rotation"] = parse("[[[1, 0.001, 0], [0, 1, 0], [0, 0, 1]]]");
  return {"0.001"};
}

Names not_finite(Json& scene) {
  Json& o = scene["outputs"][0];
  o["terms"][0]["factors"].push_back(1e200);
  o["terms"][0]["factors"].push_back(1e200);
  return {"1e+200", o["terms"][0]["signal"][0]};
}

Names duplicate_name(Json& scene) {
  scene["outputs"].push_back(scene["outputs"][0]);
  return {"outputs", scene["outputs"][0]["name"]};
}

Names bad_file(Json& scene) {
  Json& b = scene["blocks"][scene["blocks"].size() - 1];
  b["colour"] = "red";
  return {"colour", "blocks[" + std::to_string(scene["blocks"].size() - 1) + "]"};
}

}  // namespace

bool needs_space(const std::string& code) {
  return code == "frame" || code == "not-a-rotation" || code == "bad-modes";
}

Spoilt spoil(Json scene, const std::string& code) {
  static const std::map<std::string, std::function<Names(Json&)>> kMistakes = {
      {"no-equation", no_equation},
      {"two-equations", two_equations},
      {"size", size},
      {"quantity", quantity},
      {"frame", frame},
      {"structure", structure},
      {"ill-posed", ill_posed},
      {"improper", improper},
      {"kinematic-loop", kinematic_loop},
      {"bad-inertia", bad_inertia},
      {"bad-modes", bad_modes},
      {"bad-value", bad_value},
      {"not-a-rotation", not_a_rotation},
      {"not-finite", not_finite},
      {"duplicate-name", duplicate_name},
      {"bad-file", bad_file}};
  const auto found = kMistakes.find(code);
  if (found == kMistakes.end()) {
    std::string known;
    for (const auto& [name, plant] : kMistakes) known += (known.empty() ? "" : ", ") + name;
    throw std::invalid_argument("no mistake '" + code + "' can be planted; there are " + known);
  }
  const Names names = found->second(scene);
  return {std::move(scene), {{"refused", {{"code", code}, {"names", names}}}}};
}

}  // namespace titop::generate
