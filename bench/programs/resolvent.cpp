#include <Eigen/LU>
#include <memory>
#include <titop/compiler/solve/response.hpp>
#include <titop/compiler/solve/scalar.hpp>

#include "support/timing.hpp"

/// (s - A)^-1 B of one dense block, three inputs: the LU of compiler/solve/response.hpp against
/// Eigen's PartialPivLU, which also computes the modulus (hypot) of every entry for a condition
/// number that is not used, and of every candidate for a pivot. One core, GCC 12, -O3, microseconds
/// (titop, Eigen):
///
///     states          1            3            6            12
///     double          0.04 0.10    0.10 0.15    0.28 0.31    0.98 0.78
///     complex         0.06 0.13    0.17 0.32    0.48 0.83    1.8  2.8
///     long double     0.11 0.25    0.53 1.0     2.1  3.9     11   17
///
/// For double-double and 50 digits Eigen needs a comparison of pivots (and traits for 50 digits,
/// which the whole library would have to share); with these its factors take 1.3 to 5 times as long
/// up to 12 states.
namespace titop_bench {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using titop::solve::Dense;

/// xdot = A x + B u with entries of one size, the same on every machine.
titop::Dynamics block(int n) {
  MatrixXd A(n, n), B(n, 3);
  unsigned state = 1;
  const auto next = [&] {
    state = 1664525u * state + 1013904223u;
    return static_cast<double>(state) * 0x1p-31 - 1;
  };
  for (double& a : A.reshaped()) a = next();
  for (double& b : B.reshaped()) b = next();
  return {A, B, MatrixXd::Zero(1, n), MatrixXd::Zero(1, 3)};
}

template <class T>
struct Setup {
  titop::Dynamics dynamics;
  T s;
  Dense<T> B, x;

  explicit Setup(int n)
      : dynamics(block(n)),
        s(titop::solve::Scalar<T>::from(std::complex<double>(0.3, 0.7))),
        B(titop::solve::lifted<T>(dynamics.B)) {}
  Dense<T> from_titop() const { return titop::detail::Resolvent<T>(dynamics, s).times(B); }
};

template <class T>
double difference(const Dense<T>& a, const Dense<T>& b) {
  double off = 0, size = 0;
  for (Index i = 0; i < a.size(); ++i) {
    off = std::max(off, titop::solve::size_of<T>(a(i) - b(i)));
    size = std::max(size, titop::solve::size_of(b(i)));
  }
  return off / size;
}

template <class T>
Prepared titop_lu(int n) {
  const auto setup = std::make_shared<Setup<T>>(n);
  return {[=] { setup->x = setup->from_titop(); }, {}};
}

template <class T>
Prepared eigen_lu(int n) {
  const auto setup = std::make_shared<Setup<T>>(n);
  return {[=] {
            Dense<T> K = -titop::solve::lifted<T>(setup->dynamics.A);
            for (Index i = 0; i < K.rows(); ++i) K(i, i) += setup->s;
            setup->x = Eigen::PartialPivLU<Dense<T>>(K).solve(setup->B);
          },
          [=] { return difference<T>(setup->x, setup->from_titop()); }};
}

template <class T>
void add(std::vector<Method>& list, const char* scalar) {
  const std::vector<int> sizes = {1, 2, 3, 4, 6, 8, 12, 50};
  list.push_back({"resolvent", scalar, "titop", sizes, titop_lu<T>});
  list.push_back({"resolvent", scalar, "Eigen", sizes, eigen_lu<T>});
}

std::vector<Method> methods() {
  std::vector<Method> list;
  add<double>(list, "double");
  add<std::complex<double>>(list, "complex");
  add<std::complex<long double>>(list, "long double");
  return list;
}

}  // namespace
}  // namespace titop_bench

int main(int argc, char** argv) { return titop_bench::run(argc, argv, titop_bench::methods()); }
