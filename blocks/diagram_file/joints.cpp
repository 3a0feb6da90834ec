#include <fmt/format.h>

#include <array>
#include <titop/blocks/bushing.hpp>
#include <titop/blocks/diagram_file/block_types.hpp>
#include <titop/blocks/hinge.hpp>
#include <titop/blocks/joint.hpp>
#include <titop/blocks/slide.hpp>
#include <titop/graph/linalg/index.hpp>

namespace titop::diagram_file {
namespace {

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

constexpr BlockType kJoint[] = {{"Hinge", write_joint, read_hinge},
                                {"Slide", write_joint, read_slide},
                                {"Joint", write_joint, read_joint},
                                {"Bushing", write_bushing, read_bushing}};

}  // namespace

std::span<const BlockType> joint_types() { return kJoint; }

}  // namespace titop::diagram_file
