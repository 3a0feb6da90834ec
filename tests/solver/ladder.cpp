#include <doctest/doctest.h>
#include <fmt/format.h>

#include <titop/compiler/system.hpp>
#include <titop/graph/mount.hpp>
#include <titop/graph/nodes/lti.hpp>

#include "oracle.hpp"
#include "support/mistakes.hpp"
#include "support/random_scene.hpp"

/// The same elimination in every precision, against the oracle's own 150 digits.

using namespace titop;
using namespace solver_test;
using titop_test::Rng;

namespace {

/// Five flexible bodies, every second one a million times lighter; the oracle's answer beside it.
struct Chain {
  std::vector<ModalData> data;

  Chain() {
    Rng rng(7);
    for (int i = 0; i < 5; ++i)
      data.push_back(titop_test::scaled(titop_test::random_modes(rng, 6, {"C"}, true),
                                        {.mass = i % 2 ? 1e-6 : 1}));
  }
  Diagram diagram() const {
    Diagram d{"chain"};
    const auto U = d.input("U", 6);
    std::vector<BodyHandle> body;
    for (std::size_t i = 0; i < data.size(); ++i)
      body.push_back(d.add(fmt::format("b{}", i + 1), FlexibleBody(data[i])));
    body.front().parent.force = -U;
    for (std::size_t i = 1; i < body.size(); ++i) mount(body[i], body[i - 1].child);
    d.output("root", 6) = body.front().parent.accel;
    d.output("tip", 6) = body.back().child.accel;
    return d;
  }
  Eigen::MatrixXcd exact(std::complex<double> s) const {
    std::vector<BigMatrix> Y;
    for (const ModalData& body : data) Y.push_back(modal_transfer(body, Complex(s)));
    return rounded(chain_transfer(
        Y, std::vector<BigMatrix>(data.size() - 1, BigMatrix(Eigen::MatrixXd::Identity(6, 6))), 6));
  }
};

/// Largest difference in a block of 3 x 3 over its largest entry.
double block_error(const Eigen::MatrixXcd& a, const Eigen::MatrixXcd& b) {
  double worst = 0;
  for (Eigen::Index i = 0; i < b.rows(); i += 3)
    for (Eigen::Index j = 0; j < b.cols(); j += 3)
      worst = std::max(worst, (a - b).block<3, 3>(i, j).cwiseAbs().maxCoeff() /
                                  b.block<3, 3>(i, j).cwiseAbs().maxCoeff());
  return worst;
}

double worst_of(const System& system, const Chain& chain, Precision precision) {
  double worst = 0;
  for (const std::complex<double> s : {std::complex<double>(0.1, 0.6), {0.8, 5}, {5, 33}})
    worst = std::max(worst, block_error(system.transfer(s, precision), chain.exact(s)));
  return worst;
}

}  // namespace

TEST_CASE("precision: each step of the ladder is as good as its digits") {
  const Chain chain;
  const System system = compile(chain.diagram());
  const double single = worst_of(system, chain, Precision::single);
  const double standard = worst_of(system, chain, Precision::standard);
  const double refined = worst_of(system, chain, Precision::refined);
  const double extended = worst_of(system, chain, Precision::extended);
  const double digits50 = worst_of(system, chain, Precision::digits50);
  MESSAGE(fmt::format("{:.1e} {:.1e} {:.1e} {:.1e} {:.1e}", single, standard, refined, extended,
                      digits50));
  CHECK(single <= 1e-2);
  CHECK(standard <= 1e-10);
  CHECK(refined <= 1e-13);
  CHECK(refined <= 1e-2 * standard);
  CHECK(extended <= 1e-13);
  // What is compared is rounded to double.
  CHECK(digits50 <= 3e-16);
  CHECK(single >= 1e4 * standard);
}

namespace {

/// out = (1 + 1e-10) in, fed back to itself with u: a loop of margin 4e10 about its pole.
Diagram nearly_singular() {
  Diagram d{"near"};
  auto u = d.input("u");
  auto K = d.add("K", Lti{.D = Eigen::MatrixXd::Constant(1, 1, 1 + 0x1p-33)});
  auto L = d.add("L", Lti{.D = Eigen::MatrixXd::Constant(1, 1, 1 - 0x1p-33)});
  K.in = L.out + u;
  L.in = K.out;
  d.output("y") = K.out;
  return d;
}

}  // namespace

TEST_CASE("precision: as needed goes up where cancellation has eaten the digits of double") {
  // (1 + e)(1 - e) = 1 - e^2, so that y/u = (1 + e)/e^2: with e = 2^-33 no digit is left in double.
  CHECK(titop_test::says(titop_test::compile_error(nearly_singular()), Code::ill_posed, {"K"}));
  // With e^2 = 2^-40 eight digits are lost: double shows it, `as_needed` has them all.
  Diagram d{"near"};
  auto u = d.input("u");
  auto K = d.add("K", Lti{.D = Eigen::MatrixXd::Constant(1, 1, 1 + 0x1p-20)});
  auto L = d.add("L", Lti{.D = Eigen::MatrixXd::Constant(1, 1, (1 - 0x1p-20) / 3)});
  K.in = 3.0 * L.out + u;
  L.in = K.out;
  d.output("y") = K.out;
  const System system = compile(d);
  // The factor 1/3 is a rounded double: exact arithmetic on what the doubles are.
  const Real k = 1 + 0x1p-20, l = Real((1 - 0x1p-20) / 3) * 3;
  const double exact = static_cast<double>(k / (1 - k * l));
  const auto error = [&](Precision p) {
    return std::abs(system.transfer({0, 1}, p)(0, 0) - exact) / std::abs(exact);
  };
  CHECK(error(Precision::as_needed) <= 1e-15);
  CHECK(error(Precision::digits50) <= 1e-15);
  CHECK(system.certificate().weakest_pivot <= 1e-10);
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

TEST_CASE("precision: what dies away along a chain, to the smallest numbers, is no loss") {
  Rng rng(11);
  const FlexibleBody spec(titop_test::random_modes(rng, 6, {"C"}, true));
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
