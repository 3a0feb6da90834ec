#include <doctest/doctest.h>

#include <titop/graph/linalg/eigen.hpp>
#include <titop/titop.hpp>

#include "generate/diagrams/random_diagram.hpp"
#include "support/close.hpp"
#include "support/rng.hpp"

/// The sparse model before elimination: solved without elimination it has the same transfer.

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

TEST_CASE("descriptor: of bodies with six degrees of freedom and joints, too") {
  int compared = 0;
  for (std::uint64_t seed = 1; seed <= 40; ++seed) {
    titop::generate::RandomOptions options = titop::generate::random_options(seed);
    options.family = seed % 2 ? titop::generate::Family::spatial : titop::generate::Family::mixed;
    options.incomplete = false;
    const System system = compile(titop::generate::random_diagram(options).build());
    const Descriptor m = system.descriptor();
    if (m.inputs.empty() || m.outputs.empty() || m.A.rows() == 0 || m.A.rows() > 400) continue;
    const std::complex<double> s{0.7, 5};
    const Eigen::MatrixXcd right = system.transfer(s);
    const Eigen::MatrixXd size = right.cwiseAbs();
    if (size.rowwise().maxCoeff().minCoeff() == 0 || size.colwise().maxCoeff().minCoeff() == 0)
      continue;  // a row or column without path is rounding there
    CAPTURE(seed);
    CHECK(matrix_error(transfer_of(m, s), right) <= 1e-9);
    ++compared;
  }
  CHECK(compared >= 20);
}

TEST_CASE("descriptor: into a form of the caller's, which keeps its memory") {
  Diagram d{"two"};
  const Param m1 = d.param("m", 1.0);
  auto u = d.input("u");
  auto a = d.add("a", SpringMass{.mass = m1, .stiffness = 100.0});
  auto b = d.add("b", SpringMass{.mass = 2.0, .stiffness = 50.0, .parent_mass = 0.5 * m1});
  ground(a);
  mount(b, a.child);
  b.child.force = u;
  d.output("a") = b.child.accel;
  const System system = compile(d), other = system.update({{"m", 3.0}});
  Descriptor form;
  system.write(form);
  const double* memory = form.A.valuePtr();
  other.write(form);
  CHECK(form.A.valuePtr() == memory);
  const Descriptor fresh = other.descriptor();
  CHECK((form.A - fresh.A).norm() == 0);
  CHECK((form.B - fresh.B).norm() == 0);
  CHECK((form.C - fresh.C).norm() == 0);
  CHECK((form.D - fresh.D).norm() == 0);
  CHECK((form.A - system.descriptor().A).norm() > 0);
  const System bigger = compile(chain(4));  // does not fit
  bigger.write(form);
  CHECK(form.names == bigger.descriptor().names);
  CHECK((form.A - bigger.descriptor().A).norm() == 0);
}
