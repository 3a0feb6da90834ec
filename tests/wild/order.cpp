#include <doctest/doctest.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <random>
#include <titop/titop.hpp>

#include "support/folder.hpp"
#include "support/random_checks.hpp"
#include "wild/oracle/draw.hpp"
#include "wild/parts/write.hpp"

namespace {

using Json = nlohmann::json;

/// The same blocks, inputs, equations, outputs and terms in another order.
std::string shuffled(const std::string& diagram, unsigned seed) {
  Json j = Json::parse(diagram);
  std::mt19937 random(seed);
  const auto shuffle = [&](Json& list) { std::shuffle(list.begin(), list.end(), random); };
  for (const char* key : {"equations", "outputs"})
    for (Json& item : j[key]) shuffle(item["terms"]);
  for (const char* key : {"blocks", "inputs", "equations", "outputs"}) shuffle(j[key]);
  return j.dump();
}

/// "" if both orders give the same models, or the same refusal.
std::string difference(const titop_test::Folder& folder, const std::string& diagram,
                       const std::string& other, const titop::Options& options) {
  titop::StateSpace models[2];
  std::string codes[2];
  for (int i = 0; i < 2; ++i) {
    folder.write("d.json", i == 0 ? diagram : other);
    try {
      models[i] =
          titop::compile(titop::read_diagram(folder.path / "d.json"), options).state_space();
    } catch (const titop::Error& e) {
      codes[i] = to_string(e.mistakes().front().code);
    }
  }
  if (codes[0] != codes[1]) return "refused in one order: " + codes[0] + codes[1];
  return titop_test::difference_by_name(models[0], models[1]);
}

}  // namespace

TEST_CASE("wild scenes in another order of declaration give the same bits, minimized too") {
  const titop_test::Folder folder;
  for (const auto draw : {wild::draw_row, wild::draw_tree, wild::draw_loop, wild::draw_half_ties,
                          wild::draw_controller})
    for (unsigned seed = 0; seed < 40; ++seed) {
      CAPTURE(seed);
      wild::Rng rng(seed * 1000003u + 7u);
      titop::write_diagram(wild::diagram_of(draw(rng)), folder.path / "d.json");
      const std::string diagram = folder.read("d.json"), other = shuffled(diagram, seed);
      CHECK(difference(folder, diagram, other, {.minimize_up_to = 0}) == "");
      CHECK(difference(folder, diagram, other, {}) == "");
    }
}
