// A solar array of three panels on a yoke, hinged along their whole edges. Plates are clamped by
// the yoke along a third of an edge, since at a single node their frequencies would fall with every
// mesh. The edges move by a few polynomials, or are measured by them: two models, between which
// each frequency of the array with hinges at every node lies (with all modes of the meshes; the six
// that are kept here, with residual vectors, change the last digits). The same from the matrices of
// all meshes, put together by hand.
#include <algorithm>
#include <array>
#include <cstdio>
#include <titop/titop.hpp>
#include <vector>

#include "by_hand/by_hand.hpp"
#include "scenes/solar_array.hpp"

using namespace titop;
using namespace scenes::solar_array;
using by_hand::Index;
using Eigen::MatrixXd;

namespace {

/// Meshes one behind the other, in coordinates of the whole: six of the hub, then each mesh's own.
class Assembly {
 public:
  explicit Assembly(Index coordinates) : a_(by_hand::empty(coordinates, 6, 6)) {}

  /// Adds a mesh whose parent moves by x (6 rows); of its line there, rows `shapes` move the shapes
  /// of displacement. Afterwards `point` is the motion of `child`, and `line` that of its shapes.
  void add(const fe::Mesh& mesh, const std::string& parent, const std::string& child,
           const MatrixXd& x, const std::vector<MatrixXd>& shapes) {
    T_ = MatrixXd::Zero(mesh.M.rows(), a_.M.rows());
    std::vector<bool> placed(mesh.dofs.size(), false);
    const auto place = [&](std::size_t node, int component, const MatrixXd& row) {
      for (std::size_t i = 0; i < mesh.dofs.size(); ++i)
        if (mesh.dofs[i].point == node && mesh.dofs[i].component == component)
          T_.row(static_cast<Index>(i)) = row, placed[i] = true;
    };
    const std::size_t P = fe::find_point(mesh, parent);
    for (int c = 0; c < 6; ++c) place(P, c, x.row(c));
    const std::vector<std::size_t> at = coordinates(mesh, parent);
    for (std::size_t k = 0; k < shapes.size(); ++k) place(at[k], fe::kGeneralised, shapes[k]);
    for (std::size_t i = 0; i < mesh.dofs.size(); ++i)
      if (!placed[i]) T_(static_cast<Index>(i), next_++) = 1;
    a_.M += T_.transpose() * mesh.M * T_;
    a_.K += T_.transpose() * mesh.K * T_;
    const std::size_t C = fe::find_point(mesh, child);
    point = by_hand::tau(mesh.points[P].position - mesh.points[C].position) * x;
    for (int c = 0; c < 6; ++c)
      if (const Index row = find(mesh, C, c); row >= 0) point.row(c) = T_.row(row);
    line.clear();
    for (const std::size_t shape : coordinates(mesh, child))
      line.push_back(T_.row(find(mesh, shape, fe::kGeneralised)));
  }

  /// The rigid mass of a plate in its plane, about the point that moves by x.
  void add_in_plane(const fe::Mesh& mesh, const std::string& at, const MatrixXd& x) {
    const MatrixXd to = by_hand::tau(mesh.points[fe::find_point(mesh, at)].position);
    MatrixXd D = to.transpose() * *mesh.rigid * to;
    for (const Index c : {2, 3, 4}) D.row(c).setZero(), D.col(c).setZero();
    a_.M += x.transpose() * D * x;
  }

  void add_spring(const MatrixXd& stretch, double k, double c) {
    a_.K += k * stretch.transpose() * stretch;
    a_.D += c * stretch.transpose() * stretch;
  }

  MatrixXd own_row() { return MatrixXd::Identity(a_.M.rows(), a_.M.rows()).row(next_++); }
  by_hand::Structure& structure() { return a_; }

  MatrixXd point;              ///< 6 rows
  std::vector<MatrixXd> line;  ///< one row per shape

 private:
  static Index find(const fe::Mesh& mesh, std::size_t node, int component) {
    for (std::size_t i = 0; i < mesh.dofs.size(); ++i)
      if (mesh.dofs[i].point == node && mesh.dofs[i].component == component)
        return static_cast<Index>(i);
    return -1;
  }
  /// Points of the shapes of displacement of this line, in order.
  static std::vector<std::size_t> coordinates(const fe::Mesh& mesh, const std::string& name) {
    std::vector<std::size_t> result;
    for (const fe::MeshLine& l : mesh.lines)
      for (std::size_t k = 0; l.name == name && k < l.shapes.size(); ++k)
        if (l.shapes[k].component == 2) result.push_back(l.points[k]);
    return result;
  }

  by_hand::Structure a_;
  MatrixXd T_;
  Index next_ = 6;
};

by_hand::Structure satellite_by_hand(Lumping lumping, const Detail& detail) {
  const fe::Mesh yoke = beam_mesh(yoke_spec());
  const std::array<fe::Mesh, 2> panels = {panel_mesh(true, lumping, detail),
                                          panel_mesh(false, lumping, detail)};
  const Index shapes = detail.polynomials - 2;  // of displacement, of each line
  const Index count =
      yoke.M.rows() + (panels[0].M.rows() - 3) + 2 * (panels[1].M.rows() - 3 - shapes) + 2;
  Assembly all(count);
  by_hand::Structure& a = all.structure();
  const MatrixXd hub = MatrixXd::Identity(6, count);
  a.M.topLeftCorner(3, 3).diagonal().setConstant(450);
  a.M.block(3, 3, 3, 3).diagonal() << 160, 140, 180;
  a.B.topRows(6).setIdentity();
  a.C.leftCols(6).setIdentity();
  all.add(yoke, "P", "C", by_hand::tau(-array_at) * hub, {});
  for (int i = 0; i < kPanels; ++i) {
    const bool first = i == 0;
    MatrixXd x = all.point;
    if (!first) {
      const MatrixXd angle = all.own_row();  // of the hinge, about y
      x.row(4) += angle;
      all.add_spring(angle, hinge_k, hinge_c);
    }
    const fe::Mesh& mesh = panels[first ? 0 : 1];
    const std::string parent = first ? "yoke" : "inner";
    all.add_in_plane(mesh, parent, x);
    all.add(mesh, parent, "outer", x, first ? std::vector<MatrixXd>{} : all.line);
  }
  return a;
}

/// Small meshes with all of their modes.
double error_by_hand(Lumping lumping) {
  const Detail small{.elements = {2, 3}};
  const System system = compile(satellite(lumping, small));
  const by_hand::Structure right = satellite_by_hand(lumping, small);
  std::vector<by_hand::MatrixXcd> ours, expected;
  for (const by_hand::Complex s : by_hand::ray(0.01, 40, 12)) {
    ours.push_back(system.transfer(s));
    expected.push_back(by_hand::accel_transfer(right, s));
  }
  return by_hand::transfer_error(ours, expected, 3, 3);
}

}  // namespace

int main() {
  const Detail detail{.kept = 6};
  const InterfaceBracket bracket =
      interface_bracket([&](Lumping lumping) { return satellite(lumping, detail); });
  std::printf("the slowest modes, edges by %d polynomials\n%s", detail.polynomials,
              to_string(bracket).c_str());
  const double off =
      std::max(error_by_hand(Lumping::constrained), error_by_hand(Lumping::released));
  return by_hand::agrees("transfers of both, from the matrices of all meshes", off, 1e-9) ? 0 : 1;
}
