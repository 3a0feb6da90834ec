#include <doctest/doctest.h>
#include <fmt/format.h>

#include <titop/blocks/fe/beam.hpp>
#include <titop/blocks/fe/scaled.hpp>
#include <titop/blocks/spring_mass.hpp>
#include <titop/compiler/system/system.hpp>
#include <titop/graph/linalg/eigen.hpp>
#include <titop/graph/mount.hpp>

#include "generate/diagrams/modes.hpp"
#include "solve/flexible_chain.hpp"
#include "support/rng.hpp"

/// Bodies of very different mass in one chain, against 150 digits: the factors keep them at every
/// ratio.

using namespace titop;
using namespace solve_test;
using titop_test::Rng;

namespace {

const std::vector<std::complex<double>> kPoints = {{0.1, 0.6}, {0.8, 5}, {5, 33}, {20, 140}};

/// One for every second body, the ratio for the others.
double scale(int body, double ratio) { return body % 2 ? ratio : 1; }

/// Error of [xdd at the root; xdd at the tip] by the wrench at the root.
struct Flexible : FlexibleChain {
  enum class Modes {
    independent,  ///< the six modes move C in six orthogonal ways
    random,       ///< Phi_C is random, of condition 10 to 1000
    bending       ///< as of a beam's lowest modes: C moves neither along x nor about it
  };
  Flexible(std::uint64_t seed, int n, double ratio, Modes modes) {
    Rng rng(seed);
    for (int i = 0; i < n; ++i) {
      ModalData one = titop::generate::random_modes(rng, 6, {"C"}, true);
      Eigen::MatrixXd& Phi_C = one.children.front().Phi_C;
      if (modes == Modes::bending) Phi_C.row(0).setZero(), Phi_C.row(3).setZero();
      if (modes == Modes::independent) {
        const Eigen::MatrixXd Q = Eigen::HouseholderQR<Eigen::MatrixXd>(Phi_C).householderQ();
        Phi_C = Q / std::sqrt(one.D_P(0, 0));
      }
      add(titop::scaled(one, {.mass = scale(i, ratio)}), Rotation::matrix(rng.rotation()));
    }
  }
};

using Modes = Flexible::Modes;

struct Springs {
  std::vector<double> m, k, c, m0;

  Springs(std::uint64_t seed, int n, double ratio) {
    Rng rng(seed);
    for (int i = 0; i < n; ++i) {
      m.push_back(rng.octaves(-1, 2) * scale(i, ratio));
      k.push_back(rng.octaves(3, 9) * scale(i, ratio));
      c.push_back(rng.octaves(-3, 0) * scale(i, ratio));
      m0.push_back(i == 0 || rng.chance(0.5) ? rng.octaves(-1, 2) * scale(i, ratio) : 0);
    }
  }
  Diagram diagram() const {
    Diagram d{"chain"};
    const auto u = d.input("u");
    std::vector<SpringMass::Handle> z;
    for (std::size_t i = 0; i < m.size(); ++i)
      z.push_back(d.add(
          fmt::format("z{}", i + 1),
          SpringMass{.mass = m[i], .stiffness = k[i], .damping = c[i], .parent_mass = m0[i]}));
    z.front().parent.force = -u;
    for (std::size_t i = 1; i < z.size(); ++i) mount(z[i], z[i - 1].child);
    d.output("root") = z.front().parent.accel;
    d.output("tip") = z.back().child.accel;
    return d;
  }
  Eigen::MatrixXcd exact(std::complex<double> s) const {
    std::vector<BigMatrix> Y;
    for (std::size_t i = 0; i < m.size(); ++i)
      Y.push_back(spring_transfer(m[i], k[i], c[i], m0[i], Complex(s)));
    return rounded(chain_transfer(
        Y, std::vector<BigMatrix>(m.size() - 1, BigMatrix(Eigen::MatrixXd::Identity(1, 1))), 1));
  }
};

/// Largest difference of a p x p block over the block's largest entry, over all points: no floor,
/// however small the block is compared with others. Blocks of three: translations, rotations.
template <class Scene>
double error_of(const Scene& scene, Eigen::Index p, Precision precision = Precision::as_needed) {
  const System system = compile(scene.diagram());
  Eigen::MatrixXd size, error;
  for (const auto s : kPoints) {
    const Eigen::MatrixXcd exact = scene.exact(s),
                           difference = system.transfer(s, precision) - exact;
    size.conservativeResizeLike(Eigen::MatrixXd::Zero(exact.rows() / p, exact.cols() / p));
    error.conservativeResizeLike(size * 0);
    for (Eigen::Index i = 0; i < size.rows(); ++i)
      for (Eigen::Index j = 0; j < size.cols(); ++j) {
        const auto largest = [&](const Eigen::MatrixXcd& m) {
          return m.block(p * i, p * j, p, p).cwiseAbs().maxCoeff();
        };
        size(i, j) = std::max(size(i, j), largest(exact));
        error(i, j) = std::max(error(i, j), largest(difference));
      }
  }
  return error.cwiseQuotient(size).maxCoeff();
}

}  // namespace

TEST_CASE("mass ratios: ten flexible bodies, six degrees of freedom, against 150 digits") {
  for (const double ratio : {1e-12, 1e-9, 1e-6, 1.0, 1e6, 1e9, 1e12}) {
    double independent = 0, random = 0;
    for (std::uint64_t seed = 1; seed <= 3; ++seed) {
      independent =
          std::max(independent, error_of(Flexible(seed, 10, ratio, Modes::independent), 3));
      random = std::max(random, error_of(Flexible(seed, 10, ratio, Modes::random), 3));
    }
    MESSAGE(fmt::format("ratio {:.0e}: {:.1e}, random Phi_C {:.1e}", ratio, independent, random));
    CAPTURE(ratio);
    CHECK(independent <= 1e-12);
    CHECK(random <= 1e-12);
  }
}

TEST_CASE("mass ratios: heavy bodies tied through light ones that do not give along x") {
  // There elimination in double loses digits that no pivot shows: a step of refinement restores
  // them.
  for (const double ratio : {1e-12, 1e-6, 1.0, 1e6, 1e9, 1e12}) {
    const Flexible chain(1, 10, ratio, Modes::bending);
    const double by_default = error_of(chain, 3),
                 in_double = error_of(chain, 3, Precision::standard);
    MESSAGE(fmt::format("ratio {:.0e}: {:.1e}, in double {:.1e}", ratio, by_default, in_double));
    CAPTURE(ratio);
    CHECK(by_default <= 1e-12);
    CHECK(in_double <= 1e-9);
  }
}

/// On the axis, point by point: no other point's size helps.
template <class Scene>
double worst_on_axis(const Scene& scene, Eigen::Index p) {
  const System system = compile(scene.diagram());
  double worst = 0;
  for (int k = 0; k < 8; ++k) {
    const std::complex<double> s(0, 0.1 * std::pow(10, k / 2.0));
    const Eigen::MatrixXcd exact = scene.exact(s), off = system.transfer(s) - exact;
    for (Eigen::Index i = 0; i < exact.rows(); i += p)
      for (Eigen::Index j = 0; j < exact.cols(); j += p)
        worst = std::max(worst, off.block(i, j, p, p).cwiseAbs().maxCoeff() /
                                    exact.block(i, j, p, p).cwiseAbs().maxCoeff());
  }
  return worst;
}

TEST_CASE("mass ratios: the frequency response of ten flexible bodies, against 150 digits") {
  for (const double ratio : {1e-12, 1e-9, 1e-6, 1.0, 1e6, 1e9, 1e12}) {
    double worst = 0;
    for (std::uint64_t seed = 4; seed <= 5; ++seed)
      for (const Modes modes : {Modes::independent, Modes::random, Modes::bending})
        worst = std::max(worst, worst_on_axis(Flexible(seed, 10, ratio, modes), 3));
    MESSAGE(fmt::format("ratio {:.0e}: {:.1e}", ratio, worst));
    CAPTURE(ratio);
    // Beside a pole the estimate of 1e-12, one sample of rounding, may be 4 times too small.
    CHECK(worst <= 4e-12);
  }
}

namespace {

/// Beams, light and heavy in turn, on joints turned at random.
Diagram beams(double ratio, std::uint64_t seed) {
  Rng rng(seed);
  const auto beam = [](double scale) {
    return FlexibleBody(Beam{.length = 2,
                             .section = rectangle(0.06, 0.04),
                             .material = {.E = 70e9 * scale, .nu = 0.33, .rho = 2700 * scale},
                             .elements = 4,
                             .modes = {.kept = 6, .xi = {0.005}}});
  };
  const FlexibleBody light = beam(1 / ratio), heavy = beam(ratio);
  Diagram d{"beams"};
  std::vector<FlexibleBody::Handle> b;
  for (int i = 0; i < 10; ++i) b.push_back(d.add(fmt::format("b{}", i + 1), i % 2 ? heavy : light));
  b.front().parent.force = -d.input("U", 6);
  for (std::size_t i = 1; i < b.size(); ++i)
    mount(b[i], b[i - 1].child, Rotation::matrix(rng.rotation()));
  d.output("tip", 6) = b.back().child.accel;
  return d;
}

}  // namespace

TEST_CASE("mass ratios: beams, where a step of refinement leaves more than the square of itself") {
  for (const double ratio : {1.0, 1e6, 1e9}) {  // light ones by 1 / ratio
    double worst = 0;
    for (std::uint64_t seed = 1; seed <= 6; ++seed) {
      const System system = compile(beams(ratio, seed));
      for (int k = 0; k < 12; ++k) {
        const std::complex<double> s(0, 0.11 * std::pow(10, k / 5.0));
        const Eigen::MatrixXcd exact = system.transfer(s, Precision::digits50),
                               off = system.transfer(s) - exact;
        for (int i = 0; i < 6; i += 3)
          for (int j = 0; j < 6; j += 3)
            worst = std::max(worst, off.block(i, j, 3, 3).cwiseAbs().maxCoeff() /
                                        exact.block(i, j, 3, 3).cwiseAbs().maxCoeff());
      }
    }
    MESSAGE(fmt::format("ratio {:.0e}: {:.1e}", ratio, worst));
    CAPTURE(ratio);
    CHECK(worst <= 1e-12);
  }
}

TEST_CASE("mass ratios: scalar chains of 30, to 1e-14 of 150 digits") {
  for (const double ratio : {1e-12, 1e-9, 1e-6, 1.0, 1e6, 1e9, 1e12}) {
    double worst = 0;
    for (std::uint64_t seed = 1; seed <= 5; ++seed)
      worst = std::max(worst, error_of(Springs(seed, 30, ratio), 1));
    MESSAGE(fmt::format("ratio {:.0e}: {:.1e}", ratio, worst));
    CAPTURE(ratio);
    CHECK(worst <= 1e-14);
  }
}
