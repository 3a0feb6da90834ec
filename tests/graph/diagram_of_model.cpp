#include <doctest/doctest.h>

#include <complex>
#include <titop/titop.hpp>

#include "support/mistakes.hpp"

using namespace titop;

namespace {

/// A lag of 1/2 s driven by the first of two inputs.
StateSpace lag() {
  StateSpace m;
  m.A = Eigen::MatrixXd::Constant(1, 1, -2);
  m.B = Eigen::RowVector2d(3, 0);
  m.C = Eigen::Vector3d(1, 0, 4);
  m.D = Eigen::MatrixXd::Zero(3, 2);
  m.D(1, 1) = 5;
  m.states = {"x"};
  m.inputs = {"U(1)", "U(2)"};
  m.outputs = {"y", "feed", "w"};
  return m;
}

}  // namespace

TEST_CASE("diagram_of_model: the model's names, and its transfer by hand") {
  const System system = compile(diagram_of_model(lag(), "reduced"));
  CHECK(system.inputs() == lag().inputs);
  CHECK(system.outputs() == lag().outputs);
  CHECK(system.state_space().order() == 1);
  const std::complex<double> s{0.5, 3}, g = 3.0 / (s + 2.0);
  const Eigen::MatrixXcd G = system.transfer(s);
  CHECK(std::abs(G(0, 0) - g) < 1e-15);
  CHECK(std::abs(G(2, 0) - 4.0 * g) < 4e-15);
  CHECK(G(1, 1) == 5.0);
  CHECK(G(0, 1) == 0.0);
  CHECK(G(1, 0) == 0.0);
  CHECK(G(2, 1) == 0.0);
}

TEST_CASE("diagram_of_model: matrices that do not fit are refused") {
  StateSpace m = lag();
  m.B = Eigen::MatrixXd::Zero(2, 2);
  CHECK_THROWS_AS(diagram_of_model(m, "m"), Error);
  m = lag();
  m.A(0, 0) = std::nan("");
  CHECK_THROWS_AS(diagram_of_model(m, "m"), Error);
  m = lag();
  m.inputs.pop_back();
  CHECK(titop_test::error_of([&] { diagram_of_model(m, "m"); }).has(Code::size));
}
