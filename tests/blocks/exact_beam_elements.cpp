// Beams of finite elements converge to ExactBeam.
#include <doctest/doctest.h>

#include <numbers>
#include <vector>

#include "blocks/exact_beams.hpp"
#include "support/close.hpp"

using namespace exact_beams;
using namespace titop;
using Eigen::MatrixXcd;

namespace {

Diagram clamped(const Beam& beam) {
  Diagram d{"clamped"};
  auto b = d.add("b", FlexibleBody{beam});
  b.parent.accel = 0;
  b.child.force = d.input("F", 6);
  d.output("a", 6) = b.child.accel;
  return d;
}

/// A frame: two posts on the ground, a beam across; the posts are finite or exact.
template <class Post>
Diagram frame(const Post& post, double span) {
  ExactBeam beam = boom();
  beam.length = span;
  Diagram d{"frame"};
  auto left = d.add("left", post), right = d.add("right", post);
  auto across = d.add("across", beam);
  const Rotation upright = Rotation::about(kY, -std::numbers::pi / 2);
  ground(left);
  ground(right);
  mount(across, left.child("C"), upright.inverse());
  across.child.accel = upright * right.child("C").accel;
  right.child("C").force += -(upright.inverse() * across.child.force);
  left.child("C").force.linear += d.input("F", 3);
  d.output("a", 3) = left.child("C").accel.linear;
  return d;
}

}  // namespace

TEST_CASE("Beam converges to it: h^4 in bending, h^2 in the rod and the shaft, also if damped") {
  for (const fe::Rayleigh& law :
       {fe::Rayleigh{}, fe::Rayleigh{.mass = 3}, fe::Rayleigh{.mass = 1, .stiffness = 1e-4}}) {
    const ExactBeam b = boom(law);
    const Complex bending = std::polar(omega_at(b, 4), 1.5), rod = std::polar(5000.0, 1.5);
    const MatrixXcd slow = compile(clamped(b)).transfer(bending),
                    fast = compile(clamped(b)).transfer(rod);
    std::vector<double> of_bending, of_rod, of_shaft;
    for (const int n : {8, 16, 32}) {
      const System finite = compile(clamped(with_elements(b, n)));
      const MatrixXcd H = finite.transfer(bending), R = finite.transfer(rod);
      of_bending.push_back(std::abs(H(2, 2) / slow(2, 2) - 1.0));
      of_rod.push_back(std::abs(R(0, 0) / fast(0, 0) - 1.0));
      of_shaft.push_back(std::abs(R(3, 3) / fast(3, 3) - 1.0));
    }
    for (std::size_t k = 1; k < 3; ++k) {
      CHECK(std::abs(std::log2(of_bending[k - 1] / of_bending[k]) - 4) <= 0.2);
      CHECK(std::abs(std::log2(of_rod[k - 1] / of_rod[k]) - 2) <= 0.1);
      CHECK(std::abs(std::log2(of_shaft[k - 1] / of_shaft[k]) - 2) <= 0.1);
    }
    CHECK(of_bending.back() <= 1e-6);
  }
}

TEST_CASE("closed chains: a frame of exact beams against one with posts of many elements") {
  const System exact = compile(frame(boom(), 2)),
               finite = compile(frame(FlexibleBody{with_elements(boom(), 40)}, 2));
  for (const double w : {20.0, 90.0, 250.0}) {
    const Complex s(0.02 * w, w);
    CHECK(titop_test::matrix_error(finite.transfer(s), exact.transfer(s)) <= 1e-4);
    const MatrixXcd G = exact.transfer(s);
    CHECK(std::abs(G(0, 1) - G(1, 0)) <= 1e-12 * G.cwiseAbs().maxCoeff());  // reciprocity
  }
}
