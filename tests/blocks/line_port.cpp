#include <doctest/doctest.h>

#include <algorithm>
#include <numbers>
#include <string>
#include <titop/blocks/diagram_file/diagram_file.hpp>
#include <titop/blocks/fe/modal_csv.hpp>
#include <titop/blocks/flexible_body.hpp>
#include <titop/blocks/line_port.hpp>
#include <titop/blocks/port_hamiltonian.hpp>
#include <titop/compiler/system/system.hpp>
#include <titop/graph/linalg/eigen.hpp>
#include <vector>

#include "panels.hpp"
#include "support/mistakes.hpp"
#include "support/transfer_error.hpp"

/// Lines of bodies: welded and hinged plates against their meshes assembled by hand, in other
/// mounting rotations.

using namespace titop;
using namespace panels;
using Eigen::Index;
using Eigen::MatrixXcd;
using Eigen::MatrixXd;
using std::numbers::pi;
using titop_test::error_of;
using titop_test::says;
using Complex = std::complex<double>;

namespace {

constexpr double kSpring = 30, kDamper = 0.4;  // of the hinge [N m/rad, N m s/rad]

/// "prev" and "tip" at these edges.
fe::Mesh outer(const std::string& prev = "x0", const std::string& tip = "x1", int along_y = 4) {
  fe::Mesh mesh = panel(0.5, 2, along_y);
  mesh = fe::with_interface(mesh, "prev", shapes(mesh, prev));
  return fe::with_interface(mesh, "tip", fe::average(fe::edge(mesh, tip)));
}

FlexibleBody body(const fe::Mesh& mesh, const std::string& parent, const std::string& child) {
  return fe::modal_data(mesh, parent, {child});
}

std::vector<Complex> points() { return {{0, 2}, {0, 31}, {3, 50}, {40, 300}, {200, 0}}; }

/// Rows of the point (z, rx, ry), then of the shapes.
std::vector<Index> rows_of(const fe::Mesh& mesh, const std::string& name) {
  std::vector<Index> rows;
  const auto add = [&](std::size_t point, int component) {
    for (std::size_t i = 0; i < mesh.dofs.size(); ++i)
      if (mesh.dofs[i].point == point && mesh.dofs[i].component == component)
        rows.push_back(static_cast<Index>(i));
  };
  for (const int c : {2, 3, 4}) add(fe::find_point(mesh, name), c);
  for (const fe::MeshLine& line : mesh.lines)
    if (line.name == name)
      for (const std::size_t point : line.points) add(point, fe::kGeneralised);
  return rows;
}

/// The two meshes with lines a.next and b.prev tied, but for the coordinates `free` of these lines;
/// all `held` rows are 0. Unknowns: a's rows, then b's.
struct Assembled {
  MatrixXd M, K, C;
  std::vector<Index> unknown_of_b;  ///< for each row of b
  std::vector<Index> kept;          ///< unknowns that are not held

  /// s^2 (s^2 M + s C + K)^-1 at these unknowns.
  MatrixXcd acceleration(const std::vector<Index>& at, Complex s) const {
    const MatrixXcd S = s * s * M(kept, kept) + s * C(kept, kept) + K(kept, kept);
    MatrixXcd B = MatrixXcd::Zero(S.rows(), static_cast<Index>(at.size()));
    for (std::size_t i = 0; i < at.size(); ++i)
      B(std::find(kept.begin(), kept.end(), at[i]) - kept.begin(), static_cast<Index>(i)) = 1;
    return s * s * B.transpose() * Eigen::PartialPivLU<MatrixXcd>(S).solve(B);
  }
};

Assembled assembled(const fe::Mesh& a, const fe::Mesh& b, const std::vector<bool>& free,
                    std::vector<Index> held) {
  const std::vector<Index> next = rows_of(a, "next"), prev = rows_of(b, "prev");
  const Index n = a.M.rows();
  Assembled result;
  Index count = n;
  for (Index i = 0; i < b.M.rows(); ++i) {
    const auto at = std::find(prev.begin(), prev.end(), i) - prev.begin();
    const auto k = static_cast<std::size_t>(at);
    result.unknown_of_b.push_back(k < prev.size() && !free[k] ? next[k] : count++);
  }
  for (MatrixXd* S : {&result.M, &result.K, &result.C}) *S = MatrixXd::Zero(count, count);
  result.M.topLeftCorner(n, n) = a.M;
  result.K.topLeftCorner(n, n) = a.K;
  result.M(result.unknown_of_b, result.unknown_of_b) += b.M;
  result.K(result.unknown_of_b, result.unknown_of_b) += b.K;
  for (Index i = 0; i < count; ++i)
    if (std::find(held.begin(), held.end(), i) == held.end()) result.kept.push_back(i);
  return result;
}

std::vector<Index> in_b(const Assembled& assembled, const std::vector<Index>& rows) {
  std::vector<Index> result;
  for (const Index row : rows)
    result.push_back(assembled.unknown_of_b[static_cast<std::size_t>(row)]);
  return result;
}

/// Coordinates z, rx, ry, z2, z3, ry1, ry2, ry3 of the lines that a hinge leaves free.
const std::vector<bool> kWelded(8, false), kHinged = {false, false, true, false,
                                                      false, true,  true, true};

/// Accelerations z, rx, ry of `port` of the body per wrench there, at all points.
std::vector<MatrixXcd> accelerations(Diagram d, const DualPort<6>& port, const Rotation& T = {}) {
  port.force += d.input("F", 6);
  d.output("a", 6) = port.accel;
  const System system = compile(d);
  MatrixXd turn = MatrixXd::Zero(6, 6);
  turn.topLeftCorner(3, 3) = turn.bottomRightCorner(3, 3) = T.nominal();
  std::vector<MatrixXcd> result;
  for (const Complex s : points())
    result.push_back((turn * system.transfer(s) * turn.transpose()).block(2, 2, 3, 3));
  return result;
}

double apart(const std::vector<MatrixXcd>& a, const std::vector<MatrixXcd>& b) {
  return titop_test::transfer_error(a, b, {1, 1, 1}, {1, 1, 1});
}

std::vector<MatrixXcd> by_hand(const Assembled& assembled, const std::vector<Index>& at) {
  std::vector<MatrixXcd> result;
  for (const Complex s : points()) result.push_back(assembled.acceleration(at, s));
  return result;
}

std::vector<Index> first_three(std::vector<Index> rows) {
  rows.resize(3);
  return rows;
}

}  // namespace

TEST_CASE("plates welded along edges of other meshes, in all mounting rotations") {
  const Assembled whole =
      assembled(inner(), outer(), kWelded, first_three(rows_of(inner(), "root")));
  const std::vector<MatrixXcd> expected = by_hand(whole, in_b(whole, rows_of(outer(), "tip")));
  struct Mounting {
    Vector3d axis;
    double angle;
    std::string prev, tip;
  };
  // A rectangle turned by half a turn about each of its axes is itself; the edge is another one.
  for (const Mounting& m :
       {Mounting{{0, 0, 1}, 0, "x0", "x1"}, Mounting{{0, 0, 1}, pi, "x1", "x0"},
        Mounting{{0, 1, 0}, pi, "x1", "x0"}, Mounting{{1, 0, 0}, pi, "x0", "x1"}}) {
    const Rotation T = Rotation::about(m.axis, m.angle);
    Diagram d{"wing"};
    auto a = d.add("a", body(inner(), "root", "next"));
    auto b = d.add("b", body(outer(m.prev, m.tip), "prev", "tip"));
    ground(a);
    weld(b.line("prev"), a.line("next"), T);
    INFO(m.axis.transpose(), ", ", m.angle);
    CHECK(apart(accelerations(std::move(d), b.child("tip"), T), expected) <= 1e-9);
  }
  // The other way round.
  Diagram d{"wing"};
  auto a = d.add("a", body(inner(), "root", "next"));
  auto b = d.add("b", body(outer("x1", "x0"), "prev", "tip"));
  ground(a);
  const Rotation T = Rotation::about({0, 0, 1}, pi);
  weld(a.line("next"), b.line("prev"), T.inverse());
  CHECK(apart(accelerations(std::move(d), b.child("tip"), T), expected) <= 1e-9);
}

TEST_CASE("a hinge along the whole edge, with a spring and a damper") {
  Assembled whole = assembled(inner(), outer(), kHinged, first_three(rows_of(inner(), "root")));
  const Index ry_a = rows_of(inner(), "next")[2];
  const Index ry_b = whole.unknown_of_b[static_cast<std::size_t>(rows_of(outer(), "prev")[2])];
  for (const auto& [S, value] : {std::pair{&whole.K, kSpring}, {&whole.C, kDamper}}) {
    (*S)(ry_a, ry_a) += value, (*S)(ry_b, ry_b) += value;
    (*S)(ry_a, ry_b) -= value, (*S)(ry_b, ry_a) -= value;
  }
  Diagram d{"wing"};
  auto a = d.add("a", body(inner(), "root", "next"));
  auto b = d.add("b", body(outer(), "prev", "tip"));
  ground(a);
  auto h = hinge_line(d, "h", b.line("prev"), a.line("next"));
  h.torque = kSpring * h.angle + kDamper * h.rate;
  CHECK(apart(accelerations(std::move(d), b.child("tip")),
              by_hand(whole, in_b(whole, rows_of(outer(), "tip")))) <= 1e-9);
}

TEST_CASE("a closed chain: both plates are held, and welded along their free edges") {
  const std::vector<Index> root = first_three(rows_of(inner(), "root"));
  const fe::Mesh b_mesh = outer();
  std::vector<Index> held = root;
  Assembled whole = assembled(inner(), b_mesh, kWelded, held);
  for (const Index row : in_b(whole, rows_of(b_mesh, "tip"))) held.push_back(row);
  whole = assembled(inner(), b_mesh, kWelded, held);
  Diagram d{"floor"};
  auto a = d.add("a", body(inner(), "root", "next"));
  auto b = d.add("b", body(b_mesh, "tip", "prev"));
  ground(a), ground(b);
  weld(b.line("prev"), a.line("next"));
  CHECK(apart(accelerations(std::move(d), a.child("next")),
              by_hand(whole, first_three(rows_of(inner(), "next")))) <= 1e-9);
}

TEST_CASE("a line in a diagram file, in a body's own diagram, and its port-Hamiltonian form") {
  Diagram d{"wing"};
  auto a = d.add("a", body(inner(), "root", "next"));
  auto b = d.add("b", body(outer(), "prev", "tip"));
  ground(a);
  weld(b.line("prev"), a.line("next"));
  b.child("tip").force += d.input("F", 6);
  d.output("a", 6) = b.child("tip").accel;
  const Diagram again = parse_diagram(diagram_json(d));
  CHECK(compile(again).transfer({3, 50}) == compile(d).transfer({3, 50}));
  const ModalData data = fe::modal_data(outer(), "prev", {"tip"});
  const System alone = compile(diagram_of_body(data));
  CHECK(alone.state_space().B.cols() == 6 + 6 + 5);
  const MatrixXd W = modal_input(data);
  CHECK(W.cols() == 17);
  CHECK(W.middleCols(6, 5) == data.lines.at(0).Phi.transpose());
  CHECK(port_hamiltonian(FlexibleBody{data}).P.rows() == 17);
  CHECK(says(error_of([&] { fe::modal_csv(data); }), Code::bad_value, {"prev"}));
}
