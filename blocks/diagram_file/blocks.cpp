#include <fmt/format.h>

#include <array>
#include <titop/blocks/bushing.hpp>
#include <titop/blocks/diagram_file/blocks.hpp>
#include <titop/blocks/diagram_file/mode_values.hpp>
#include <titop/blocks/flexible_body.hpp>
#include <titop/blocks/hinge.hpp>
#include <titop/blocks/joint.hpp>
#include <titop/blocks/rigid_body.hpp>
#include <titop/blocks/rotor.hpp>
#include <titop/blocks/slide.hpp>
#include <titop/blocks/specified.hpp>
#include <titop/blocks/spring_mass.hpp>
#include <titop/graph/linalg/index.hpp>
#include <titop/graph/nodes/gain.hpp>
#include <titop/graph/nodes/lti.hpp>

namespace titop::diagram_file {

using Eigen::Index;
using Eigen::MatrixXd;

namespace {

template <class Spec>
const Spec& spec_of(const Block& block) {
  return dynamic_cast<const Specified<Spec>&>(block).spec();
}

/// Writer and reader of one type.
struct Type {
  const char* name;
  void (*write)(const Block&, const WriteValue&, const NameBody&, Json&);
  BlockPtr (*read)(const JsonPlace&, const ReadValue&, const FindBody&);
};

// --- bodies --------------------------------------------------------------------------------------

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

// --- joints --------------------------------------------------------------------------------------

void write_joint(const Block& b, const WriteValue&, const NameBody&, Json& j) {
  j["axes"] = Json::array();
  for (const Axis& axis : spec_of<std::vector<Axis>>(b))
    j["axes"].push_back({{"kind", axis.kind == Axis::Kind::revolute ? "about" : "along"},
                         {"direction", list(axis.direction)},
                         {"name", axis.name}});
}

std::vector<Axis> read_axes(const JsonPlace& p) {
  p.only({"name", "type", "axes"});
  std::vector<Axis> axes;
  const JsonPlace list = p.at("axes");
  for (std::size_t i = 0; i < list.size(); ++i) {
    const JsonPlace axis = list.item(i);
    axis.only({"kind", "direction", "name"});
    const std::string kind = axis.at("kind").text();
    if (kind != "about" && kind != "along") axis.at("kind").refuse("about or along");
    axes.push_back({kind == "about" ? Axis::Kind::revolute : Axis::Kind::prismatic,
                    axis.at("direction").vector(3), axis.at("name").text()});
  }
  return axes;
}

/// The one axis of a hinge or slide, which has no name.
Vector3d read_axis(const JsonPlace& p, Axis::Kind kind) {
  const std::vector<Axis> axes = read_axes(p);
  if (axes.size() != 1) p.at("axes").refuse("one axis");
  const JsonPlace axis = p.at("axes").item(0);
  if (axes[0].kind != kind)
    axis.at("kind").refuse(kind == Axis::Kind::revolute ? "about, of a Hinge"
                                                        : "along, of a Slide");
  if (!axes[0].name.empty()) axis.at("name").refuse("an empty name: only axes of a Joint have one");
  return axes[0].direction;
}

BlockPtr read_hinge(const JsonPlace& p, const ReadValue&, const FindBody&) {
  return as_block(Hinge{read_axis(p, Axis::Kind::revolute)});
}
BlockPtr read_slide(const JsonPlace& p, const ReadValue&, const FindBody&) {
  return as_block(Slide{read_axis(p, Axis::Kind::prismatic)});
}
BlockPtr read_joint(const JsonPlace& p, const ReadValue&, const FindBody&) {
  return as_block(Joint{read_axes(p)});
}

/// A diagonal, or six rows, of numbers and parameters.
Json six_axes(const SixAxes& m, const WriteValue& value) {
  Json all = rows(m.nominal());
  for (const SixAxes::Entry& e : m.entries())
    all[linalg::at(e.row)][linalg::at(e.column)] = all[linalg::at(e.column)][linalg::at(e.row)] =
        value(e.value);
  if (!m.is_diagonal()) return all;
  Json result = Json::array();
  for (std::size_t i = 0; i < 6; ++i) result.push_back(all[i][i]);
  return result;
}

bool same(const Value& a, const Value& b) {
  return a.index() == b.index() && a.scale() == b.scale() && a.nominal() == b.nominal();
}

/// Symmetric: parameters are the same on both sides of the diagonal.
SixAxes read_rows(const JsonPlace& p, const ReadValue& value) {
  Matrix6 numbers;
  std::vector<SixAxes::Entry> entries;
  std::array<std::array<Value, 6>, 6> all;
  for (std::size_t i = 0; i < 6; ++i) {
    const JsonPlace row = p.item(i);
    if (row.size() != 6) row.refuse("six numbers or parameters");
    for (std::size_t j = 0; j < 6; ++j) {
      const Value v = all[i][j] = value(row.item(j));
      const int r = static_cast<int>(i), c = static_cast<int>(j);
      numbers(r, c) = v.nominal();
      if (v.is_parameter() && i <= j) entries.push_back({r, c, v});
      if (i > j && (v.is_parameter() || all[j][i].is_parameter()) && !same(v, all[j][i]))
        row.item(j).refuse(
            fmt::format("as in row {}, column {}: the matrix is symmetric", j + 1, i + 1));
    }
  }
  SixAxes m(numbers);
  for (const SixAxes::Entry& e : entries) m = m.with(e.row + 1, e.column + 1, e.value);
  return m;
}

SixAxes read_six_axes(const JsonPlace& p, const ReadValue& value) {
  if (p.size() != 6) p.refuse("six numbers or six rows");
  if (!p.item(0).is_number() && !p.item(0).has("parameter")) return read_rows(p, value);
  return {value(p.item(0)), value(p.item(1)), value(p.item(2)),
          value(p.item(3)), value(p.item(4)), value(p.item(5))};
}

void write_bushing(const Block& b, const WriteValue& value, const NameBody&, Json& j) {
  j["stiffness"] = six_axes(spec_of<Bushing>(b).stiffness, value);
  j["damping"] = six_axes(spec_of<Bushing>(b).damping, value);
}

BlockPtr read_bushing(const JsonPlace& p, const ReadValue& value, const FindBody&) {
  p.only({"name", "type", "stiffness", "damping"});
  return as_block(Bushing{.stiffness = read_six_axes(p.at("stiffness"), value),
                          .damping = read_six_axes(p.at("damping"), value)});
}

// --- signals -------------------------------------------------------------------------------------

void write_gain(const Block& b, const WriteValue& value, const NameBody&, Json& j) {
  j["gain"] = value(b.values().at(0));
  j["size"] = b.interface().input_size();
}

BlockPtr read_gain(const JsonPlace& p, const ReadValue& value, const FindBody&) {
  p.only({"name", "type", "gain", "size"});
  return as_block(Gain{.gain = value(p.at("gain")), .size = p.at("size").signal_size()});
}

void write_loop_point(const Block& b, const WriteValue&, const NameBody&, Json& j) {
  j["size"] = b.interface().input_size();
}

BlockPtr read_loop_point(const JsonPlace& p, const ReadValue&, const FindBody&) {
  p.only({"name", "type", "size"});
  return as_block(LoopPoint{p.at("size").signal_size()});
}

void write_matrix_gain(const Block& b, const WriteValue&, const NameBody&, Json& j) {
  j["matrix"] = rows(b.dynamics({})->D);
}

BlockPtr read_matrix_gain(const JsonPlace& p, const ReadValue&, const FindBody&) {
  p.only({"name", "type", "matrix"});
  return as_block(MatrixGain{p.at("matrix").matrix(-1, -1)});
}

void write_sum(const Block& b, const WriteValue&, const NameBody&, Json& j) {
  const Index size = b.interface().output_size();
  const auto dynamics = b.dynamics({});
  std::string signs;
  for (Index i = 0; i < dynamics->D.cols(); i += size) signs += dynamics->D(0, i) > 0 ? '+' : '-';
  j["signs"] = signs;
  j["size"] = size;
}

BlockPtr read_sum(const JsonPlace& p, const ReadValue&, const FindBody&) {
  p.only({"name", "type", "signs", "size"});
  return as_block(Sum{.signs = p.at("signs").text(), .size = p.at("size").signal_size()});
}

void write_lti(const Block& b, const WriteValue& value, const NameBody&, Json& j) {
  const std::vector<Lti::Entry> values = lti_values(b);
  std::vector<double> nominal;
  for (const Lti::Entry& e : values) {
    nominal.resize(std::max(nominal.size(), linalg::at(e.value.index()) + 1));
    nominal[linalg::at(e.value.index())] = e.value.parameter();
  }
  const auto d = b.dynamics(nominal);
  j["A"] = rows(d->A);
  j["B"] = rows(d->B);
  j["C"] = rows(d->C);
  j["D"] = rows(d->D);
  for (const Lti::Entry& e : values)
    j["values"].push_back({{"matrix", std::string(1, e.matrix)},
                           {"row", e.row},
                           {"column", e.column},
                           {"value", value(e.value)}});
}

std::vector<Lti::Entry> read_entries(const JsonPlace& p, const ReadValue& value) {
  std::vector<Lti::Entry> entries;
  for (std::size_t i = 0; p.has("values") && i < p.at("values").size(); ++i) {
    const JsonPlace e = p.at("values").item(i);
    e.only({"matrix", "row", "column", "value"});
    const std::string matrix = e.at("matrix").text();
    if (matrix.size() != 1) e.at("matrix").refuse("A, B, C or D");
    entries.push_back(
        {matrix[0], e.at("row").integer(), e.at("column").integer(), value(e.at("value"))});
  }
  return entries;
}

BlockPtr read_lti(const JsonPlace& p, const ReadValue& value, const FindBody&) {
  p.only({"name", "type", "A", "B", "C", "D", "values"});
  const MatrixXd D = p.at("D").matrix(-1, -1);
  const auto n = static_cast<Index>(p.at("A").size());
  return as_block(Lti{.A = p.at("A").matrix(n, n),
                      .B = p.at("B").matrix(n, D.cols()),
                      .C = p.at("C").matrix(D.rows(), n),
                      .D = D,
                      .values = read_entries(p, value)});
}

void write_integrator(const Block& b, const WriteValue&, const NameBody&, Json& j) {
  j["size"] = b.interface().output_size();
}

BlockPtr read_integrator(const JsonPlace& p, const ReadValue&, const FindBody&) {
  p.only({"name", "type", "size"});
  return as_block(Integrator{p.at("size").signal_size()});
}

constexpr Type kTypes[] = {{"SpringMass", write_spring_mass, read_spring_mass},
                           {"RigidBody", write_rigid_body, read_rigid_body},
                           {"Rotor", write_rotor, read_rotor},
                           {"FlexibleBody", write_flexible_body, read_flexible_body},
                           {"Hinge", write_joint, read_hinge},
                           {"Slide", write_joint, read_slide},
                           {"Joint", write_joint, read_joint},
                           {"Bushing", write_bushing, read_bushing},
                           {"Gain", write_gain, read_gain},
                           {"MatrixGain", write_matrix_gain, read_matrix_gain},
                           {"Sum", write_sum, read_sum},
                           {"LoopPoint", write_loop_point, read_loop_point},
                           {"Lti", write_lti, read_lti},
                           {"Integrator", write_integrator, read_integrator}};

const Type* find_type(std::string_view name) {
  for (const Type& type : kTypes)
    if (name == type.name) return &type;
  return nullptr;
}

std::string all_types() {
  std::string all;
  for (const Type& type : kTypes) all += (all.empty() ? "" : ", ") + std::string(type.name);
  return all;
}

}  // namespace

void write_block(const Block& block, const WriteValue& value, const NameBody& body, Json& json) {
  const Type* type = find_type(block.type());
  if (!type)
    throw Error(Code::bad_value,
                fmt::format("a {} cannot be written to a diagram file", block.type()),
                "it knows " + all_types() + "; write an own block as an Lti or as modal data");
  json["type"] = type->name;
  type->write(block, value, body, json);
}

BlockPtr read_block(const JsonPlace& place, const ReadValue& value, const FindBody& body) {
  const Type* type = find_type(place.at("type").text());
  if (!type) place.at("type").refuse("one of " + all_types());
  if (place.has("momentum"))  // of a Rotor in C++, which writes the equations
    place.at("momentum")
        .refuse(
            "none: a momentum h about a is the two equations that momentum(port, h, a) writes, for "
            "any "
            "body: torque h a x rate at the port, with \"add\": true");
  return type->read(place, value, body);
}

Json body_json(const ModalData& data) {
  Json json = {{"omega", list(data.omega)}, {"xi", list(data.xi)},   {"L_P", rows(data.L_P)},
               {"D_P", rows(data.D_P)},     {"digits", data.digits}, {"children", Json::array()}};
  for (const ModalChild& c : data.children)
    json["children"].push_back({{"name", c.name}, {"PC", list(c.PC)}, {"Phi_C", rows(c.Phi_C)}});
  for (const ModalLine& line : data.lines) {
    Json shapes = Json::array();
    for (const LineShape& s : line.shapes)
      shapes.push_back({{"component", s.component + 1}, {"degree", s.degree}});
    json["lines"].push_back({{"name", line.name},
                             {"axis", line.axis + 1},
                             {"length", line.length},
                             {"shapes", shapes},
                             {"Phi", rows(line.Phi)}});
  }
  return json;
}

ModalLine read_line(const JsonPlace& p, Index modes) {
  p.only({"name", "axis", "length", "shapes", "Phi"});
  ModalLine line{p.at("name").text(), p.at("axis").integer() - 1, p.at("length").number(), {}, {}};
  const JsonPlace shapes = p.at("shapes");
  for (std::size_t i = 0; i < shapes.size(); ++i) {
    const JsonPlace s = shapes.item(i);
    s.only({"component", "degree"});
    line.shapes.push_back({s.at("component").integer() - 1, s.at("degree").integer()});
  }
  line.Phi = p.at("Phi").matrix(static_cast<Index>(line.shapes.size()), modes);
  return line;
}

FlexibleBody read_body(const JsonPlace& p) {
  p.only({"omega", "xi", "L_P", "D_P", "digits", "children", "lines"});
  ModalData data;
  data.omega = p.at("omega").vector();
  const Index n = data.omega.size();
  data.xi = p.at("xi").vector(n);
  data.L_P = p.at("L_P").matrix(n, 6);
  data.D_P = p.at("D_P").matrix(6, 6);
  data.digits = p.at("digits").number();
  const JsonPlace children = p.at("children");
  for (std::size_t i = 0; i < children.size(); ++i) {
    const JsonPlace c = children.item(i);
    c.only({"name", "PC", "Phi_C"});
    data.children.push_back(
        {c.at("name").text(), c.at("PC").vector(3), c.at("Phi_C").matrix(6, n)});
  }
  if (p.has("lines"))
    for (std::size_t i = 0; i < p.at("lines").size(); ++i)
      data.lines.push_back(read_line(p.at("lines").item(i), n));
  return {data, SourceLine{}};
}

}  // namespace titop::diagram_file
