#include <doctest/doctest.h>

#include <algorithm>
#include <string>
#include <titop/blocks/fe/interfaces.hpp>
#include <titop/blocks/fe/modal_checks.hpp>
#include <titop/blocks/fe/plate.hpp>
#include <vector>

#include "support/names.hpp"

/// Rank of the channels of a line: which shapes the modes move, and independently of each other.

using namespace titop;
using Eigen::Index;
using Eigen::MatrixXd;

namespace {

/// A plate with the lines "root" and "next" of four polynomials at its edges x0 and x1.
fe::Mesh plate() {
  fe::Mesh mesh = plate_mesh({.a = 0.8,
                              .b = 0.6,
                              .thickness = 0.004,
                              .material = {.E = 70e9, .nu = 0.3, .rho = 2700},
                              .elements = {4, 4}});
  mesh = fe::with_interface(mesh, "root", fe::shapes(fe::edge(mesh, "x0"), fe::legendre(4)));
  return fe::with_interface(mesh, "next", fe::shapes(fe::edge(mesh, "x1"), fe::legendre(4)));
}

ModalData kept(int modes, std::vector<std::string> residual = {}) {
  return fe::modal_data(plate(), "root", {"next"},
                        {.kept = modes, .residual = std::move(residual)});
}

bool contains(const std::vector<std::string>& list, const std::string& name) {
  return std::ranges::find(list, name) != list.end();
}

}  // namespace

TEST_CASE("with residual vectors every channel of an edge moves but those in the plate's plane") {
  const ModalReport report = modal_report(kept(3, {"root", "next"}));
  REQUIRE(report.lines.size() == 2);
  for (const LineRank& line : report.lines) {
    const bool is_child = line.line == "next";
    CAPTURE(line.line);
    CHECK(line.channels == (is_child ? 6 + 5 : 5));  // z2, z3, ry1, ry2, ry3
    CHECK(line.rank == (is_child ? 3 + 5 : 5));
    CHECK(line.condition < 1e6);
    CHECK(line.blocked ==
          (is_child ? std::vector<std::string>{"x", "y", "rz"} : std::vector<std::string>{}));
  }
}

TEST_CASE("no more independent channels than modes, and the report says how many") {
  for (const int modes : {1, 2, 3}) {
    const ModalReport report = modal_report(kept(modes));
    for (const LineRank& line : report.lines) {
      CHECK(line.rank == modes);
      CHECK(static_cast<int>(line.blocked.size()) == line.channels - line.rank);
      CHECK(titop_test::has_line(to_string(report),
                                 {"line " + line.line, "rank " + std::to_string(line.rank),
                                  "of " + std::to_string(line.channels)}));
    }
  }
  const ModalReport none = modal_report(kept(0));
  for (const LineRank& line : none.lines) {
    CHECK(line.rank == 0);
    CHECK(contains(line.blocked, "z3"));
  }
}

TEST_CASE("symmetry: the lowest mode of a plate clamped at x0 moves no odd shape of x1") {
  const ModalData data = kept(1);
  for (const LineRank& line : modal_report(data).lines) {
    if (line.line != "next") continue;
    for (const char* odd : {"rx", "z3", "ry1", "ry3"}) {
      CAPTURE(odd);
      CHECK(contains(line.blocked, odd));
    }
    for (const char* even : {"z", "z2", "ry", "ry2"}) CHECK(!contains(line.blocked, even));
  }
}

TEST_CASE("combinations of shapes and the point's motion that no mode moves") {
  ModalData data = kept(4);
  data.lines.erase(data.lines.begin());
  ModalLine& line = data.lines.at(0);
  REQUIRE(line.name == "next");
  line.shapes = {{2, 2}, {2, 3}, {4, 1}};
  // z is 0.5 z2 and ry is ry1 in every mode; z3 moves by itself.
  MatrixXd& Phi = data.children.at(0).Phi_C;
  Phi.setZero();
  Phi.row(2) << 1, 2, 3, 1;
  Phi.row(4) << 1, -1, 0, 2;
  line.Phi.resize(3, 4);
  line.Phi << 2 * Phi.row(2), Eigen::RowVector4d(0, 1, 1, -1), Phi.row(4);
  const LineRank rank = line_rank(data, line);
  CHECK(rank.channels == 9);
  CHECK(rank.rank == 3);
  std::vector<std::string> blocked = rank.blocked;
  std::ranges::sort(blocked);
  CHECK(blocked == std::vector<std::string>{"rx", "ry - ry1", "rz", "x", "y", "z - 0.5 z2"});
  // The line of a parent has its shapes alone.
  data.children.clear();
  const LineRank of_parent = line_rank(data, line);
  CHECK(of_parent.channels == 3);
  CHECK(of_parent.rank == 3);
  CHECK(of_parent.blocked.empty());
}
