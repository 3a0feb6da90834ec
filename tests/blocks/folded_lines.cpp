#include <doctest/doctest.h>

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <numbers>
#include <titop/analysis/bracket/interface_bracket.hpp>
#include <titop/blocks/flexible_body.hpp>
#include <titop/blocks/line_port.hpp>
#include <titop/compiler/system/system.hpp>

#include "panels.hpp"
#include "support/mistakes.hpp"

/// Panels that meet at an angle, as of a box: each is rigid along the other's deflection.

using namespace titop;
using Eigen::MatrixXd;
using titop_test::error_of;
using titop_test::says;

namespace {

constexpr double kRight = std::numbers::pi / 2;

/// Frequencies of one panel with its edge x0 straight at rest, clamped or free to turn, from M and
/// K of its mesh.
std::vector<double> of_one(const fe::Mesh& mesh, bool clamped) {
  std::vector<Eigen::Index> kept;
  for (std::size_t i = 0; i < mesh.dofs.size(); ++i) {
    const bool at_edge = mesh.points[mesh.dofs[i].point].position.x() == 0;
    const int component = mesh.dofs[i].component;
    const bool turns = component == 4 || component == fe::kTwist;
    if (!at_edge || (turns && !clamped)) kept.push_back(static_cast<Eigen::Index>(i));
  }
  const MatrixXd K = mesh.K(kept, kept), M = mesh.M(kept, kept);
  const Eigen::GeneralizedSelfAdjointEigenSolver<MatrixXd> modes(K, M, Eigen::EigenvaluesOnly);
  std::vector<double> omega;
  for (const double square : modes.eigenvalues())
    if (square > 1) omega.push_back(std::sqrt(square));
  return omega;
}

/// Two equal panels with a common edge, whose middle stays where it is and turns about the edge.
/// The edge is a child of `fixed`, whose parent is a free corner, and the parent of `hung`.
Diagram folded(Lumping lumping, double angle) {
  const fe::Mesh plain = panels::panel(0.5, 3, 3);
  const fe::NodeSet edge = fe::edge(plain, "x0");
  const fe::Mesh mesh =
      fe::with_interface(plain, "fold",
                         lumping == Lumping::constrained ? fe::shapes(edge, fe::legendre(4))
                                                         : fe::moments(edge, fe::legendre(4)));
  Diagram d{"folded"};
  auto fixed = d.add("fixed", FlexibleBody{fe::modal_data(mesh, "3,0", {"fold"})});
  auto hung = d.add("hung", FlexibleBody{fe::modal_data(mesh, "fold", {})});
  fixed.parent.force = 0;
  weld(hung.line("fold"), fixed.line("fold"), Rotation::about({0, 1, 0}, angle));
  const DualPort<6> middle = fixed.child("fold");
  for (const Vector3d& axis : {Vector3d(1, 0, 0), Vector3d(0, 1, 0), Vector3d(0, 0, 1)})
    ground(middle.along(axis));
  ground(middle.about({1, 0, 0})), ground(middle.about({0, 0, 1}));
  return d;
}

}  // namespace

TEST_CASE("two equal folded panels: modes of one panel with its edge clamped, and hinged") {
  const fe::Mesh one = panels::panel(0.5, 3, 3);
  std::vector<double> right = of_one(one, true), hinged = of_one(one, false);
  right.insert(right.end(), hinged.begin(), hinged.end());
  std::ranges::sort(right);
  for (const double angle : {kRight, -kRight, 1.0}) {
    CAPTURE(angle);
    const InterfaceBracket b =
        interface_bracket([&](Lumping l) { return folded(l, angle); }, {.modes = 6});
    for (std::size_t k = 0; k < b.omega.size(); ++k) {
      CAPTURE(k);
      CHECK(b.omega[k].below <= right[k] * (1 + 1e-7));
      CHECK(b.omega[k].above >= right[k] * (1 - 1e-7));
      CHECK(b.omega[k].width() <= 0.05 * right[k]);
    }
  }
}

TEST_CASE("folded lines of other numbers of polynomials are refused") {
  const fe::Mesh plain = panels::panel(0.5, 3, 3);
  const auto with = [&](int m) {
    return fe::with_interface(plain, "fold", fe::shapes(fe::edge(plain, "x0"), fe::legendre(m)));
  };
  Diagram d{"folded"};
  auto a = d.add("a", FlexibleBody{fe::modal_data(with(4), "fold", {})});
  auto b = d.add("b", FlexibleBody{fe::modal_data(with(3), "3,0", {"fold"})});
  CHECK(says(error_of([&] {
               weld(a.line("fold"), b.line("fold"), Rotation::about({0, 1, 0}, kRight));
             }),
             Code::size, {"a.fold", "b.fold", "ry3"}));
}
