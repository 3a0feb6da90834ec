#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <titop/blocks/fe/beam.hpp>
#include <titop/blocks/fe/interfaces.hpp>
#include <titop/blocks/fe/plate.hpp>
#include <titop/graph/error.hpp>
#include <titop/graph/linalg/eigen.hpp>
#include <titop/graph/linalg/symmetric.hpp>
#include <vector>

#include "dynamics.hpp"
#include "support/cut_plate.hpp"
#include "support/mistakes.hpp"

/// Edges as interfaces: shapes and moments by hand, and two half plates welded along a cut, whose
/// frequencies enclose those of the whole plate.

using namespace titop;
using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;
using fe_test::relative;
using titop_test::cut_plate;
using titop_test::half_plate;
using titop_test::row_of;
using titop_test::rows_of;

TEST_CASE("two halves of a plate, welded by m polynomials: the same in another program") {
  struct Case {
    int behind, m;
    bool restricted;
    std::vector<double> omega;
  };
  // 4 x 6 elements before the cut; matching and not matching behind it.
  for (const Case& c : {
           Case{6, 2, true, {3.491788840, 8.514202979, 21.918825284, 31.030708961}},
           Case{6, 2, false, {3.471543828, 8.230923515, 20.132926689, 23.230510795}},
           Case{6, 3, true, {3.473561051, 8.514202979, 21.299291137, 28.214040292}},
           Case{6, 3, false, {3.471702988, 8.230923515, 21.265996347, 27.026626056}},
           Case{6, 4, true, {3.473561051, 8.511460688, 21.299291137, 28.214040292}},
           Case{6, 4, false, {3.471702988, 8.453488299, 21.265996347, 27.026626056}},
           Case{5, 3, true, {3.473565258, 8.514447776, 21.299518397, 28.220766488}},
           Case{5, 3, false, {3.471705546, 8.231278298, 21.266140318, 27.032160516}},
       }) {
    const VectorXd omega = cut_plate(4, 6, c.behind, c.m, c.restricted);
    for (std::size_t k = 0; k < c.omega.size(); ++k) {
      INFO("behind ", c.behind, ", m ", c.m, ", restricted ", c.restricted, ", mode ", k + 1);
      CHECK(relative(omega(static_cast<Index>(k)), c.omega[k]) <= 1e-8);
    }
  }
}

TEST_CASE("the whole plate's frequencies lie between, and the bounds close in") {
  // 8 x 6 elements without a cut, in another program.
  const std::vector<double> exact = {3.472102693,  8.510327217,  21.293861534,
                                     27.208952530, 30.973790631, 54.239144234};
  std::vector<double> width(exact.size(), 1e9);
  for (const int m : {2, 3, 4, 5, 6}) {
    const VectorXd above = cut_plate(4, 6, 6, m, true), below = cut_plate(4, 6, 6, m, false);
    for (std::size_t k = 0; k < exact.size(); ++k) {
      const auto i = static_cast<Index>(k);
      CHECK(below(i) <= exact[k] * (1 + 1e-9));
      CHECK(above(i) >= exact[k] * (1 - 1e-9));
      CHECK(above(i) - below(i) <= width[k] + 1e-9 * exact[k]);
      width[k] = above(i) - below(i);
    }
  }
  for (std::size_t k = 0; k < exact.size(); ++k) CHECK(width[k] <= 6e-3 * exact[k]);
}

TEST_CASE("halves whose meshes do not match converge to the whole plate with mesh and shapes") {
  // 24 x 24 elements without a cut, in another program.
  const std::vector<double> exact = {3.471088781, 8.506707846, 21.285005593, 27.198927073};
  struct Step {
    int along_x, before, behind, m;
  };
  double above = 1, below = 1;
  for (const Step& s : {Step{3, 4, 3, 3}, Step{5, 8, 7, 5}, Step{6, 10, 9, 7}}) {
    CAPTURE(s.before);
    const double last_above = above, last_below = below;
    above = below = 0;
    for (const bool restricted : {true, false}) {
      const VectorXd omega = cut_plate(s.along_x, s.before, s.behind, s.m, restricted);
      double& worst = restricted ? above : below;
      for (std::size_t k = 0; k < exact.size(); ++k)
        worst = std::max(worst, relative(omega(static_cast<Index>(k)), exact[k]));
    }
    CHECK(above < last_above / 3);
    CHECK(below < last_below / 3);
  }
  CHECK(above <= 2e-4);
  CHECK(below <= 2e-3);
}

TEST_CASE("shapes of an edge along x: displacements and slopes by hand") {
  // Along x the rotation about the edge is rx = w_y, the slope of w is -ry.
  const fe::Mesh plain = plate_mesh({.a = 2,
                                     .b = 1,
                                     .thickness = 0.01,
                                     .material = {.E = 70e9, .nu = 0.3, .rho = 2700},
                                     .elements = {4, 2}});
  const fe::NodeSet edge = fe::edge(plain, "y1");
  const fe::Mesh mesh = fe::with_interface(plain, "e", fe::shapes(edge, fe::legendre(4)));
  REQUIRE(mesh.lines.size() == 1);
  const fe::MeshLine& line = mesh.lines[0];
  CHECK(line.axis == 0);
  CHECK(line.length == 2);
  std::vector<std::string> names;
  for (const LineShape& s : line.shapes) names.push_back(to_string(s));
  CHECK(names == std::vector<std::string>{"z2", "z3", "rx1", "rx2", "rx3"});
  CHECK(mesh.M.rows() == plain.M.rows() - 5 * 4 + 3 + 5);
  // z, rx, ry, wxy of the nodes per coordinate x = (z, rx, ry), P2, P3 of w, P1, P2, P3 of w_y.
  MatrixXd T = MatrixXd::Zero(20, 8);
  for (Index i = 0; i <= 4; ++i) {
    const double x = -1 + 0.5 * double(i);  // m from the middle, and half lengths
    T(4 * i, 0) = 1;
    T.row(4 * i + 1)(1) = 1;
    T(4 * i, 2) = -x, T(4 * i + 2, 2) = 1;
    T(4 * i, 3) = (3 * x * x - 1) / 2, T(4 * i + 2, 3) = -3 * x;
    T(4 * i, 4) = (5 * x * x * x - 3 * x) / 2, T(4 * i + 2, 4) = -(15 * x * x - 3) / 2;
    T(4 * i + 1, 5) = x, T(4 * i + 3, 5) = 1;
    T(4 * i + 1, 6) = (3 * x * x - 1) / 2, T(4 * i + 3, 6) = 3 * x;
    T(4 * i + 1, 7) = (5 * x * x * x - 3 * x) / 2, T(4 * i + 3, 7) = (15 * x * x - 3) / 2;
  }
  std::vector<Index> rows;
  for (const std::size_t point : edge.points)
    for (const int c : {2, 3, 4, fe::kTwist}) rows.push_back(row_of(plain, point, c));
  const std::vector<Index> tied = rows_of(mesh, "e");
  for (const auto& [S, S_tied] : {std::pair{&plain.K, &mesh.K}, {&plain.M, &mesh.M}}) {
    const MatrixXd expected = T.transpose() * (*S)(rows, rows) * T;
    CHECK(((*S_tied)(tied, tied) - expected).cwiseAbs().maxCoeff() <=
          1e-12 * expected.cwiseAbs().maxCoeff());
  }
}

TEST_CASE("lines in the modal data: coordinates of the parent's and the child's shapes") {
  const fe::Mesh plain = half_plate(2, 3);
  fe::Mesh mesh =
      fe::with_interface(plain, "prev", fe::shapes(fe::edge(plain, "x0"), fe::legendre(3)));
  mesh = fe::with_interface(mesh, "next", fe::moments(fe::edge(mesh, "x1"), fe::legendre(3)));
  const ModalData data = fe::modal_data(mesh, "prev", {"next"});
  REQUIRE(data.lines.size() == 2);
  // Flexibility of the shapes against each other: the rows of K^-1 clamped at the parent's point.
  std::vector<Index> free;
  const std::vector<Index> prev = rows_of(mesh, "prev"), next = rows_of(mesh, "next");
  for (Index i = 0; i < mesh.K.rows(); ++i)
    if (std::find(prev.begin(), prev.begin() + 3, i) == prev.begin() + 3) free.push_back(i);
  MatrixXd B = MatrixXd::Zero(static_cast<Index>(free.size()), 6), Phi(6, data.omega.size());
  for (Index k = 0; k < 3; ++k)
    for (const auto& [rows, column] : {std::pair{&prev, k}, {&next, k + 3}})
      B(std::find(free.begin(), free.end(), (*rows)[static_cast<std::size_t>(3 + k)]) -
            free.begin(),
        column) = 1;
  Phi << data.lines[0].Phi, data.lines[1].Phi;
  const MatrixXd expected = B.transpose() * solve_definite(mesh.K(free, free), B);
  const MatrixXd found = Phi * data.omega.cwiseAbs2().cwiseInverse().asDiagonal() * Phi.transpose();
  CHECK((found - expected).cwiseAbs().maxCoeff() <= 1e-10 * expected.cwiseAbs().maxCoeff());
  // With a few modes and residual vectors the flexibility is the same.
  const ModalData few =
      fe::modal_data(mesh, "prev", {"next"}, {.kept = 4, .residual = {"prev", "next"}});
  CHECK(few.omega.size() < data.omega.size());
  MatrixXd Phi_few(6, few.omega.size());
  Phi_few << few.lines[0].Phi, few.lines[1].Phi;
  const MatrixXd kept =
      Phi_few * few.omega.cwiseAbs2().cwiseInverse().asDiagonal() * Phi_few.transpose();
  CHECK((kept - expected).cwiseAbs().maxCoeff() <= 1e-7 * expected.cwiseAbs().maxCoeff());
  CHECK(fe::modal_data(mesh, "next", {}).lines.size() == 1);
}

TEST_CASE("an edge of nodes with six degrees of freedom: shapes and moments of a beam's axis") {
  const fe::Mesh beam = beam_mesh({.length = 2.5,
                                   .section = rectangle(0.06, 0.04),
                                   .material = {.E = 70e9, .nu = 0.33, .rho = 2700},
                                   .elements = 5});
  const fe::NodeSet axis = fe::segment(beam, {1, 0, 0}, {2.5, 0, 0});
  REQUIRE(axis.points.size() == 4);
  const double half = 0.75;
  // Of each component x, y, z, rx its coefficients of P0, P1, P2 by the trapezoidal rule.
  MatrixXd V(4, 3), T = MatrixXd::Zero(24, 6 + 6), A = MatrixXd::Zero(12, 24);
  for (Index i = 0; i < 4; ++i) {
    const double s = -1 + 2 * double(i) / 3, P2 = (3 * s * s - 1) / 2;
    V.row(i) << 1, s, P2;
    const auto row = [&](int component) { return 6 * i + component; };
    for (int c = 0; c < 6; ++c) T(row(c), c) = 1;
    T(row(1), 5) = half * s, T(row(2), 4) = -half * s;
    T(row(0), 6) = s, T(row(0), 7) = P2;              // x1, x2
    T(row(1), 8) = P2, T(row(5), 8) = 3 * s / half;   // y2
    T(row(2), 9) = P2, T(row(4), 9) = -3 * s / half;  // z2
    T(row(3), 10) = s, T(row(3), 11) = P2;            // rx1, rx2
  }
  const VectorXd weights = (VectorXd(4) << 0.5, 1, 1, 0.5).finished();
  const MatrixXd VW = V.transpose() * weights.asDiagonal();
  const MatrixXd fit = solve_definite(VW * V, VW);
  const std::vector<std::vector<Index>> into = {{0, 6, 7}, {1, 5, 8}, {2, 4, 9}, {3, 10, 11}};
  for (Index c = 0; c < 4; ++c)
    for (Index k = 0; k < 3; ++k)
      for (Index i = 0; i < 4; ++i) A(into[std::size_t(c)][std::size_t(k)], 6 * i + c) = fit(k, i);
  A.row(5) /= half, A.row(4) /= -half;
  const auto interface_of = [&](const fe::Coupling& coupling, MatrixXd& compliance) {
    const fe::Mesh mesh = fe::with_interface(beam, "e", coupling);
    std::vector<std::string> names;
    for (const LineShape& s : mesh.lines.at(0).shapes) names.push_back(to_string(s));
    CHECK(names == std::vector<std::string>{"x1", "x2", "y2", "z2", "rx1", "rx2"});
    const ModalData data = fe::modal_data(mesh, "P", {"e"});
    MatrixXd Phi(12, data.omega.size());
    Phi << data.children[0].Phi_C, data.lines.at(0).Phi;
    compliance = Phi * data.omega.cwiseAbs2().cwiseInverse().asDiagonal() * Phi.transpose();
  };
  MatrixXd free, constrained;
  interface_of(fe::moments(axis, fe::legendre(3)), free);
  interface_of(fe::shapes(axis, fe::legendre(3)), constrained);
  const std::vector<Index> rest = [&] {
    std::vector<Index> rows;
    for (Index i = 6; i < beam.K.rows(); ++i) rows.push_back(i);
    return rows;
  }();
  const MatrixXd K = beam.K(rest, rest);
  MatrixXd edge = MatrixXd::Zero(30, 24);  // rows of nodes 2 to 5 among those of 1 to 5
  edge.bottomRows(24).setIdentity();
  const MatrixXd by_moments = A * edge.transpose() * solve_definite(K, edge * A.transpose());
  MatrixXd S = MatrixXd::Zero(30, 6 + 12);
  S.topLeftCorner(6, 6).setIdentity();
  S.bottomRightCorner(24, 12) = T;
  const MatrixXd by_shapes =
      solve_definite(S.transpose() * K * S, MatrixXd::Identity(18, 18)).bottomRightCorner(12, 12);
  for (const auto& [found, expected] :
       {std::pair{&free, &by_moments}, {&constrained, &by_shapes}}) {
    const VectorXd scale = expected->diagonal().cwiseSqrt().cwiseInverse();
    CHECK((scale.asDiagonal() * (*found - *expected) * scale.asDiagonal()).cwiseAbs().maxCoeff() <=
          1e-9);
  }
}
