#include <doctest/doctest.h>

#include <cmath>
#include <numbers>

#include "lft/n17.hpp"
#include "support/mistakes.hpp"
#include "support/rng.hpp"

/// An Lft whose M is reduced: the error of M, and that of the closed model, by sampling.

using namespace lft_test;
using Eigen::MatrixXcd;
using Eigen::MatrixXd;
using titop_test::error_of;
using titop_test::says;

namespace {

constexpr double kTwoPi = 2 * std::numbers::pi;

/// Twelve damped masses in a row: their first stiffness and last mass vary, by this many percent.
Lft row(double percentage) {
  Diagram d{"row"};
  const Param k = d.param("k", 40), m = d.param("m", 2);
  auto before = d.add("z1", SpringMass{.mass = 1, .stiffness = k, .damping = 0.8});
  ground(before);
  for (int i = 2; i <= 12; ++i) {
    SpringMass spec{.mass = 1, .stiffness = 40 + i, .damping = 0.8};
    if (i == 12) spec.mass = m;
    auto z = d.add("z" + std::to_string(i), spec);
    mount(z, before.child);
    before = z;
  }
  before.child.force += d.input("u");
  d.output("y") = before.stretch;
  return lft(compile(d), {{"k", percent(percentage)}, {"m", percent(percentage)}});
}

ParameterList random_values(const Lft& f, titop_test::Rng& rng) {
  ParameterList values;
  for (const Delta& d : f.deltas())
    values.emplace_back(d.parameter, d.map.value(rng.matrix(1, 1)(0, 0)));
  return values;
}

}  // namespace

TEST_CASE("M reduced below the modes: its error, and that of closed models at samples") {
  const Lft f = row(5);
  const ReducedLft r = reduce(f, {.band_hz = {0.01, 0.3}, .accuracy = 1e-2, .damping_floor = 0.02});
  CHECK(r.lft().m().order() < f.m().order());
  CHECK(r.lft().occurrences() == f.occurrences());
  CHECK(r.lft().m().inputs == f.m().inputs);
  CHECK(r.bound().worst <= 1e-2);
  CHECK(!r.lft().deltas()[0].minimal());  // bounds of the full model are not those of this one
  titop_test::Rng rng(3);
  int bounded = 0, all = 0;
  double largest_share = 0;
  for (const double hz : {0.011, 0.05, 0.09, 0.13, 0.2, 0.29}) {
    const std::complex<double> s = r.on_ray(kTwoPi * hz);
    const MatrixXd off = (f.m().transfer(s) - r.lft().m().transfer(s)).cwiseAbs();
    CHECK((off.array() <= (r.bound().pairs.cwiseProduct(r.bound().peak)).array() * 1.2).all());
    const MatrixXd for_all = r.error(kTwoPi * hz);
    for (int sample = 0; sample < 40; ++sample) {
      const ParameterList values = random_values(f, rng);
      const MatrixXd here = (f.at(values).transfer(s) - r.lft().at(values).transfer(s)).cwiseAbs();
      const MatrixXd bound = r.error(kTwoPi * hz, values);
      CHECK((here.array() <= bound.array()).all());
      CHECK((here.array() <= for_all.array()).all());
      bounded += bound.allFinite();
      all += 1;
      largest_share = std::max(largest_share, here.maxCoeff() / bound.maxCoeff());
    }
  }
  MESSAGE(bounded, " of ", all, " finite; largest share of the bound ", largest_share);
  CHECK(bounded >= all / 2);
  CHECK(largest_share >= 1e-4);  // it is a bound of this error, and not of everything
}

TEST_CASE("a loop gain above 1: no statement about all values, one about each") {
  const Lft f = row(60);
  const ReducedLft r = reduce(f, {.band_hz = {0.01, 0.3}, .accuracy = 1e-3, .damping_floor = 0.02});
  const double omega = kTwoPi * 0.13;
  CHECK(std::isinf(r.error(omega).maxCoeff()));
  CHECK(r.error(omega, {{"m", 1.1}, {"k", 50}}).allFinite());
}

TEST_CASE("scenes of an Lft: names, frequencies and poles at 0 are refused with the way out") {
  const Lft f = row(5);
  const Scene band{.band_hz = {0.01, 0.3}, .accuracy = 1e-3};
  Scene unknown = band;
  unknown.inputs = {"V"};
  CHECK(says(error_of([&] { reduce(f, unknown); }), Code::unknown_name, {"V"}));
  CHECK(says(error_of([&] { reduce(f, band).error(kTwoPi); }), Code::bad_value, {"0.01", "0.3"}));
  const Satellite free{.axes = {3}, .xi = 0.02, .rates = true};
  const Lft g = lft(compile(free.diagram()), {{"m", percent(2)}});
  const Error e = error_of([&] { reduce(g, {.band_hz = {0, 0.5}, .accuracy = 1e-3}); });
  INFO(std::string(e.what()));
  CHECK(says(e, Code::singular, {"M", "band_hz", "outputs"}));
}
