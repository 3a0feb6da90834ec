#include <fmt/format.h>

#include <titop/blocks/diagram_file/block_types.hpp>

namespace titop::diagram_file {
namespace {

/// Calls visit(type) for all types, while it returns true.
template <class Visit>
void for_types(Visit visit) {
  for (const auto& group : {body_types(), joint_types(), signal_types()})
    for (const BlockType& type : group)
      if (!visit(type)) return;
}

const BlockType* find_type(std::string_view name) {
  const BlockType* found = nullptr;
  for_types([&](const BlockType& type) {
    if (name == type.name) found = &type;
    return !found;
  });
  return found;
}

std::string all_types() {
  std::string all;
  for_types([&](const BlockType& type) {
    all += (all.empty() ? "" : ", ") + std::string(type.name);
    return true;
  });
  return all;
}

}  // namespace

void write_block(const Block& block, const WriteValue& value, const NameBody& body, Json& json) {
  const BlockType* type = find_type(block.type());
  if (!type)
    throw Error(Code::bad_value,
                fmt::format("a {} cannot be written to a diagram file", block.type()),
                "it knows " + all_types() + "; write an own block as an Lti or as modal data");
  json["type"] = type->name;
  type->write(block, value, body, json);
}

BlockPtr read_block(const JsonPlace& place, const ReadValue& value, const FindBody& body) {
  const BlockType* type = find_type(place.at("type").text());
  if (!type) place.at("type").refuse("one of " + all_types());
  if (place.has("momentum"))  // of a Rotor in C++, which writes the equations
    place.at("momentum")
        .refuse(
            "none: a momentum h about a is the two equations that momentum(port, h, a) writes, for "
            "any body: torque h a x rate at the port, with \"add\": true");
  const std::string_view name = type->name;
  if ((name == "RigidBody" || name == "FlexibleBody") && place.has("spin"))
    place.at("spin").refuse(
        "none: while it spins, a body that is flexible or has unequal transverse inertias is "
        "periodic in time; add a rigid axisymmetric body as a Rotor");
  return type->read(place, value, body);
}

}  // namespace titop::diagram_file
