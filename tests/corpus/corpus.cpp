// All scenes of the corpus through the reader of diagram files and the compiler, against their
// answers, which were assembled without either (README.md).
#include <doctest/doctest.h>
#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <titop/titop.hpp>

#include "support/refused.hpp"
#include "support/transfer_error.hpp"

using namespace titop;
using Complex = std::complex<double>;
using Eigen::Index;
using Eigen::MatrixXcd;
using Json = nlohmann::json;

namespace {

const std::filesystem::path kFolder = TITOP_SOURCE_DIR "/tests/corpus";

Json read_json(const std::filesystem::path& path) {
  std::ifstream file(path);
  return Json::parse(file);
}

Complex complex(const Json& pair) { return {pair[0].get<double>(), pair[1].get<double>()}; }

MatrixXcd matrix(const Json& rows, Index columns) {
  MatrixXcd G(static_cast<Index>(rows.size()), columns);
  for (Index i = 0; i < G.rows(); ++i)
    for (Index j = 0; j < columns; ++j)
      G(i, j) = complex(rows[static_cast<std::size_t>(i)][static_cast<std::size_t>(j)]);
  return G;
}

/// Threes of a signal's translations and rotations are judged together.
std::vector<Index> blocks(const Json& signals) {
  std::vector<Index> list;
  for (const Json& s : signals) {
    const int size = s.at("size").get<int>(), each = size % 3 == 0 ? 3 : 1;
    for (int i = 0; i < size; i += each) list.push_back(each);
  }
  return list;
}

/// Largest distance of a pole to its partner: of the poles other than 0, relative to its modulus.
double pole_error(std::vector<Pole> found, const Json& exact) {
  double worst = found.size() == exact.size() ? 0 : HUGE_VAL;
  for (const Json& pair : exact) {
    if (found.empty()) break;
    const Complex p = complex(pair);
    const auto next = std::min_element(
        found.begin(), found.end(),
        [&](const Pole& a, const Pole& b) { return std::abs(a.s - p) < std::abs(b.s - p); });
    worst = std::max(worst, std::abs(next->s - p) / (p == 0.0 ? 1.0 : std::abs(p)));
    found.erase(next);
  }
  return worst;
}

struct Errors {
  double factored = 0, dense = 0, poles = 0;
};

Errors compare(const System& system, const Json& scene, const Json& answer) {
  const auto rows = blocks(scene["outputs"]), cols = blocks(scene["inputs"]);
  std::vector<MatrixXcd> exact, factored, dense;
  for (const Json& point : answer["transfer"]) {
    const Complex s = complex(point["s"]);
    exact.push_back(matrix(point["G"], static_cast<Index>(system.inputs().size())));
    factored.push_back(system.transfer(s));
    dense.push_back(system.state_space().transfer(s));
  }
  return {titop_test::transfer_error(factored, exact, rows, cols),
          titop_test::transfer_error(dense, exact, rows, cols),
          pole_error(system.poles(), answer["poles"])};
}

}  // namespace

TEST_CASE("224 scenes: order, poles and transfer as assembled by hand, or the refusal by name") {
  int scenes = 0, refusals = 0, closed = 0;
  std::vector<std::filesystem::path> files;
  for (const auto& entry : std::filesystem::directory_iterator(kFolder / "scenes"))
    files.push_back(entry.path());
  std::sort(files.begin(), files.end());
  for (const auto& path : files) {
    CAPTURE(path.filename().string());
    const Json answer = read_json(kFolder / "answers" / path.filename());
    ++scenes;
    if (answer.contains("refused")) {
      const Json& refused = answer["refused"];
      const std::string said = titop_test::message_of([&] { compile(read_diagram(path)); });
      INFO(said);
      CHECK(said.find(fmt::format("error[{}]", refused["code"].get<std::string>())) !=
            std::string::npos);
      for (const Json& name : refused["names"])
        CHECK(said.find(name.get<std::string>()) != std::string::npos);
      ++refusals;
      continue;
    }
    std::string why;
    try {
      const System system = compile(read_diagram(path));
      const Errors e = compare(system, read_json(path), answer);
      CHECK(e.factored <= 1e-10);
      CHECK(e.dense <= 1e-8);
      closed +=
          std::ranges::any_of(system.notes(), [](const Note& n) { return n.pass == "close"; });
      CHECK(system.state_space().order() == answer["order"].get<int>());
      CHECK(system.order_verdict().decided());
      CHECK(e.poles <= 1e-7);
    } catch (const std::exception& error) {
      why = error.what();
    }
    CHECK(why == "");
  }
  CHECK(scenes == 224);
  CHECK(refusals == 32);
  CHECK(closed >= 30);
}
