#include <Eigen/Eigenvalues>
#include <Eigen/LU>

#include "scenes.hpp"
#include "support/close.hpp"
#include "support/mistakes.hpp"

/// Each pair against its own peak, down to where rounding ends: masses on springs, with M, D and K
/// written out in long double.
using namespace titop;
using namespace titop_test;
using Eigen::Index;
using Eigen::MatrixXcd;

namespace {

/// A reading of a mass: coefficients of its position, rate and acceleration.
struct Read {
  std::size_t mass = 0;
  double x = 0, v = 0, a = 0;
};

/// Masses on undamped springs, each on the one that `on` names (-1: the clamp).
struct Masses {
  std::vector<double> m, k;
  std::vector<int> on;
  std::vector<std::size_t> driven;
  std::vector<Read> read;

  Diagram diagram() const {
    Diagram d{"masses"};
    std::vector<SpringMass::Handle> z;
    for (std::size_t i = 0; i < m.size(); ++i) {
      z.push_back(d.add("z" + std::to_string(i + 1), SpringMass{.mass = m[i], .stiffness = k[i]}));
      if (on[i] < 0)
        z[i].parent.accel = 0;
      else
        mount(z[i], z[static_cast<std::size_t>(on[i])].child);
    }
    for (std::size_t j = 0; j < driven.size(); ++j)
      z[driven[j]].child.force += d.input("u" + std::to_string(j + 1));
    for (std::size_t i = 0; i < read.size(); ++i) {
      const Read& r = read[i];
      const auto& at = z[r.mass].child;
      auto y = d.output("y" + std::to_string(i + 1));
      if (r.a != 0)
        y = r.a * at.accel;
      else if (r.v != 0)
        y = r.x * at.position + r.v * at.rate;
      else
        y = r.x * at.position;
    }
    return d;
  }

  Truth truth() const {
    const auto n = static_cast<Index>(m.size());
    MatrixXl M = MatrixXl::Zero(n, n), K = M;
    for (Index i = 0; i < n; ++i) {
      const auto c = static_cast<std::size_t>(i);
      M(i, i) = m[c];
      K(i, i) += k[c];
      if (const Index p = on[c]; p >= 0) K(p, p) += k[c], K(i, p) -= k[c], K(p, i) -= k[c];
    }
    const Eigen::GeneralizedSelfAdjointEigenSolver<MatrixXl> modes(K, M, Eigen::EigenvaluesOnly);
    Truth t;
    for (Index i = 0; i < n; ++i)
      t.omegas.push_back(static_cast<double>(std::sqrt(std::max(0.0L, modes.eigenvalues()(i)))));
    t.transfer = [M, K, from = driven, to = read](std::complex<double> at) {
      using Complex = std::complex<long double>;
      const Complex s(at.real(), at.imag());
      const Eigen::Matrix<Complex, -1, -1> S = s * s * M.cast<Complex>() + K.cast<Complex>();
      const Eigen::Matrix<Complex, -1, -1> X = S.inverse();
      MatrixXcd H(static_cast<Index>(to.size()), static_cast<Index>(from.size()));
      for (Index i = 0; i < H.rows(); ++i)
        for (Index j = 0; j < H.cols(); ++j) {
          const Read& r = to[static_cast<std::size_t>(i)];
          const Complex y =
              (Complex(r.x) + s * Complex(r.v) + s * s * Complex(r.a)) *
              X(static_cast<Index>(r.mass), static_cast<Index>(from[static_cast<std::size_t>(j)]));
          H(i, j) = {static_cast<double>(y.real()), static_cast<double>(y.imag())};
        }
      return H;
    };
    return t;
  }
};

/// One on the other, none like its neighbour.
Masses chain(std::size_t n, double stiffness) {
  Masses c;
  for (std::size_t i = 0; i < n; ++i) {
    c.m.push_back(1 + 0.3 * std::sin(3.7 * static_cast<double>(i)));
    c.k.push_back(stiffness * (1 + 0.2 * std::cos(2.3 * static_cast<double>(i))));
    c.on.push_back(static_cast<int>(i) - 1);
  }
  c.driven = {n - 1};
  return c;
}

}  // namespace

TEST_CASE("a position is compared with its own motion in the band, however soft its support") {
  // Static gain 1 / k of the lowest spring: up to 1e9 times the gain in the band.
  for (const double soft : {1.0, 1e-2, 1e-3})
    for (const BoundKind kind : {BoundKind::estimate, BoundKind::theorem})
      for (const Read& read : {Read{5, 1}, Read{5, 1, 1e-3}}) {
        CAPTURE(soft);
        CAPTURE(read.v);
        Masses c = chain(12, 1e7);
        c.k[0] = soft;
        c.read = {read};
        const titop::Scene scene{.band_hz = {100, 600}, .accuracy = 1e-3, .bound = kind};
        check_beside(compile(c.diagram(), scene), scene, c.truth());
      }
}

TEST_CASE("a soft spring below a stiff structure costs its accelerations nothing") {
  for (const double soft : {1e-2, 1e-6, 1e-10}) {
    CAPTURE(soft);
    Masses c = chain(12, 1e7);
    c.k[0] = soft;
    c.read = {{11, 0, 0, 1}, {5, 0, 0, 1}};
    const titop::Scene scene{.band_hz = {100, 600}, .accuracy = 1e-5};
    check_beside(compile(c.diagram(), scene), scene, c.truth());
  }
}

TEST_CASE("an output's unit does not matter, however far from the other's") {
  const auto with = [](double unit) {
    Masses c = chain(12, 1e4);
    c.m[0] = 1e9;
    c.read = {{0, 0, 0, 1e9}, {5, 0, 0, unit}};
    return c;
  };
  const titop::Scene scene{.band_hz = {0, 20}, .accuracy = 0.1};
  const ReducedSystem plain = compile(with(1).diagram(), scene);
  for (const double unit : {1e-22, 1e22}) {
    CAPTURE(unit);
    const ReducedSystem r = compile(with(unit).diagram(), scene);
    CHECK(r.order() == plain.order());
    check_beside(r, scene, with(unit).truth());
  }
}

TEST_CASE("inputs and outputs with nothing between them have no error and no influence") {
  const Masses c{
      .m = {1, 2}, .k = {100, 300}, .on = {-1, -1}, .driven = {0, 1}, .read = {{0, 1}, {1, 1}}};
  const titop::Scene scene{.band_hz = {0.1, 3}, .accuracy = 1e-8};
  const ReducedSystem r = compile(c.diagram(), scene);
  const ErrorBound& b = r.bound();
  CHECK(r.order() == 4);
  CHECK(b.worst <= 1e-8);
  CHECK(b.pairs(0, 1) == 0);
  CHECK(b.pairs(1, 0) == 0);
  CHECK(b.pairs(0, 0) > 0);
  CHECK(b.output.substr(1) == b.input.substr(1));
  // Less accurate, so that one of the two is removed: the pair that is named is the worst one.
  const ReducedSystem rough =
      compile(c.diagram(), titop::Scene{.band_hz = {0.1, 0.2}, .accuracy = 0.2});
  Index i = 0, j = 0;
  CHECK(rough.bound().pairs.maxCoeff(&i, &j) == rough.bound().worst);
  CHECK(rough.bound().output == "y" + std::to_string(i + 1));
  CHECK(rough.bound().input == "u" + std::to_string(j + 1));
  CHECK(rough.bound().hertz >= 0.1);
  CHECK(rough.bound().hertz <= 0.2 * (1 + 1e-12));
}

TEST_CASE("the bound contains the effect of a pole's last digit: more for sharper peaks") {
  for (const double floor : {1e-5, 1e-6})
    for (const auto& [n, q] : {std::pair<std::size_t, int>{6, 6}, {12, 2}, {20, 4}}) {
      CAPTURE(floor);
      CAPTURE(n);
      Masses c = chain(n, 1e4);
      for (std::size_t i = 0; i < n; ++i)
        c.m[i] *= std::pow(10, (q % 5) * 0.7 * std::sin(1.3 * static_cast<double>(i) + q));
      c.read = {{n - 1, 0, 0, 1}, {n / 3, 1}};
      const Truth truth = c.truth();
      const titop::Scene scene{.band_hz = {1, truth.omegas[std::min<std::size_t>(n - 1, 12)] / 6.2},
                               .accuracy = 2e-9,
                               .damping_floor = floor};
      const ReducedSystem r = compile(c.diagram(), scene);
      CHECK(beside(r, scene, truth).bound <= 1);
      // An undamped peak's height is 1 / zeta: the last digit of its frequency is eps / zeta of it.
      CHECK(r.bound().worst >= std::numeric_limits<double>::epsilon() / floor);
    }
}

TEST_CASE("the least accuracy that may be asked for can be met") {
  Masses c = chain(2, 100);
  c.read = {{1, 0, 0, 1}};
  CHECK(says(error_of([&] {
               compile(c.diagram(), titop::Scene{.band_hz = {0, 3}, .accuracy = 1e-12});
             }),
             Code::bad_value, {"accuracy", "1e-12", "2e-12", "1"}));
  const titop::Scene scene{.band_hz = {0, 3}, .accuracy = 2e-12};
  const ReducedSystem r = compile(c.diagram(), scene);
  CHECK(r.order() == 4);
  check_beside(r, scene, c.truth());
}

TEST_CASE("arms that are built alike cost samples once, not arm by arm") {
  // Arms of three masses on a hub: each frequency of a clamped arm, once less than there are arms.
  const auto star = [](int arms) {
    Masses c{.m = {40}, .k = {9e4}, .on = {-1}, .driven = {3}, .read = {{6, 0, 0, 1}}};
    for (int a = 0; a < arms; ++a)
      for (int i = 0; i < 3; ++i) {
        c.m.push_back(1.0 + 0.5 * i);
        c.k.push_back(4e3 - 500.0 * i);
        c.on.push_back(i == 0 ? 0 : static_cast<int>(c.m.size()) - 2);
      }
    return c;
  };
  const titop::Scene scene{.band_hz = {0.5, 30}, .accuracy = 1e-4};
  std::vector<int> samples;
  for (const int arms : {3, 6}) {
    const ReducedSystem r = compile(star(arms).diagram(), scene);
    samples.push_back(r.bound().samples);
    check_beside(r, scene, star(arms).truth());
  }
  CHECK(samples[1] <= 1.1 * samples[0]);
}
