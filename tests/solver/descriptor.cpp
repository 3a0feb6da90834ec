#include <doctest/doctest.h>

#include <titop/graph/linalg/eigen.hpp>
#include <titop/titop.hpp>

#include "support/close.hpp"
#include "support/random_scene.hpp"
#include "support/rng.hpp"

/// The sparse model before elimination: solved as it stands it has the same transfer.

using namespace titop;
using titop_test::matrix_error;

namespace {

Eigen::MatrixXcd transfer_of(const Descriptor& m, std::complex<double> s) {
  const Eigen::MatrixXcd P = s * Eigen::MatrixXd(m.E).cast<std::complex<double>>() -
                             Eigen::MatrixXd(m.A).cast<std::complex<double>>();
  const Eigen::MatrixXcd B = Eigen::MatrixXd(m.B).cast<std::complex<double>>();
  return Eigen::MatrixXd(m.C) * P.fullPivLu().solve(B) + Eigen::MatrixXd(m.D);
}

Diagram chain(int n) {
  Diagram d{"chain"};
  auto u = d.input("u");
  std::vector<SpringMass::Handle> z;
  z.reserve(static_cast<std::size_t>(n));
  for (int i = 0; i < n; ++i) {
    z.push_back(d.add("z" + std::to_string(i + 1),
                      SpringMass{.mass = 1.0 + i, .stiffness = 100.0, .parent_mass = 0.5}));
    if (i == 0)
      ground(z[0]);
    else
      mount(z.back(), z[static_cast<std::size_t>(i - 1)].child);
  }
  z.back().child.force = u;
  d.output("a") = z.back().child.accel + 2.0 * z[0].stretch + u;
  return d;
}

}  // namespace

TEST_CASE("descriptor: the same transfer, names for every row, zeros in E but for the states") {
  const System system = compile(chain(4));
  const Descriptor m = system.descriptor();
  CHECK(m.states == system.order());
  CHECK(m.names.size() == static_cast<std::size_t>(m.A.rows()));
  CHECK(m.names.front() == "z1.stretch");
  CHECK(std::find(m.names.begin(), m.names.end(), "z4.child.accel") != m.names.end());
  CHECK(m.E.nonZeros() == m.states);
  for (const std::complex<double> s : {std::complex<double>(0.2, 3), {0, 11}, {1, 40}})
    CHECK(matrix_error(transfer_of(m, s), transfer(chain(4).graph(), s)) <= 1e-12);
}

TEST_CASE("descriptor: entries grow linearly with the bodies") {
  const auto entries = [](int n) {
    const Descriptor m = compile(chain(n), {.minimize_up_to = 0}).descriptor();
    return m.A.nonZeros() + m.B.nonZeros() + m.C.nonZeros();
  };
  const auto ten = entries(10), twenty = entries(20), thirty = entries(30);
  CHECK(thirty - twenty == twenty - ten);
}

namespace {

Diagram one_mass() {
  Diagram d{"one"};
  auto u = d.input("u");
  auto z = d.add("z", SpringMass{.mass = d.param("m", 1.0), .stiffness = 100.0});
  ground(z);
  z.child.force = u;
  d.output("x") = z.stretch;
  return d;
}

}  // namespace

TEST_CASE("sweep: the frequency of one mass is sqrt(k/m), with any number of threads") {
  const System system = compile(one_mass());
  std::vector<ParameterList> points;
  for (int i = 1; i <= 50; ++i) points.push_back({{"m", 0.1 * i}});
  const auto run = [&](int threads, std::size_t& reports) {
    std::vector<double> omega(points.size());
    sweep(system, points,
          [&](std::size_t i, const System& at) { omega[i] = at.poles().front().omega; },
          {.threads = threads, .progress = [&](std::size_t, std::size_t all) {
             ++reports;
             CHECK(all == 50);
           }});
    return omega;
  };
  std::size_t first = 0, second = 0;
  const auto one = run(1, first), four = run(4, second);
  CHECK(first == points.size());
  CHECK(second == points.size());
  CHECK(one == four);
  for (std::size_t i = 0; i < one.size(); ++i)
    CHECK(titop_test::relative(one[i], std::sqrt(100.0 / (0.1 * double(i + 1)))) <= 1e-14);
}

TEST_CASE("sweep: the first point that makes no model is named") {
  const System system = compile(one_mass());
  const std::vector<ParameterList> points{{{"m", 1.0}}, {{"m", -1.0}}, {{"m", -2.0}}};
  std::string text;
  try {
    sweep(system, points, [](std::size_t, const System&) {}, {.threads = 3});
  } catch (const Error& error) {
    text = error.what();
  }
  CHECK(text.find("z with the new values") != std::string::npos);
  CHECK(text.find("at point 1 of the sweep") != std::string::npos);
}
