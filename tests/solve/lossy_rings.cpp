#include <doctest/doctest.h>

#include <boost/multiprecision/cpp_complex.hpp>
#include <complex>
#include <titop/titop.hpp>
#include <vector>

/// Rings of equal masses (1 kg, 10 N/m between neighbours), with a force on one of them, against
/// their closed form in 50 digits. Eliminating a ring leaves one loop as long as itself.

using namespace titop;
using Complex = std::complex<double>;
using Exact = boost::multiprecision::cpp_complex_50;

namespace {

struct LossyRing {
  int n;
  double damping;  ///< N s/m

  /// Accelerations of the driven mass, and of those after a quarter and after half of the ring.
  std::vector<int> seen() const { return {0, n / 4, n / 2}; }

  Diagram diagram() const {
    Diagram d("ring");
    const auto force = d.input("force");
    std::vector<SpringMass::Handle> masses;
    for (int i = 0; i < n; ++i)
      masses.push_back(d.add("m" + std::to_string(i),
                             SpringMass{.mass = 1, .stiffness = 10, .damping = damping}));
    for (int i = 0; i < n; ++i)
      mount(masses[static_cast<std::size_t>((i + 1) % n)],
            masses[static_cast<std::size_t>(i)].child);
    masses[0].child.force += force;
    for (const int i : seen())
      d.output("a" + std::to_string(i)) = masses[static_cast<std::size_t>(i)].child.accel;
    return d;
  }

  /// s^2 (q^k + q^(n-k)) / ((1 - q^n) z (1/q - q)) with z = 10 + damping s and q + 1/q = 2 + s^2/z,
  /// |q| < 1: a wave to either side, and those that have gone round.
  Complex exact(Complex at, int k) const {
    const Exact s(at.real(), at.imag());
    const Exact z = 10 + damping * s, half = 1 + s * s / (2 * z), root = sqrt(half * half - 1);
    Exact q = half - root;
    if (abs(q) > 1) q = half + root;
    const Exact a = s * s * (pow(q, k) + pow(q, n - k)) / ((1 - pow(q, n)) * z * (1 / q - q));
    return {a.real().convert_to<double>(), a.imag().convert_to<double>()};
  }
};

}  // namespace

TEST_CASE("lossy rings: of 4 to 1,000 masses, from nearly lossless to a hundred times critical") {
  int tried = 0;
  for (const int n : {4, 30, 300, 1000})
    for (const double damping : {0.1, 20.0, 1e3}) {
      const LossyRing ring{n, damping};
      const System system = compile(ring.diagram());
      for (const double re : {0.0, 0.3, 20.0})
        for (const double im : {0.01, 0.7, 2.23, 15.93}) {
          const Eigen::MatrixXcd found = system.transfer({re, im});
          for (std::size_t i = 0; i < ring.seen().size(); ++i) {
            const Complex exact = ring.exact({re, im}, ring.seen()[i]);
            if (std::abs(exact) < 1e-290) continue;  // numbers without all their digits
            CAPTURE(n);
            CAPTURE(damping);
            CAPTURE(re);
            CAPTURE(im);
            CHECK(std::abs(found(static_cast<Eigen::Index>(i), 0) - exact) <=
                  1e-12 * std::abs(exact));
            ++tried;
          }
        }
    }
  CHECK(tried >= 300);
}
