#include <doctest/doctest.h>

#include <Eigen/Eigenvalues>
#include <Eigen/SparseCholesky>
#include <algorithm>
#include <boost/multiprecision/cpp_bin_float.hpp>
#include <boost/multiprecision/eigen.hpp>
#include <cmath>
#include <complex>
#include <string>
#include <titop/titop.hpp>
#include <vector>

/// Poles of closed chains, whose coordinates share springs and masses: by the potential energy they
/// are those of a symmetric problem. Against M and K of the mesh with both ends held.

using namespace titop;
using Eigen::Index;
using Eigen::MatrixXd;

namespace {

Beam beam(int elements = 6) {
  return {.length = 2,
          .section = rectangle(0.06, 0.04),
          .material = {.E = 70e9, .nu = 0.33, .rho = 2700},
          .elements = elements};
}

System held_twice(int elements = 6) {
  Diagram d{"held twice"};
  auto rod = d.add("rod", FlexibleBody(beam(elements)));
  ground(rod);
  ground(rod.child);
  d.output("base", 6) = rod.parent.force;
  return compile(d, {.minimize_up_to = 0});
}

/// All coordinates but those of the two ends.
std::vector<Index> between_ends(const fe::Mesh& mesh) {
  std::vector<Index> free;
  for (std::size_t i = 0; i < mesh.dofs.size(); ++i)
    if (mesh.dofs[i].point != 0 && mesh.dofs[i].point + 1 != mesh.points.size())
      free.push_back(static_cast<Index>(i));
  return free;
}

Eigen::VectorXd frequencies() {
  const fe::Mesh mesh = beam_mesh(beam());
  const std::vector<Index> free = between_ends(mesh);
  const MatrixXd K = mesh.K(free, free), M = mesh.M(free, free);
  return Eigen::GeneralizedSelfAdjointEigenSolver<MatrixXd>(K, M, Eigen::EigenvaluesOnly)
      .eigenvalues()
      .cwiseSqrt();
}

/// The mesh in 50 digits.
class Exact {
 public:
  using Real = boost::multiprecision::number<boost::multiprecision::cpp_bin_float<50>,
                                             boost::multiprecision::et_off>;
  explicit Exact(const fe::Mesh& mesh) {
    const std::vector<Index> free = between_ends(mesh);
    K_ = MatrixXd(mesh.K(free, free)).cast<Real>().sparseView();
    M_ = MatrixXd(mesh.M(free, free)).cast<Real>().sparseView();
  }
  /// Frequencies below omega: negative pivots of K - omega^2 M [Sylvester's law of inertia].
  Index below(const Real& omega) const {
    const Sparse dynamic = K_ - omega * omega * M_;
    const Eigen::SimplicialLDLT<Sparse, Eigen::Lower, Eigen::NaturalOrdering<int>> ldl(dynamic);
    const auto pivots = ldl.vectorD();
    return std::count_if(pivots.begin(), pivots.end(), [](const Real& d) { return d < 0; });
  }

 private:
  using Sparse = Eigen::SparseMatrix<Real>;
  Sparse K_, M_;
};

/// Two beams in a row, held at both ends.
System two_in_a_row() {
  Diagram d{"two in a row"};
  Beam second = beam();
  second.length = 1.3;
  auto left = d.add("left", FlexibleBody(beam())), right = d.add("right", FlexibleBody(second));
  ground(left);
  mount(right, left.child, Rotation());
  ground(right.child);
  d.output("a", 6) = right.parent.accel;
  return compile(d, {.minimize_up_to = 0});
}

/// The share of the states of `block` in the mode of A at j omega: |v_i w_i|, of total 1.
double share(const StateSpace& m, const std::string& block, double omega) {
  const Eigen::EigenSolver<MatrixXd> e(m.A);
  const Eigen::MatrixXcd V = e.eigenvectors(), W = V.inverse();
  Index k = 0;
  (e.eigenvalues().array() - std::complex<double>(0, omega)).abs().minCoeff(&k);
  double sum = 0, all = 0;
  for (Index i = 0; i < m.A.rows(); ++i) {
    const double part = std::abs(V(i, k) * W(k, i));
    all += part;
    if (m.states[static_cast<std::size_t>(i)].rfind(block + ".", 0) == 0) sum += part;
  }
  return sum / all;
}

}  // namespace

TEST_CASE("poles: shares of two bodies in a closed chain are those of the eigenvectors of A") {
  const System system = two_in_a_row();
  int compared = 0;
  for (const Pole& p : system.poles())
    for (const auto& [block, part] : p.blocks)
      if (p.omega < 3000 && part < 1) {
        CAPTURE(p.omega);
        CHECK(std::abs(part - share(system.state_space(), block, p.omega)) <= 1e-5);
        ++compared;
      }
  CHECK(compared >= 4);
}

TEST_CASE("poles: a beam held at both ends is undamped, at the frequencies of its mesh") {
  const Eigen::VectorXd exact = frequencies();
  const std::vector<Pole> found = held_twice().poles();
  REQUIRE(static_cast<Index>(found.size()) == exact.size());
  for (std::size_t i = 0; i < found.size(); ++i) {
    CHECK(found[i].s.real() == 0);
    CHECK(found[i].pair);
    REQUIRE(found[i].blocks.size() == 1);
    CHECK(std::abs(found[i].blocks.front().second - 1) <= 1e-9);
    CHECK(std::abs(found[i].omega / exact(static_cast<Index>(i)) - 1) <= 1e-9);
  }
}

TEST_CASE("poles: of more than 400 pairs the slow ones have as many digits as the fast ones") {
  const Exact exact(beam_mesh(beam(80)));
  const std::vector<Pole> found = held_twice(80).poles();
  REQUIRE(found.size() == 474);
  for (std::size_t i = 0; i < found.size(); i += i < 20 ? 1 : 20) {
    CAPTURE(i);
    const Exact::Real omega = found[i].omega;
    CHECK(exact.below(omega * (1 - Exact::Real(1e-9))) <= static_cast<Index>(i));
    CHECK(exact.below(omega * (1 + Exact::Real(1e-9))) > static_cast<Index>(i));
  }
}

TEST_CASE("poles of a model without names, and of one that is not square") {
  StateSpace m;
  m.A = (Eigen::Matrix2d() << 0, 1, -4, 0).finished();
  const std::vector<Pole> all = poles(m);
  REQUIRE(all.size() == 1);
  CHECK(std::abs(all.front().s - std::complex<double>(0, 2)) <= 1e-15);
  m.A = Eigen::MatrixXd::Zero(2, 1);
  CHECK_THROWS_AS(poles(m), Error);
}
