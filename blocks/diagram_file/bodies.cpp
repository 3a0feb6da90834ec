#include <titop/blocks/diagram_file/block_types.hpp>
#include <titop/blocks/diagram_file/mode_values.hpp>
#include <titop/blocks/exact_beam.hpp>
#include <titop/blocks/flexible_body.hpp>
#include <titop/blocks/rigid_body.hpp>
#include <titop/blocks/rotor.hpp>
#include <titop/blocks/spring_mass.hpp>

namespace titop::diagram_file {
namespace {

void write_spring_mass(const Block& b, const WriteValue& value, const NameBody&, Json& j) {
  const auto& spec = spec_of<SpringMass>(b);
  j["mass"] = value(spec.mass);
  j["stiffness"] = value(spec.stiffness);
  j["damping"] = value(spec.damping);
  j["parent_mass"] = value(spec.parent_mass);
}

BlockPtr read_spring_mass(const JsonPlace& p, const ReadValue& value, const FindBody&) {
  p.only({"name", "type", "mass", "stiffness", "damping", "parent_mass"});
  return as_block(SpringMass{.mass = value(p.at("mass")),
                             .stiffness = value(p.at("stiffness")),
                             .damping = value(p.at("damping")),
                             .parent_mass = value(p.at("parent_mass"))});
}

/// Three rows of numbers; with parameters xx, yy, zz, xy, xz, yz.
Json inertia_json(const Inertia& inertia, const WriteValue& value) {
  const std::vector<Value> entries = inertia.values();
  if (entries.empty()) return rows(inertia.nominal());
  Json result = Json::array();
  for (const Value& v : entries) result.push_back(value(v));
  return result;
}

Inertia read_inertia(const JsonPlace& p, const ReadValue& value) {
  if (p.size() == 3) return p.matrix(3, 3);
  if (p.size() != 6) p.refuse("three rows, or the six entries xx, yy, zz, xy, xz, yz");
  return {value(p.item(0)), value(p.item(1)), value(p.item(2)),
          value(p.item(3)), value(p.item(4)), value(p.item(5))};
}

/// Three numbers or parameters.
Json position_json(const Position& position, const WriteValue& value) {
  const std::vector<Value> components = position.values();
  if (components.empty()) return list(position.nominal());
  Json result = Json::array();
  for (const Value& v : components) result.push_back(value(v));
  return result;
}

Position read_position(const JsonPlace& p, const ReadValue& value) {
  if (p.size() != 3) p.refuse("three numbers or parameters");
  return {value(p.item(0)), value(p.item(1)), value(p.item(2))};
}

void write_rigid_body(const Block& b, const WriteValue& value, const NameBody&, Json& j) {
  const auto& spec = spec_of<RigidBody>(b);
  j["mass"] = value(spec.mass);
  j["inertia"] = inertia_json(spec.inertia, value);
  j["PA"] = position_json(spec.PA, value);
  j["children"] = Json::array();
  for (const ChildPoint& c : spec.children)
    j["children"].push_back({{"name", c.name}, {"PC", position_json(c.PC, value)}});
}

BlockPtr read_rigid_body(const JsonPlace& p, const ReadValue& value, const FindBody&) {
  p.only({"name", "type", "mass", "inertia", "PA", "children"});
  RigidBody spec{.mass = value(p.at("mass")),
                 .inertia = read_inertia(p.at("inertia"), value),
                 .PA = read_position(p.at("PA"), value)};
  const JsonPlace children = p.at("children");
  for (std::size_t i = 0; i < children.size(); ++i) {
    const JsonPlace c = children.item(i);
    c.only({"name", "PC"});
    spec.children.push_back({c.at("name").text(), read_position(c.at("PC"), value)});
  }
  return as_block(spec);
}

void write_rotor(const Block& b, const WriteValue& value, const NameBody&, Json& j) {
  const auto& spec = spec_of<Rotor>(b);
  j["mass"] = value(spec.mass);
  j["axial"] = value(spec.axial);
  j["transverse"] = value(spec.transverse);
  j["axis"] = list(spec.axis);
  j["PA"] = list(spec.PA);
}

/// The momentum is in the diagram's equations.
BlockPtr read_rotor(const JsonPlace& p, const ReadValue& value, const FindBody&) {
  p.only({"name", "type", "mass", "axial", "transverse", "axis", "PA"});
  return as_block(Rotor{.mass = value(p.at("mass")),
                        .axial = value(p.at("axial")),
                        .transverse = value(p.at("transverse")),
                        .axis = p.at("axis").vector(3),
                        .PA = p.at("PA").vector(3)});
}

void write_flexible_body(const Block& b, const WriteValue& value, const NameBody& body, Json& j) {
  const auto& spec = spec_of<FlexibleBody::Spec>(b);
  j["body"] = body(*spec.data);
  write_mode_values(spec.values, value, j);
  if (spec.damping.size() > 0) j["damping"] = rows(spec.damping);
  if (spec.loss_factor > 0) j["loss_factor"] = spec.loss_factor;
}

BlockPtr read_flexible_body(const JsonPlace& p, const ReadValue& value, const FindBody& body) {
  p.only({"name", "type", "body", "omega", "xi", "L_P", "Phi_C", "damping", "loss_factor"});
  const FlexibleBody shared = body(p.at("body"));
  const ModeValues values = read_mode_values(p, value);
  FlexibleBody own = values.empty() ? shared : FlexibleBody(shared, values);
  if (p.has("damping")) own = own.damped_by(p.at("damping").matrix(-1, -1));
  if (p.has("loss_factor")) own = own.with_loss_factor(p.at("loss_factor").number());
  return as_block(own);
}

void write_optional(const char* key, const std::optional<double>& number, Json& j) {
  if (number) j[key] = *number;
}

std::optional<double> read_optional(const JsonPlace& p, const char* key) {
  if (!p.has(key)) return std::nullopt;
  return p.at(key).number();
}

void write_exact_beam(const Block& b, const WriteValue&, const NameBody&, Json& j) {
  const auto& spec = spec_of<ExactBeam>(b);
  j["length"] = spec.length;
  j["section"] = {{"area", spec.section.area},
                  {"I_y", spec.section.I_y},
                  {"I_z", spec.section.I_z},
                  {"J", spec.section.J}};
  write_optional("I_x", spec.section.I_x, j["section"]);
  j["material"] = {{"E", spec.material.E}, {"rho", spec.material.rho}};
  write_optional("nu", spec.material.nu, j["material"]);
  write_optional("G", spec.material.G, j["material"]);
  j["damping"] = {{"mass", spec.damping.mass}, {"stiffness", spec.damping.stiffness}};
}

BlockPtr read_exact_beam(const JsonPlace& p, const ReadValue&, const FindBody&) {
  p.only({"name", "type", "length", "section", "material", "damping"});
  const JsonPlace section = p.at("section"), material = p.at("material"), damping = p.at("damping");
  section.only({"area", "I_y", "I_z", "J", "I_x"});
  material.only({"E", "nu", "G", "rho"});
  damping.only({"mass", "stiffness"});
  return as_block(ExactBeam{.length = p.at("length").number(),
                            .section = {.area = section.at("area").number(),
                                        .I_y = section.at("I_y").number(),
                                        .I_z = section.at("I_z").number(),
                                        .J = section.at("J").number(),
                                        .I_x = read_optional(section, "I_x")},
                            .material = {.E = material.at("E").number(),
                                         .nu = read_optional(material, "nu"),
                                         .G = read_optional(material, "G"),
                                         .rho = material.at("rho").number()},
                            .damping = {.mass = damping.at("mass").number(),
                                        .stiffness = damping.at("stiffness").number()}});
}

constexpr BlockType kBody[] = {{"SpringMass", write_spring_mass, read_spring_mass},
                               {"RigidBody", write_rigid_body, read_rigid_body},
                               {"Rotor", write_rotor, read_rotor},
                               {"FlexibleBody", write_flexible_body, read_flexible_body},
                               {"ExactBeam", write_exact_beam, read_exact_beam}};

}  // namespace

std::span<const BlockType> body_types() { return kBody; }

}  // namespace titop::diagram_file
