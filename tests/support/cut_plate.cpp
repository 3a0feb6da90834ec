#include "support/cut_plate.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <titop/blocks/fe/interfaces.hpp>
#include <titop/blocks/fe/plate.hpp>
#include <titop/graph/linalg/symmetric.hpp>

using namespace titop;
using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

namespace titop_test {

Index row_of(const fe::Mesh& mesh, std::size_t point, int component) {
  for (std::size_t i = 0; i < mesh.dofs.size(); ++i)
    if (mesh.dofs[i].point == point && mesh.dofs[i].component == component)
      return static_cast<Index>(i);
  return -1;
}

namespace {

/// Omegas of a, clamped along x0, with b welded to its end: the coordinates of both lines are the
/// same, with these signs.
VectorXd welded(const fe::Mesh& a, const fe::Mesh& b) {
  const std::vector<Index> next = rows_of(a, "next"), prev = rows_of(b, "prev");
  REQUIRE(next.size() == prev.size());
  const Index n = a.M.rows(), all = n + b.M.rows();
  MatrixXd T = MatrixXd::Zero(all, all - static_cast<Index>(prev.size()));
  T.topLeftCorner(n, n).setIdentity();
  Index column = n;
  for (Index i = 0; i < b.M.rows(); ++i) {
    const auto at = std::find(prev.begin(), prev.end(), i);
    T(n + i, at == prev.end() ? column++ : next[static_cast<std::size_t>(at - prev.begin())]) = 1;
  }
  std::vector<Index> free;
  const std::vector<Index> root = rows_of(a, "root");
  for (Index i = 0; i < T.cols(); ++i)
    if (std::find(root.begin(), root.end(), i) == root.end()) free.push_back(i);
  const auto assembled = [&](const MatrixXd& A, const MatrixXd& B) {
    MatrixXd S = MatrixXd::Zero(all, all);
    S.topLeftCorner(n, n) = A;
    S.bottomRightCorner(B.rows(), B.rows()) = B;
    return MatrixXd((T.transpose() * S * T)(free, free));
  };
  return eigh_definite(assembled(a.K, b.K), assembled(a.M, b.M)).lambda.cwiseSqrt();
}

}  // namespace

fe::Mesh half_plate(int along_x, int along_y) {
  return plate_mesh({.a = 0.5,
                     .b = 1,
                     .thickness = 0.01,
                     .material = {.rho = 100},
                     .D = PlateStiffness{1, 0.3, 1, 0.35},
                     .elements = {along_x, along_y}});
}

std::vector<Index> rows_of(const fe::Mesh& mesh, const std::string& name) {
  std::vector<Index> rows;
  for (const int c : {2, 3, 4}) rows.push_back(row_of(mesh, fe::find_point(mesh, name), c));
  for (const fe::MeshLine& line : mesh.lines)
    if (line.name == name)
      for (const std::size_t point : line.points)
        rows.push_back(row_of(mesh, point, fe::kGeneralised));
  return rows;
}

VectorXd cut_plate(int along_x, int along_y, int behind, int m, bool restricted) {
  fe::Mesh a = half_plate(along_x, along_y), b = half_plate(along_x, behind);
  const auto coupling = [&](const fe::NodeSet& edge) {
    return restricted ? fe::shapes(edge, fe::legendre(m)) : fe::moments(edge, fe::legendre(m));
  };
  a = fe::with_interface(a, "root", fe::rigid(fe::edge(a, "x0")));
  a = fe::with_interface(a, "next", coupling(fe::edge(a, "x1")));
  return welded(a, fe::with_interface(b, "prev", coupling(fe::edge(b, "x0"))));
}

}  // namespace titop_test
