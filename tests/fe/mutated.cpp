// Files with random damage: every reader returns data or throws Error. The same damage on every
// machine; the sanitizers detect invalid accesses.
#include <doctest/doctest.h>

#include <fstream>
#include <functional>
#include <titop/titop.hpp>

#include "support/folder.hpp"
#include "support/rng.hpp"

using namespace titop;
using titop_test::Folder;
using titop_test::Rng;

namespace {

std::string content(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), {}};
}

std::string damaged(std::string text, Rng& rng) {
  const int times = 1 + rng.below(4);
  for (int i = 0; i < times && !text.empty(); ++i) {
    const auto at = static_cast<std::size_t>(rng.below(static_cast<int>(text.size())));
    switch (rng.below(5)) {
      case 0: text[at] = static_cast<char>(rng.below(256)); break;
      case 1: text[at] = "0123456789+-.,DE \n{}[]\"*"[rng.below(24)]; break;
      case 2: text.erase(at, static_cast<std::size_t>(1 + rng.below(20))); break;
      case 3: text.insert(at, text.substr(at, static_cast<std::size_t>(1 + rng.below(20)))); break;
      default: text.resize(at);
    }
  }
  return text;
}

/// Number of damaged files that were refused.
int refusals(const std::string& good, int count, std::uint64_t seed,
             const std::function<void(const std::filesystem::path&)>& read) {
  const Folder folder;
  Rng rng(seed);
  int refused = 0;
  for (int i = 0; i < count; ++i) {
    folder.write("file", damaged(good, rng));
    try {
      read(folder.path / "file");
    } catch (const Error& error) {
      ++refused;
      CHECK(!error.mistakes().empty());
    }
  }
  return refused;
}

}  // namespace

TEST_CASE("damaged OP4") {
  const auto read = [](const std::filesystem::path& path) { fe::read_op4(path); };
  const std::string text = TITOP_TEST_DATA "/op4/";
  for (const char* name : {"dense_double.op4", "sparse_double.op4", "bigmat_single.op4"}) {
    INFO(name);
    CHECK(refusals(content(text + name), 300, 1, read) > 100);
  }
  const std::string real = content(TITOP_DATA_DIR "/nastran_op4_superelement/outboard.op4");
  CHECK(refusals(real, 150, 2, read) > 50);
}

TEST_CASE("damaged DMIG") {
  const std::string wing =
      content(TITOP_DATA_DIR "/nastran_dmig_flying_wing/sol103_maewing1_femv5p1.pch");
  const auto at = wing.find("DMIG    MAAX");
  const auto lines = [&](std::size_t from) {
    return wing.substr(from, wing.find('\n', from + 3000) + 1 - from);
  };
  const std::string part = lines(0) + lines(at);
  const auto read = [](const std::filesystem::path& path) { fe::read_dmig(path, "KAAX", "MAAX"); };
  CHECK(refusals(part, 400, 3, read) > 100);
}

TEST_CASE("damaged modal data") {
  const std::string good = content(TITOP_DATA_DIR "/nastran_cantilever/cantilever.csv");
  CHECK(refusals(good, 400, 4, [](const std::filesystem::path& path) {
          const FlexibleBody body = fe::read_modal_csv(path);
        }) > 100);
}

TEST_CASE("damaged scenes") {
  Diagram d{"scene"};
  const Param k = d.param("k", 2);
  auto u = d.input("u", 6);
  auto b = d.add("b", RigidBody{.mass = k, .children = {{"C", {1, 0, 0}}}});
  auto w = d.add("w", RigidBody{});
  auto h = hinge(d, "h", w, b.child, Rotation::about({0, 0, 1}, k), {0, 1, 0});
  h.torque = k * h.angle;
  b.parent.force = -u;
  d.output("a", 3) = b.parent.accel.linear;
  CHECK(refusals(diagram_json(d), 600, 5,
                 [](const std::filesystem::path& path) { compile(read_diagram(path)); }) > 100);
}
