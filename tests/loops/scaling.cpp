#include <doctest/doctest.h>

#include <complex>
#include <titop/graph/linalg/eigen.hpp>
#include <titop/graph/linalg/index.hpp>
#include <titop/titop.hpp>

#include "support/rng.hpp"

/// The constraints of a closed chain depend neither on one tiny lever nor on its size: orders,
/// warnings and transfers against the same bodies and hinges in coordinates of all bodies.

using namespace titop;
using Eigen::Index;
using Eigen::Matrix3d;
using Eigen::MatrixXcd;
using Eigen::MatrixXd;
using Eigen::Vector3d;
using titop_test::Rng;

namespace {

using titop::linalg::at;

/// Hinges in a ring, links between them, the first and the last hinge on the ground. A force acts
/// on the link in the middle, the first one's acceleration is read.
struct Ring {
  double size = 1;
  std::vector<Vector3d> points = {}, axes = {};  ///< of the hinges; the last one closes
  std::vector<Matrix3d> frames = {};             ///< of the links

  Index links() const { return std::ssize(points) - 1; }
  double mass() const { return 2; }
  Matrix3d inertia() const {
    return mass() * size * size / 12 * Matrix3d(Vector3d(1, 1.2, 0.9).asDiagonal());
  }
  double stiffness() const { return 30 * size * size; }
  Vector3d next(Index i) const {
    return frames[at(i)].transpose() * (points[at(i + 1)] - points[at(i)]);
  }
  Vector3d centre(Index i) const { return next(i) / 2 + size * Vector3d(0.1, 0.2, 0.1); }
  Vector3d seen() const { return size * Vector3d(0.3, 0.2, 0.1); }
  Index driven() const { return links() / 2; }
};

Diagram diagram(const Ring& ring) {
  Diagram d{"ring"};
  auto base =
      d.add("base",
            RigidBody{.children = {{"first", ring.points.front()}, {"last", ring.points.back()}}});
  ground(base);
  std::vector<BodyHandle> links;
  for (Index i = 0; i < ring.links(); ++i) {
    const Matrix3d& R = ring.frames[at(i)];
    const Matrix3d T = i == 0 ? R : Matrix3d(ring.frames[at(i - 1)].transpose() * R);
    links.push_back(d.add("link" + std::to_string(i),
                          RigidBody{.mass = ring.mass(),
                                    .inertia = ring.inertia(),
                                    .PA = ring.centre(i),
                                    .children = {{"next", ring.next(i)}, {"seen", ring.seen()}}}));
    auto h = hinge(d, "hinge" + std::to_string(i), links.back(),
                   i == 0 ? base.child("first") : links[at(i - 1)].child("next"),
                   Rotation::matrix(T), R.transpose() * ring.axes[at(i)]);
    h.torque = (i == 0 ? ring.stiffness() : 0.0) * h.angle;
  }
  auto last = d.add("last", Hinge{ring.axes.back()});
  mount(last, base.child("last"));
  weld(links.back().child("next"), last.child, Rotation::matrix(ring.frames.back()));
  last.torque = 0;
  links[at(ring.driven())].child("seen").force.linear += d.input("F", 3);
  d.output("a", 3) = links[0].child("seen").accel.linear;
  return d;
}

/// In velocity and size * rate of all links, in the frame of the ground.
struct Maximal {
  const Ring& ring;

  Index width() const { return 6 * ring.links(); }
  static Matrix3d cross(const Vector3d& v) {
    return Matrix3d{{0, -v.z(), v.y()}, {v.z(), 0, -v.x()}, {-v.y(), v.x(), 0}};
  }
  /// Motion of a point of a link (-1: the ground): translations and rotations.
  MatrixXd motion(Index link, const Vector3d& point) const {
    MatrixXd result = MatrixXd::Zero(6, width());
    if (link < 0) return result;
    result.block<3, 3>(0, 6 * link).setIdentity();
    result.block<3, 3>(0, 6 * link + 3) = -cross(point - ring.points[at(link)]) / ring.size;
    result.block<3, 3>(3, 6 * link + 3) = Matrix3d::Identity() / ring.size;
    return result;
  }
  MatrixXd motion_of(Index link, const Vector3d& own) const {
    return motion(link, ring.points[at(link)] + ring.frames[at(link)] * own);
  }
  MatrixXd null_space() const {
    MatrixXd rows(0, width());
    for (Index j = 0; j <= ring.links(); ++j) {
      const MatrixXd across = motion(j == ring.links() ? -1 : j, ring.points[at(j)]) -
                              motion(j - 1, ring.points[at(j)]);
      rows.conservativeResize(rows.rows() + 6, Eigen::NoChange);
      rows.bottomRows(6).topRows(3) = across.topRows(3);
      rows.bottomRows(3) = ring.size * cross(ring.axes[at(j)]) * across.bottomRows(3);
    }
    const Eigen::JacobiSVD<MatrixXd> svd(rows, Eigen::ComputeFullV);
    return svd.matrixV().rightCols(width() - (svd.singularValues().array() > 1e-9).count());
  }
  MatrixXcd transfer(const MatrixXd& N, std::complex<double> s) const {
    MatrixXd M = MatrixXd::Zero(width(), width());
    for (Index i = 0; i < ring.links(); ++i) {
      const Matrix3d& R = ring.frames[at(i)];
      const MatrixXd J = motion_of(i, ring.centre(i));
      M += ring.mass() * J.topRows(3).transpose() * J.topRows(3) +
           J.bottomRows(3).transpose() * R * ring.inertia() * R.transpose() * J.bottomRows(3);
    }
    const MatrixXd angle = ring.axes[0].transpose() * motion(0, ring.points[0]).bottomRows(3);
    const MatrixXd K = ring.stiffness() * angle.transpose() * angle;
    const auto seen = [&](Index i) {
      return MatrixXd(ring.frames[at(i)].transpose() * motion_of(i, ring.seen()).topRows(3) * N);
    };
    const MatrixXcd H = s * s * (N.transpose() * M * N) + N.transpose() * K * N;
    return s * s * seen(0) * H.fullPivLu().solve(MatrixXcd(seen(ring.driven()).transpose()));
  }
};

/// Returns the number of notes.
std::size_t check(const Ring& ring, int order) {
  const Maximal maximal{ring};
  const MatrixXd N = maximal.null_space();
  REQUIRE(2 * N.cols() == order);
  const System system = compile(diagram(ring));
  CHECK(system.order() == order);
  for (const Note& note : system.notes()) {
    CAPTURE(note.text);
    CHECK(note.kind != Note::Kind::warning);
  }
  const std::complex<double> s(0.3, 3);
  const MatrixXcd exact = maximal.transfer(N, s);
  CHECK((system.transfer(s) - exact).cwiseAbs().maxCoeff() <= 1e-9 * exact.cwiseAbs().maxCoeff());
  return system.notes().size();
}

}  // namespace

TEST_CASE(
    "seven hinges in space, one of them close to the point that closes: how close is nothing") {
  for (std::uint64_t seed = 1; seed <= 5; ++seed)
    for (const double lever : {1e-1, 1e-3, 1e-5, 1e-8, 1e-10, 1e-12}) {
      CAPTURE(seed);
      CAPTURE(lever);
      Rng rng(seed);
      Ring ring;
      for (int i = 0; i < 7; ++i) {
        ring.points.push_back(rng.matrix(3, 1));
        ring.axes.push_back(rng.matrix(3, 1).normalized());
        if (i < 6) ring.frames.push_back(rng.rotation());
      }
      ring.points[5] = ring.points[6] + lever * Vector3d(0.6, 0.8, 0);
      check(ring, 2);
    }
}

TEST_CASE("a four-bar in turned frames, of a tenth of a millimetre to 1e9 metres: the same") {
  for (std::uint64_t seed = 1; seed <= 5; ++seed) {
    std::size_t notes = 0;
    for (const double size : {1.0, 1e-2, 1e-3, 1e-4, 1e5, 1e7, 1e9}) {
      CAPTURE(seed);
      CAPTURE(size);
      Rng rng(seed);
      Ring ring{.size = size};
      for (const Vector3d& p : {Vector3d(0, 0, 0), Vector3d(0.3, 0.8, 0.1),
                                Vector3d(1.1, 0.9, -0.2), Vector3d(1, 0, 0.3)})
        ring.points.push_back(size * p), ring.axes.push_back({0, 0, 1});
      for (int i = 0; i < 3; ++i) ring.frames.push_back(rng.rotation());
      const std::size_t found = check(ring, 2);
      if (size == 1) notes = found;
      CHECK(found == notes);
    }
  }
}
