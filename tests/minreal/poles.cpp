#include <doctest/doctest.h>

#include <cmath>
#include <complex>
#include <titop/compiler/minreal/poles_of.hpp>
#include <titop/titop.hpp>
#include <utility>
#include <vector>

/// The rounding of A costs as much as the model: it is computed if the poles need it, once.

using namespace titop;

namespace {

/// Poles of A, and how often its rounding was asked for.
std::pair<std::vector<Pole>, int> poles_and_calls(const Eigen::MatrixXd& A) {
  StateSpace m;
  m.A = A;
  int calls = 0;
  std::vector<Pole> list = detail::poles_of(m,
                                            [&] {
                                              ++calls;
                                              return Eigen::MatrixXd(0x1p-52 * A.cwiseAbs());
                                            },
                                            {});
  return {std::move(list), calls};
}

}  // namespace

TEST_CASE("poles: the rounding of A is asked for by unsymmetric problems alone") {
  // q1'' = -9 q1 + 4 q2, q2'' = 4 q1 - 9 q2: 5 and 13 rad^2/s^2. A free state is exact.
  Eigen::MatrixXd A = Eigen::MatrixXd::Zero(5, 5);
  A(0, 1) = A(2, 3) = 1;
  A(1, 0) = A(3, 2) = -9;
  A(1, 2) = A(3, 0) = 4;
  A(4, 4) = -2;
  auto [undamped, none] = poles_and_calls(A);
  CHECK(none == 0);
  REQUIRE(undamped.size() == 3);
  CHECK(undamped[0].s == std::complex<double>(-2, 0));
  CHECK(std::abs(undamped[1].s - std::complex<double>(0, std::sqrt(5.0))) <= 1e-14);
  CHECK(std::abs(undamped[2].s - std::complex<double>(0, std::sqrt(13.0))) <= 1e-14);

  // r1' = 2 r2, r2' = -2 r1 - 3 q1, q1' = r1: det(s - G) = s^3 + 4 s + 6.
  Eigen::MatrixXd G = Eigen::MatrixXd::Zero(3, 3);
  G(0, 1) = 2, G(1, 0) = -2, G(1, 2) = -3, G(2, 0) = 1;
  const auto [gyroscopic, once] = poles_and_calls(G);
  CHECK(once == 1);
  for (const Pole& p : gyroscopic) CHECK(std::abs(p.s * p.s * p.s + 4.0 * p.s + 6.0) <= 1e-13);
}
