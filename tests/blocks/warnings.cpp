#include <doctest/doctest.h>

#include <titop/blocks/fe/interfaces.hpp>
#include <titop/blocks/fe/plate.hpp>
#include <titop/blocks/flexible_body.hpp>
#include <titop/compiler/system/system.hpp>

#include "support/notes.hpp"

/// Warnings of a block's data in the log of compile.

using namespace titop;
using titop_test::count_notes;

namespace {

System held(const fe::Mesh& mesh, const std::string& parent) {
  Diagram d{"wall"};
  auto panel = d.add("panel", FlexibleBody{fe::modal_data(mesh, parent, {})});
  ground(panel);
  d.output("F", 6) = panel.parent.reaction;
  return compile(d);
}

}  // namespace

TEST_CASE("the log of compile warns of a clamp at one node of a plate, and not of an edge") {
  const fe::Mesh mesh = plate_mesh({.a = 0.8,
                                    .b = 0.6,
                                    .thickness = 0.004,
                                    .material = {.E = 70e9, .nu = 0.3, .rho = 2700},
                                    .elements = {2, 2}});
  CHECK(count_notes(held(mesh, "0,1"), Note::Kind::warning, "check",
                    {"panel", "0,1", "fe::rigid"}) == 1);
  const fe::Mesh edge = fe::with_interface(mesh, "root", fe::rigid(fe::edge(mesh, "x0")));
  CHECK(count_notes(held(edge, "root"), Note::Kind::warning, "check", {}) == 0);
}
