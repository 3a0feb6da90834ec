#include <doctest/doctest.h>
#include <fmt/format.h>

#include <optional>
#include <titop/blocks/fe/scaled.hpp>
#include <titop/compiler/system/system.hpp>
#include <titop/graph/mount.hpp>
#include <titop/graph/nodes/gain.hpp>
#include <titop/graph/nodes/lti.hpp>

#include "generate/diagrams/modes.hpp"
#include "solve/flexible_chain.hpp"
#include "support/mistakes.hpp"
#include "support/rng.hpp"

/// The same elimination in every precision, against the oracle's own 150 digits.

using namespace titop;
using namespace solve_test;
using titop_test::Rng;

namespace {

/// Five flexible bodies, every second one a million times lighter.
FlexibleChain five_bodies() {
  FlexibleChain chain;
  Rng rng(7);
  for (int i = 0; i < 5; ++i)
    chain.add(titop::scaled(titop::generate::random_modes(rng, 6, {"C"}, true),
                            {.mass = i % 2 ? 1e-6 : 1}));
  return chain;
}

/// Largest difference in a block of 3 x 3 over its largest entry.
double block_error(const Eigen::MatrixXcd& a, const Eigen::MatrixXcd& b) {
  double worst = 0;
  for (Eigen::Index i = 0; i < b.rows(); i += 3)
    for (Eigen::Index j = 0; j < b.cols(); j += 3)
      worst = std::max(worst, (a - b).block<3, 3>(i, j).cwiseAbs().maxCoeff() /
                                  b.block<3, 3>(i, j).cwiseAbs().maxCoeff());
  return worst;
}

double worst_of(const System& system, const FlexibleChain& chain, Precision precision) {
  double worst = 0;
  for (const std::complex<double> s : {std::complex<double>(0.1, 0.6), {0.8, 5}, {5, 33}})
    worst = std::max(worst, block_error(system.transfer(s, precision), chain.exact(s)));
  return worst;
}

}  // namespace

TEST_CASE("precision: each step of the ladder is as good as its digits") {
  const FlexibleChain chain = five_bodies();
  const System system = compile(chain.diagram());
  const double standard = worst_of(system, chain, Precision::standard);
  const double refined = worst_of(system, chain, Precision::refined);
  const double twofold = worst_of(system, chain, Precision::twofold);
  const double digits50 = worst_of(system, chain, Precision::digits50);
  MESSAGE(fmt::format("{:.1e} {:.1e} {:.1e} {:.1e}", standard, refined, twofold, digits50));
  CHECK(standard <= 1e-10);
  CHECK(refined <= 1e-13);
  CHECK(refined <= 1e-2 * standard);
  // The compared values are rounded to double.
  CHECK(twofold <= 3e-16);
  CHECK(digits50 <= 3e-16);
}

namespace {

/// out = (1 + e) in, fed back to itself by 1 - e with u: e^2 from its pole.
Diagram nearly_singular(double e) {
  Diagram d{"near"};
  auto u = d.input("u");
  auto K = d.add("K", Lti{.D = Eigen::MatrixXd::Constant(1, 1, 1 + e)});
  auto L = d.add("L", Lti{.D = Eigen::MatrixXd::Constant(1, 1, 1 - e)});
  K.in = L.out + u;
  L.in = K.out;
  d.output("y") = K.out;
  return d;
}

}  // namespace

TEST_CASE("precision: as needed goes up where cancellation has eaten the digits of double") {
  // (1 + e)(1 - e) = 1 - e^2, so that y/u = (1 + e)/e^2: with e = 2^-33 double has no digit.
  CHECK(titop_test::says(titop_test::compile_error(nearly_singular(0x1p-33)), Code::ill_posed,
                         {"K"}));
  // With e^2 = 2^-40 eight digits are lost: double shows it, `as_needed` has them all.
  Diagram d{"near"};
  auto u = d.input("u");
  auto K = d.add("K", Lti{.D = Eigen::MatrixXd::Constant(1, 1, 1 + 0x1p-20)});
  auto L = d.add("L", Lti{.D = Eigen::MatrixXd::Constant(1, 1, (1 - 0x1p-20) / 3)});
  K.in = 3.0 * L.out + u;
  L.in = K.out;
  d.output("y") = K.out;
  const System system = compile(d);
  // The factor 1/3 is a rounded double: exact arithmetic with these doubles.
  const Real k = 1 + 0x1p-20, l = Real((1 - 0x1p-20) / 3) * 3;
  const double exact = static_cast<double>(k / (1 - k * l));
  const auto error = [&](Precision p) {
    return std::abs(system.transfer({0, 1}, p)(0, 0) - exact) / std::abs(exact);
  };
  CHECK(error(Precision::as_needed) <= 1e-15);
  CHECK(error(Precision::twofold) <= 1e-15);
  CHECK(error(Precision::digits50) <= 1e-15);
  CHECK(system.certificate().weakest_pivot <= 1e-10);
}

namespace {

constexpr double kPole = 0.7;

Lti first_order(double c, double D) {
  const auto one = [](double x) { return Eigen::MatrixXd::Constant(1, 1, x); };
  return {.A = one(-kPole), .B = one(1), .C = one(c), .D = one(D)};
}

/// A loop by c / (s + kPole) + 1/2, and around it one by by / (s + kPole): at s = 2, each may be
/// arbitrarily near to its pole; at infinity they are far. The output is the loop's input sum, or
/// that times `gain` in addition to u.
Diagram loop_in_loop(double c, double by, std::optional<double> gain = {}) {
  Diagram d{"loops"};
  auto u = d.input("u");
  auto K = d.add("K", first_order(c, 0.5));
  auto L = d.add("L", first_order(by, 0));
  K.in = K.out + u + L.out;
  L.in = K.out + u + L.out;
  if (gain)
    d.output("y") = u + *gain * (K.out + u + L.out);
  else
    d.output("y") = K.out + u + L.out;
  return d;
}

/// The loop's input sum, at s = 2, for u = 1.
Real entering(double c, double by) {
  return 1 / (Real(0.5) - (Real(c) + Real(by)) / (Real(2) + Real(kPole)));
}

double off(double found, const Real& exact) {
  return std::abs(static_cast<double>(Real(found) / exact - 1));
}

/// At s = 2; none if it is refused for its lack of digits.
std::optional<double> answer(const System& system, Precision precision) {
  try {
    return system.transfer(2, precision)(0, 0).real();
  } catch (const Error& error) {
    CHECK(error.has(Code::singular));
    return {};
  }
}

}  // namespace

TEST_CASE(
    "precision: refinement in 32 digits gives all of double, or reports that no digit remains") {
  int right = 0, lost_in_double = 0, refused = 0, refused_here = 0;
  for (int k = 20; k <= 50; k += 2)
    for (int j = 1; j <= 4; ++j) {
      const double e = std::ldexp(1, -k), c = (2 + kPole) * (0.5 - e),
                   by = (2 + kPole) * e * (1 - j * e);
      const System system = compile(loop_in_loop(c, by));
      const Real exact = entering(c, by);
      CAPTURE(k);
      CAPTURE(j);
      const auto plain = answer(system, Precision::standard),
                 found = answer(system, Precision::twofold);
      if (found) {
        CHECK(off(*found, exact) <= 3e-16);
        ++right;
        lost_in_double += !plain || off(*plain, exact) > 1e-6;
      } else {
        ++refused;
        refused_here += plain.has_value();
      }
    }
  MESSAGE(
      fmt::format("{} right, {} of them lost in double; {} refused, {} of them answered in double",
                  right, lost_in_double, refused, refused_here));
  CHECK(right >= 15);
  CHECK(lost_in_double >= 15);
  CHECK(refused > refused_here);  // some if double has no pivot, more if it has a wrong one
  CHECK(refused_here >= 20);
}

namespace {

/// Answers of one precision to many scenes.
struct Answers {
  Precision precision;
  int right = 0, refused = 0, wrong = 0;
  double worst = 0;

  void ask(const System& system, const Real& exact) {
    const auto found = answer(system, precision);
    if (!found) {
      ++refused;
      return;
    }
    const double error = off(*found, exact);
    ++(error <= 1e-12 ? right : wrong);
    if (!(error <= worst)) worst = error;
  }
};

/// By refined, twofold and as_needed: none of them may be wrong.
struct AnswersOfAll {
  Answers refined{Precision::refined}, twofold{Precision::twofold}, as_needed{Precision::as_needed};

  /// The loop's input sum is about this share of the output.
  void ask(double c, double by, double share) {
    const double gain = share / static_cast<double>(entering(c, by));
    const System system = compile(loop_in_loop(c, by, gain));
    const Real exact = 1 + Real(gain) * entering(c, by);
    for (Answers* a : {&refined, &twofold, &as_needed}) a->ask(system, exact);
  }
  void check() const {
    for (const Answers* a : {&refined, &twofold, &as_needed}) {
      MESSAGE(fmt::format("{} right, {} refused, {} wrong by up to {:.1e}", a->right, a->refused,
                          a->wrong, a->worst));
      CHECK(a->wrong == 0);
    }
  }
};

}  // namespace

// The part without digits in double is a small share of the output, and its changes from step to
// step are as small, whether they converge or not.
TEST_CASE("precision: refinement is not taken in by outputs of which little is ill-determined") {
  AnswersOfAll all;
  for (int k = 20; k <= 34; ++k)
    for (int j = 1; j <= 40; j += 3)
      for (const double share : {1.0, 1e-2, 1e-4, 1e-8}) {
        const double e = std::ldexp(1, -k);
        all.ask((2 + kPole) * (0.5 - e), (2 + kPole) * e * (1 - j * 0.25 * e), share);
      }
  all.check();
  CHECK(all.refined.right >= 50);
  CHECK(all.twofold.right >= 400);
  CHECK(all.as_needed.refused == 0);
  // One of many that were 61 % off.
  const System system =
      compile(loop_in_loop(0x1.5999994333334p+0, 0x1.599999639999ap-26, -0x1.54p-58));
  CHECK_FALSE(answer(system, Precision::refined).has_value());
  CHECK_FALSE(answer(system, Precision::twofold).has_value());
  CHECK(answer(system, Precision::as_needed) == answer(system, Precision::digits50));
}

// So near that the factors are wrong by many times the remaining error: every step is then a tiny
// part of the way, as if it had converged.
TEST_CASE("precision: refinement is not taken in by steps that are small since they lead nowhere") {
  AnswersOfAll all;
  for (int k = 6; k <= 34; ++k)
    for (int ulps = -4; ulps <= 4; ++ulps)
      for (const double share : {1e-2, 1e-4, 1e-6, 1e-8, 1e-10}) {
        const double c = (2 + kPole) * (0.5 - 1.37 * std::ldexp(1, -k));
        const double pole = static_cast<double>((Real(2) + Real(kPole)) / 2 - Real(c));
        const double by = pole + ulps * (std::nextafter(pole, 1) - pole);
        if (Real(c) + Real(by) != (Real(2) + Real(kPole)) / 2) all.ask(c, by, share);
      }
  all.check();
  CHECK(all.twofold.refused >= 900);
  // 306 have no pivot in double, and nearly all of these an answer in more digits.
  CHECK(all.as_needed.right >= 1100);
}

// k x = u, y = k x - u: the sum cancels altogether, without a scale for its change.
TEST_CASE("precision: an output that cancels altogether is 0, or has no 12 digits") {
  for (int k = 2; k <= 200; ++k) {
    CAPTURE(k);
    Diagram d{"nothing"};
    const auto u = d.input("u");
    auto x = d.add("x", Gain{.gain = 1});
    x.in = u - (k - 1.0) * x.out;
    d.output("y") = double(k) * x.out - u;
    const System system = compile(d);
    CHECK(std::abs(system.transfer(1)(0, 0)) <= 1e-15);
    for (const Precision p : {Precision::refined, Precision::twofold}) {
      std::complex<double> y = 0;
      try {
        y = system.transfer(1, p)(0, 0);
      } catch (const Error& e) {
        CHECK(e.has(Code::singular));
      }
      CHECK(std::abs(y) <= 1e-15);
    }
  }
}

TEST_CASE("precision: a refusal names another precision") {
  const auto error = [](const Diagram& d, std::complex<double> s, Precision precision) {
    return titop_test::error_of([&] { compile(d).transfer(s, precision); });
  };
  const Diagram near = loop_in_loop(0x1.5999994333334p+0, 0x1.599999639999ap-26, -0x1.54p-58);
  CHECK(titop_test::says(
      error(near, 2, Precision::twofold), Code::singular,
      {"loops", "s = 2", "12 digits", "weakest pivot", "that of L.", "Precision::as_needed"}));
  // 1e301 is beyond double-double, not beyond double.
  Diagram d{"units"};
  auto u = d.input("u");
  auto G = d.add("G", Gain{.gain = 1e-301});
  auto H = d.add("H", first_order(1e301, 0));
  H.in = u;
  G.in = H.out;
  d.output("y") = G.out;
  CHECK(titop_test::says(error(d, {0, 1}, Precision::twofold), Code::not_finite,
                         {"units", "s = 0", "Precision::digits50"}));
  const auto y = [&](Precision p) { return compile(d).transfer({0, 1}, p)(0, 0); };
  CHECK(std::abs(y(Precision::as_needed) - 1.0 / std::complex<double>(kPole, 1)) <= 1e-15);
}

TEST_CASE("precision: at an s far from 1 all have their digits") {
  Diagram d{"integrator"};
  auto u = d.input("u");
  const auto one = [](double x) { return Eigen::MatrixXd::Constant(1, 1, x); };
  auto K = d.add("K", Lti{.A = one(0), .B = one(1), .C = one(1), .D = one(0)});
  K.in = u;
  d.output("y") = K.out;
  const System system = compile(d);
  for (const double size : {1e-170, 1e-161, 1e-150, 1e155})
    for (const Precision p : {Precision::standard, Precision::refined, Precision::twofold}) {
      const std::complex<double> s(size, 2 * size);
      CHECK(std::abs(system.transfer(s, p)(0, 0) * s - 1.0) <= 1e-15);
    }
}

namespace {

/// n equal flexible bodies in a row, a wrench on the first, the acceleration of the last.
Diagram far_end(const FlexibleBody& spec, int n) {
  Diagram d{"far end"};
  auto U = d.input("U", 6);
  BodyHandle body = d.add("b1", spec);
  body.parent.force = -U;
  for (int i = 2; i <= n; ++i) {
    BodyHandle next = d.add(fmt::format("b{}", i), spec);
    mount(next, body.child);
    body = next;
  }
  d.output("tip", 6) = body.child.accel;
  return d;
}

}  // namespace

TEST_CASE("precision: decay along a chain, to the smallest numbers, is no loss") {
  Rng rng(11);
  const FlexibleBody spec(titop::generate::random_modes(rng, 6, {"C"}, true));
  const double s =
      compile(far_end(spec, 2)).certificate().s;  // where any number of them is checked
  const auto left = [&](int n) {
    return compile(far_end(spec, n)).transfer(s).cwiseAbs().maxCoeff();
  };
  const double after = left(60), by_each = std::pow(after / left(40), 1.0 / 20);
  REQUIRE(by_each < 0.95);
  // So many that 1e-316 arrives, a number of a few digits.
  const int n = 60 + static_cast<int>(std::log(1e-316 / after) / std::log(by_each));
  const System system = compile(far_end(spec, n));
  REQUIRE(std::abs(system.certificate().s / s - 1) <= 1e-12);
  const Eigen::MatrixXcd y = system.transfer(s);
  CHECK(y.cwiseAbs().maxCoeff() < 1e-300);
  CHECK(y.cwiseAbs().maxCoeff() > 0);
  CHECK(y == system.transfer(s, Precision::standard));  // nothing finer was called for
  for (const Note& note : system.notes())
    CHECK_MESSAGE(note.kind != Note::Kind::warning, note.text);
}
