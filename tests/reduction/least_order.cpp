#include <doctest/doctest.h>

#include <titop/analysis/reduction/balanced.hpp>
#include <titop/graph/linalg/eigen.hpp>

#include "support/rng.hpp"

/// The order of a balanced model against all orders and cuts tried one by one, by one LU per
/// sample.
using namespace titop;
using namespace titop_test;
using Eigen::Index;
using Eigen::MatrixXcd;
using Eigen::MatrixXd;
using Complex = std::complex<double>;

namespace {

/// Least order of the cuts within the target: largest entry of the difference over the peak.
Index least_order(const detail::Split& split, const detail::Samples& samples, const MatrixXd& D,
                  double high, double target) {
  const auto [out, in] = detail::port_sizes(samples.peak);
  const detail::PortSizes sizes{in.cwiseInverse().transpose(), out};
  for (Index r = 0; r <= split.stable.order(); ++r)
    for (const double corner : {0.0, high})
      for (const bool truncated : {true, false}) {
        const detail::Balancing b = detail::balance(split, sizes, corner);
        if (r > b.sigma.size()) continue;
        const detail::Cut c = detail::cut(b, r, truncated);
        double worst = 0;
        for (std::size_t k = 0; k < samples.s.size(); ++k) {
          const MatrixXcd off =
              samples.H[k] - detail::transfer(c.part, samples.s[k]) - (D + c.D).cast<Complex>();
          worst = std::max(worst, off.cwiseAbs().cwiseQuotient(samples.peak).maxCoeff());
        }
        if (worst <= target && (r == 0 || c.part.A.eigenvalues().real().maxCoeff() < 0)) return r;
      }
  return -1;
}

}  // namespace

TEST_CASE("the order of a balanced model is the least that does, one by one") {
  Rng rng(7);
  for (const Index n : {7, 24}) {
    StateSpace model;
    model.A = rng.matrix(n, n);
    model.A.diagonal().array() -= model.A.eigenvalues().real().maxCoeff() + 0.05;
    model.B = rng.matrix(n, 2), model.C = rng.matrix(3, n), model.D = rng.matrix(3, 2);
    const detail::Split split = detail::split(model);
    REQUIRE(split.stable.order() == n);
    detail::Samples samples;
    samples.peak = MatrixXd::Zero(3, 2);
    for (double omega = 0; omega <= 8; omega += 0.1) {
      samples.omega.push_back(omega);
      samples.s.push_back(Complex(0.002, 1) * omega);
      MatrixXcd S = -model.A.cast<Complex>();
      S.diagonal().array() += samples.s.back();
      const MatrixXcd x = S.partialPivLu().solve(MatrixXcd(model.B.cast<Complex>()));
      samples.H.push_back(model.C * x + model.D);
      samples.peak = samples.peak.cwiseMax(samples.H.back().cwiseAbs());
    }
    samples.alike = samples.peak;
    const detail::Balanced balanced(model, split, samples, 8);
    for (const double target : {0.5, 1e-1, 1e-2, 3e-3, 1e-4, 1e-6, 1e-9}) {
      CAPTURE(target);
      const auto found = balanced.find(0, target);
      REQUIRE(found);
      CHECK(found->error <= target);
      CHECK(found->order == least_order(split, samples, model.D, 8, target));
    }
  }
}
