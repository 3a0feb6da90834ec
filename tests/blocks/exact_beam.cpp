// ExactBeam: its block against the boundary value problem in 100 digits, and scenes against roots,
// against themselves and against many elements.
#include <doctest/doctest.h>

#include <Eigen/LU>
#include <array>
#include <boost/multiprecision/cpp_complex.hpp>
#include <cmath>
#include <numbers>
#include <titop/blocks/exact_beam.hpp>
#include <titop/graph/closed_form.hpp>
#include <titop/titop.hpp>

#include "support/close.hpp"
#include "support/mistakes.hpp"
#include "support/notes.hpp"

using namespace titop;
using Eigen::Index;
using Eigen::MatrixXcd;
using titop_test::error_of;
using titop_test::says;
using Complex = std::complex<double>;

namespace {

using Real100 = boost::multiprecision::cpp_bin_float_100;
using Complex100 = boost::multiprecision::cpp_complex_100;

/// Solution of a small dense system, by Gauss with row pivots.
template <std::size_t N>
std::array<Complex100, N> gauss(std::array<std::array<Complex100, N + 1>, N> a) {
  for (std::size_t k = 0; k < N; ++k) {
    std::size_t best = k;
    for (std::size_t i = k; i < N; ++i)
      if (abs(a[i][k]) > abs(a[best][k])) best = i;
    std::swap(a[k], a[best]);
    for (std::size_t i = 0; i < N; ++i) {
      if (i == k) continue;
      const Complex100 by = a[i][k] / a[k][k];
      for (std::size_t j = k; j <= N; ++j) a[i][j] -= by * a[k][j];
    }
  }
  std::array<Complex100, N> x;
  for (std::size_t i = 0; i < N; ++i) x[i] = a[i][N] / a[i][i];
  return x;
}

/// One uniform body of stiffness EI, EA or GJ, inertia m per length: p m v + stiffness (d/dx)^order
/// v (+ for bending, - for rod and shaft) = -m gain (a0 + a1 x), clamped at 0.
struct Strip {
  Real100 stiffness, m, L;
  Complex100 s, p, gain, viscous;

  Strip(const ExactBeam& b, double stiffness_of, double m_of, Complex at)
      : stiffness(stiffness_of), m(m_of), L(b.length), s(at.real(), at.imag()) {
    viscous = 1 + Real100(b.damping.stiffness) * s;
    p = s * (s + Real100(b.damping.mass)) / viscous;
    gain = s * s / viscous;
  }

  /// v = c1 e^{kx} + ... + the particular solution -(gain / p) (a0 + a1 x). [a_end; f_root], by
  /// [f_end; a_root], for bending 4 x 4 with moment and slope.
  std::array<std::array<Complex100, 4>, 4> bending() const {
    const Complex100 k = sqrt(sqrt(Complex100(-p * m / stiffness)));
    const std::array<Complex100, 4> r = {k, -k, Complex100(0, 1) * k, Complex100(0, -1) * k};
    std::array<std::array<Complex100, 4>, 4> Y;
    for (std::size_t u = 0; u < 4; ++u) {
      const Complex100 force = u == 0 ? 1 : 0, moment = u == 1 ? 1 : 0, a0 = u == 2 ? 1 : 0,
                       a1 = u == 3 ? 1 : 0;
      // The relative deflection by accelerations: x_root = a / s^2.
      const Complex100 part0 = -gain / p * a0 / (s * s), part1 = -gain / p * a1 / (s * s);
      std::array<std::array<Complex100, 5>, 4> e;
      for (std::size_t i = 0; i < 4; ++i) {
        const Complex100 end = exp(Complex100(r[i] * L));
        e[0][i] = 1, e[1][i] = r[i];
        e[2][i] = r[i] * r[i] * end, e[3][i] = r[i] * r[i] * r[i] * end;
      }
      e[0][4] = -part0, e[1][4] = -part1;
      e[2][4] = moment / (stiffness * viscous), e[3][4] = -force / (stiffness * viscous);
      const auto c = gauss<4>(e);
      Complex100 v = part0 + part1 * L, slope = part1, sum = part0 * L + part1 * L * L / 2,
                 first = part0 * L * L / 2 + part1 * L * L * L / 3;
      for (std::size_t i = 0; i < 4; ++i) {
        const Complex100 end = exp(Complex100(r[i] * L));
        v += c[i] * end, slope += c[i] * r[i] * end;
        sum += c[i] * (end - 1) / r[i];
        first += c[i] * (L * end / r[i] - (end - 1) / (r[i] * r[i]));
      }
      const Complex100 s2 = s * s;
      Y[0][u] = a0 + a1 * L + s2 * v;
      Y[1][u] = a1 + s2 * slope;
      Y[2][u] = force - m * (a0 * L + a1 * L * L / 2 + s2 * sum);
      Y[3][u] = moment + force * L - m * (a0 * L * L / 2 + a1 * L * L * L / 3 + s2 * first);
    }
    return Y;
  }

  std::array<std::array<Complex100, 2>, 2> axial() const {
    const Complex100 k = sqrt(Complex100(p * m / stiffness));
    std::array<std::array<Complex100, 2>, 2> Y;
    for (std::size_t u = 0; u < 2; ++u) {
      const Complex100 force = u == 0 ? 1 : 0, a0 = u == 1 ? 1 : 0;
      const Complex100 part = -gain / p * a0 / (s * s), end = exp(Complex100(k * L));
      const auto c = gauss<2>({{{Complex100(1), Complex100(1), -part},
                                {k * end, -k / end, force / (stiffness * viscous)}}});
      const Complex100 s2 = s * s;
      Y[0][u] = a0 + s2 * (part + c[0] * end + c[1] / end);
      Y[1][u] =
          force - m * (a0 * L + s2 * (part * L + c[0] * (end - 1) / k - c[1] * (1 / end - 1) / k));
    }
    return Y;
  }
};

Complex rounded(const Complex100& z) {
  return {static_cast<double>(z.real()), static_cast<double>(z.imag())};
}

/// Y(s) of the whole block, in the sense of the design: u = [F_C; xdd_P], y = [xdd_C; F_P].
MatrixXcd by_hand(const ExactBeam& b, Complex s) {
  const double A = b.section.area, rho = b.material.rho, E = b.material.E;
  MatrixXcd Y = MatrixXcd::Zero(12, 12);
  const auto add_axial = [&](Index i, double stiffness, double m) {
    const auto y = Strip(b, stiffness, m, s).axial();
    const std::array<Index, 2> at = {i, 6 + i};
    for (std::size_t r = 0; r < 2; ++r)
      for (std::size_t c = 0; c < 2; ++c) Y(at[r], at[c]) = rounded(y[r][c]);
  };
  const auto add_bending = [&](Index w, Index angle, double sign, double EI) {
    const auto y = Strip(b, EI, rho * A, s).bending();
    const std::array<Index, 4> at = {w, angle, 6 + w, 6 + angle};
    for (std::size_t r = 0; r < 4; ++r)
      for (std::size_t c = 0; c < 4; ++c)
        Y(at[r], at[c]) = (r % 2 == c % 2 ? 1 : sign) * rounded(y[r][c]);
  };
  add_axial(0, E * A, rho * A);
  add_axial(3, *b.material.G * b.section.J, rho * *b.section.I_x);
  add_bending(1, 5, 1, E * b.section.I_z);
  add_bending(2, 4, -1, E * b.section.I_y);
  return Y;
}

/// Numbers that are exact in double, so that products of three are, too: beta L is sqrt(omega).
ExactBeam unit_beam() {
  return {.length = 1,
          .section = {.area = 1, .I_y = 1, .I_z = 0.0625, .J = 0.25, .I_x = 2},
          .material = {.E = 1, .G = 0.5, .rho = 1}};
}

ExactBeam boom(const fe::Rayleigh& damping = {}) {
  return {.length = 3,
          .section = {.area = 1e-3, .I_y = 4e-7, .I_z = 2.5e-7, .J = 5e-7, .I_x = 6.5e-7},
          .material = {.E = 70e9, .G = 27e9, .rho = 2700},
          .damping = damping};
}

/// Largest difference of an entry over its own size in `exact`.
double entry_error(const MatrixXcd& Y, const MatrixXcd& exact) {
  double worst = 0;
  for (Index i = 0; i < Y.size(); ++i) {
    const double off = std::abs(Y(i) - exact(i));
    if (off > 0) worst = std::max(worst, off / std::abs(exact(i)));
  }
  return worst;
}

MatrixXcd block_at(const ExactBeam& b, Complex s) { return as_block(b)->response(s, {}).Y; }

/// omega of the softer plane at this beta L.
double omega_at(const ExactBeam& b, double beta_L) {
  const double I = std::min(b.section.I_y, b.section.I_z);
  return beta_L * beta_L * std::sqrt(b.material.E * I / (b.material.rho * b.section.area)) /
         (b.length * b.length);
}

}  // namespace

TEST_CASE("every entry against the boundary value problem in 100 digits, at any s") {
  const std::array<fe::Rayleigh, 4> laws = {fe::Rayleigh{}, fe::Rayleigh{.mass = 0.7},
                                            fe::Rayleigh{.stiffness = 3e-4},
                                            fe::Rayleigh{.mass = 2, .stiffness = 1e-3}};
  for (const fe::Rayleigh& law : laws)
    for (const double beta_L : {1e-3, 0.05, 0.6, 0.99, 1.01, 1.9, 3.3, 8.1, 21.0, 60.0})
      for (const double angle : {0.0, 0.3, 0.8, 1.3, 1.55, 1.8}) {
        const ExactBeam b = boom(law);
        const double w = omega_at(b, beta_L);
        const Complex s = std::polar(w, angle);
        INFO(law.mass << ' ' << law.stiffness << ' ' << beta_L << ' ' << angle);
        // The phases of circular functions have the rounding of beta L.
        CHECK(entry_error(block_at(b, s), by_hand(b, s)) <= 1e-14 * (20 + 5 * beta_L));
      }
}

TEST_CASE("at s = 0 the beam is rigid; at -mass, beside it and far up it is finite") {
  const ExactBeam b = boom({.mass = 0.5, .stiffness = 1e-4});
  const MatrixXcd rest = block_at(b, 0);
  const ModalData beam = modal_data(with_elements(b, 4));
  CHECK(rest.topLeftCorner(6, 6).cwiseAbs().maxCoeff() == 0);
  CHECK((rest.topRightCorner(6, 6) - tau(Vector3d(-b.length, 0, 0))).cwiseAbs().maxCoeff() <=
        1e-15 * b.length);
  CHECK((rest.bottomRightCorner(6, 6) + beam.D_P).cwiseAbs().maxCoeff() <=
        1e-13 * beam.D_P.cwiseAbs().maxCoeff());
  const MatrixXcd removable = block_at(b, -0.5);
  CHECK((removable - block_at(b, Complex(-0.5, 1e-9))).cwiseAbs().maxCoeff() <=
        1e-8 * removable.cwiseAbs().maxCoeff());
  for (const double w : {1e6, 1e9, 1e12, 1e30})
    CHECK(block_at(boom(), Complex(0.01 * w, w)).allFinite());
  CHECK(says(error_of([&] { block_at(b, -1e4); }), Code::singular, {"ExactBeam"}));
  CHECK(says(error_of([&] { block_at(b, 1e200); }), Code::not_finite, {"1e+200"}));
}

TEST_CASE("16, 32 and 50 digits are one number") {
  const ExactBeam b = boom({.mass = 0.2, .stiffness = 2e-5});
  const BlockPtr block = as_block(b);
  const ClosedForm* closed = closed_form_of(*block);
  REQUIRE(closed != nullptr);
  for (const double beta_L : {0.3, 4.0, 30.0}) {
    const Complex s = std::polar(omega_at(b, beta_L), 1.5);
    const auto fine = closed->closed_form(s, {}, 4);
    REQUIRE(fine.size() == 4);
    CHECK(entry_error(closed->closed_form(s, {}, 1)[0], fine[0]) <= 1e-14 * (20 + 5 * beta_L));
    CHECK(closed->closed_form(s, {}, 2)[1] == fine[1]);
    CHECK(entry_error(fine[0], by_hand(b, s)) <= 3e-16);
    for (std::size_t k = 1; k < fine.size(); ++k)
      CHECK((fine[k].cwiseAbs().array() <= 1e-15 * fine[k - 1].cwiseAbs().array()).all());
  }
}

namespace {

const Vector3d kX(1, 0, 0), kY(0, 1, 0), kZ(0, 0, 1);
constexpr Index kBending = 2;  ///< along z, with the section's I_y

/// The pole of this entry as beta L of unit_beam(), near `root`: 1 / H changes its sign there.
double pole_near(double root, const Diagram& d, Index row, Index column) {
  const System system = compile(d);
  const auto inverse = [&](double x) {
    return 1 / system.transfer({0, x * x})(row, column).real();
  };
  double low = root - 0.05, high = root + 0.05;
  const bool rises = inverse(high) > 0;
  REQUIRE(inverse(low) * inverse(high) < 0);
  try {
    for (int i = 0; i < 50; ++i) {
      const double middle = (low + high) / 2;
      ((inverse(middle) > 0) == rises ? high : low) = middle;
    }
  } catch (const Error& error) {  // the pole to the last place
    REQUIRE(error.has(Code::singular));
  }
  return (low + high) / 2;
}

void drive_end(Diagram& d, BodyHandle& b) {
  b.child.force = d.input("F", 6);
  d.output("a", 6) = b.child.accel;
}

Diagram clamped(const ExactBeam& beam) {
  Diagram d{"clamped"};
  auto b = d.add("b", beam);
  b.parent.accel = 0;
  drive_end(d, b);
  return d;
}

Diagram clamped(const Beam& beam) {
  Diagram d{"clamped"};
  auto b = d.add("b", FlexibleBody{beam});
  b.parent.accel = 0;
  b.child.force = d.input("F", 6);
  d.output("a", 6) = b.child.accel;
  return d;
}

Diagram free_free() {
  Diagram d{"free"};
  auto b = d.add("b", unit_beam());
  b.parent.force = 0;
  drive_end(d, b);
  return d;
}

/// P turns about y alone.
void pin_root(BodyHandle& b) {
  b.parent.accel.linear = 0;
  b.parent.accel.angular.along(kX) = 0;
  b.parent.accel.angular.along(kZ) = 0;
}

Diagram pinned_free() {
  Diagram d{"pinned, free"};
  auto b = d.add("b", unit_beam());
  pin_root(b);
  b.parent.force.angular.along(kY) = 0;
  drive_end(d, b);
  return d;
}

Diagram pinned_pinned() {
  Diagram d{"pinned"};
  auto b = d.add("b", unit_beam());
  pin_root(b);
  b.parent.force.angular.along(kY) = -d.input("T");
  b.child.accel.linear.along(kZ) = 0;
  d.output("turn") = b.parent.accel.angular.along(kY);
  return d;
}

void check_roots(const Diagram& d, Index entry, const std::vector<double>& roots) {
  for (const double root : roots) {
    INFO(d.name() << ' ' << root);
    CHECK(std::abs(pole_near(root, d, entry, entry) - root) <= 1e-13 * root);
  }
}

}  // namespace

TEST_CASE("poles: the roots beta L of the textbooks") {
  check_roots(clamped(unit_beam()), kBending,
              {1.875104068711961, 4.694091132974175, 7.854757438237613, 10.99554073487547,
               14.13716839104647});
  check_roots(free_free(), kBending,
              {4.730040744862704, 7.853204624095838, 10.99560783800167, 14.13716549125746,
               17.27875965739948});
  check_roots(pinned_free(), kBending,
              {3.926602312047919, 7.068582745628732, 10.21017612281303, 13.35176877775409,
               16.49336143134641});
  using std::numbers::pi;
  check_roots(pinned_pinned(), 0, {pi, 2 * pi, 3 * pi, 10 * pi});
}

namespace {

/// A free chain of equal parts, driven and seen at both ends.
Diagram chain(ExactBeam beam, int parts) {
  Diagram d{"chain"};
  beam.length /= parts;
  std::vector<BodyHandle> all;
  for (int i = 0; i < parts; ++i) {
    all.push_back(d.add("b" + std::to_string(i + 1), beam));
    if (i > 0) mount(all[static_cast<std::size_t>(i)], all[static_cast<std::size_t>(i - 1)].child);
  }
  all.front().parent.force = -d.input("F_P", 6);
  all.back().child.force = d.input("F_C", 6);
  d.output("a_P", 6) = all.front().parent.accel;
  d.output("a_C", 6) = all.back().child.accel;
  return d;
}

}  // namespace

TEST_CASE("two halves, and five fifths, are the whole at any frequency") {
  for (const fe::Rayleigh& law : {fe::Rayleigh{}, fe::Rayleigh{.stiffness = 1e-5}}) {
    const ExactBeam b = boom(law);
    const System whole = compile(chain(b, 1));
    for (const int parts : {2, 5}) {
      const System cut = compile(chain(b, parts));
      for (const double beta_L : {1e-3, 0.1, 0.7, 1.3, 3.0, 11.0, 37.0, 110.0})
        for (const double angle : {0.0, 0.9, 1.54}) {
          const Complex s = std::polar(omega_at(b, beta_L), angle);
          INFO(parts << ' ' << beta_L << ' ' << angle);
          CHECK(titop_test::matrix_error(cut.transfer(s), whole.transfer(s)) <= 1e-12);
        }
    }
  }
}

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

namespace {

/// An arm of two exact links and a finite one, with a hinge and a spring, on a free hub.
Diagram arm() {
  Diagram d{"arm"};
  auto hub = d.add("hub", RigidBody{.mass = 20,
                                    .inertia = Vector3d(2, 3, 4).asDiagonal(),
                                    .children = {{"arm", {0.3, 0.1, 0}}}});
  auto upper = d.add("upper", boom({.mass = 0.1, .stiffness = 1e-5}));
  auto lower = d.add("lower", boom());
  auto hand = d.add("hand", FlexibleBody{with_elements(boom(), 4)});
  hub.parent.force = -d.input("F", 6);
  mount(upper, hub.child("arm"), Rotation::about(kZ, 0.4));
  auto elbow = hinge(d, "elbow", lower, upper.child, Rotation::about(kZ, -0.9), kZ);
  elbow.torque = -40 * elbow.angle - 0.3 * elbow.rate + d.input("T");
  mount(hand, lower.child, Rotation::about(kX, 0.2));
  d.output("a", 6) = hub.parent.accel;
  d.output("hand", 6) = hand.child.accel;
  d.output("angle") = elbow.angle;
  return d;
}

}  // namespace

TEST_CASE("a scene's transfers in every precision, against all its equations at once") {
  const Diagram d = arm();
  const System system = compile(d);
  for (const Complex s : {Complex(0.3, 0), Complex(0.02, 2), Complex(1, 90), Complex(0, 3000)}) {
    const MatrixXcd exact = system.transfer(s, Precision::digits50);
    CHECK(titop_test::matrix_error(system.transfer(s), exact) <= 1e-12);
    CHECK(titop_test::matrix_error(system.transfer(s, Precision::refined), exact) <= 1e-12);
    CHECK(titop_test::matrix_error(system.transfer(s, Precision::twofold), exact) <= 1e-12);
    CHECK(titop_test::matrix_error(transfer(d.graph(), s), exact) <= 1e-9);
  }
  CHECK(system.certificate().residual >= 0);
  CHECK(system.certificate().residual <= 1e-12);
  CHECK(system.certificate().apply_against_transfer < 0);
  CHECK(titop_test::noted(system, Note::Kind::warning, "check", {"upper"}));
  CHECK(titop_test::noted(system, Note::Kind::warning, "check", {"lower"}));
}

TEST_CASE("what needs a state space is refused, and names the blocks") {
  const Diagram d = arm();
  const System system = compile(d);
  const auto refused = [](auto f) {
    const Error error = error_of(f);
    return says(error, Code::not_rational, {"upper", "with_elements"}) &&
           says(error, Code::not_rational, {"lower", "FlexibleBody"});
  };
  CHECK(refused([&] { system.state_space(); }));
  CHECK(refused([&] { system.poles(); }));
  CHECK(refused([&] { system.descriptor(); }));
  CHECK(refused([&] { system.order_verdict(); }));
  CHECK(refused([&] { system.dense_certificate(); }));
  CHECK(refused([&] {
    StateSpace model, *to = &model;
    system.write(*to);
  }));
  CHECK(refused(
      [&] { system.apply(Eigen::VectorXd::Zero(system.order()), Eigen::VectorXd::Zero(7)); }));
  CHECK(refused([&] { certify(system); }));
  CHECK(refused([&] { lft(system, {}); }));
  CHECK(refused([&] {
    simulate(system, Excitation::step(Eigen::VectorXd::Ones(7)), {.step = 0.1, .until = 1});
  }));
  CHECK(refused([&] { compile(d, Scene{.band_hz = {0.1, 10}}); }));
  CHECK(says(error_of([&] { model_of(as_block(boom())); }), Code::not_rational, {"ExactBeam"}));
}

TEST_CASE("data that make no beam are refused") {
  const auto refused = [](const ExactBeam& b, std::string_view name) {
    return says(error_of([&] { as_block(b); }), Code::bad_value, {name});
  };
  ExactBeam b = boom();
  b.length = -1;
  CHECK(refused(b, "length"));
  CHECK(refused(boom({.mass = -1}), "damping.mass"));
  CHECK(refused(boom({.stiffness = NAN}), "damping.stiffness"));
}

namespace {

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

TEST_CASE("a beam fixed at both ends: its forces, as of the boundary value problem") {
  Diagram d{"fixed"};
  auto b = d.add("b", boom());
  b.parent.accel = d.input("a", 6);
  b.child.accel = 0;
  d.output("F", 6) = b.child.force;
  const Complex s(1, 60);
  const MatrixXcd Y = by_hand(boom(), s);
  const MatrixXcd expected = -Y.topLeftCorner(6, 6).inverse() * Y.topRightCorner(6, 6);
  CHECK(titop_test::matrix_error(compile(d).transfer(s), expected) <= 1e-12);
}

TEST_CASE("a diagram file has it, to the last bit") {
  const std::string text = diagram_json(arm());
  const Diagram again = parse_diagram(text);
  CHECK(diagram_json(again) == text);
  const Complex s(0.1, 30);
  CHECK(compile(again).transfer(s) == compile(arm()).transfer(s));
}
