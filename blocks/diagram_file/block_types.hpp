#pragma once

#include <span>
#include <titop/blocks/diagram_file/blocks.hpp>
#include <titop/blocks/specified.hpp>

/// The types of blocks that a diagram file has, by group. For this folder's own files.
namespace titop::diagram_file {

/// Writer and reader of one type.
struct BlockType {
  const char* name;
  void (*write)(const Block&, const WriteValue&, const NameBody&, Json&);
  BlockPtr (*read)(const JsonPlace&, const ReadValue&, const FindBody&);
};

/// Spring-masses, rigid and flexible bodies, rotors, distributed beams.
std::span<const BlockType> body_types();
/// Hinges, slides, joints of any axes, bushings.
std::span<const BlockType> joint_types();
/// Gains, sums, loop points, Lti.
std::span<const BlockType> signal_types();

/// The spec of a block, of the type that it was made from.
template <class Spec>
const Spec& spec_of(const Block& block) {
  return dynamic_cast<const Specified<Spec>&>(block).spec();
}

}  // namespace titop::diagram_file
