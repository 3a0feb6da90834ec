#include <fmt/format.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>
#include <string>
#include <titop/graph/linalg/graded.hpp>
#include <titop/graph/linalg/shifted.hpp>
#include <titop/graph/linalg/skeel.hpp>
#include <vector>

#include "generate/draws.hpp"
#include "support/processor_seconds.hpp"
#include "support/quick.hpp"

/// Algorithms of linear algebra that the library has of its own, beside Eigen's for the same
/// result: error and processor seconds of one call, the best of five batches. Returns 1 if a result
/// of the library is further off than its header allows. Ratios are in docs/bench.
namespace titop_bench {
namespace {

using Eigen::Index;
using Eigen::MatrixXcd;
using Eigen::MatrixXd;
using Eigen::VectorXd;
using titop::generate::Rng;

/// The rows of one problem, of which each method finds a result of type R.
template <class R>
struct Problem {
  std::string algorithm, input;
  std::function<double(const R&)> error;
  bool quick = false;

  /// False if the error exceeds `most`.
  bool row(const char* method, const std::function<R()>& find, double most = HUGE_VAL) const {
    const double wanted = quick ? 0 : 0.02;  // seconds of a batch
    double best = HUGE_VAL;
    R result{};
    for (int batch = 0, calls = 1; batch < (quick ? 1 : 5);) {
      const double start = processor_seconds();
      for (int i = 0; i < calls; ++i) result = find();
      const double seconds = processor_seconds() - start;
      if (seconds < wanted && batch == 0 && calls < 1'000'000) {
        calls *= 4;
        continue;
      }
      best = std::min(best, seconds / calls);
      ++batch;
    }
    const double off = error(result);
    fmt::print("{},{},{},{:.1e},{:.2e}\n", algorithm, input, method, off, best);
    return off <= most;
  }
};

// --- eigenvalues of graded matrices -------------------------------------------------------------

/// n masses (even), every second one of 2^-octaves kg (even), between springs of 1 N/m and walls.
struct LightAndHeavy {
  Index n;
  int octaves;

  /// M^-1/2 K M^-1/2, without rounding.
  MatrixXd matrix() const {
    MatrixXd S = MatrixXd::Zero(n, n);
    const auto scale = [&](Index i) { return std::exp2(i % 2 == 0 ? octaves / 2 : 0); };
    for (Index i = 0; i < n; ++i) {
      S(i, i) = 2 * scale(i) * scale(i);
      if (i + 1 < n) S(i, i + 1) = S(i + 1, i) = -scale(i) * scale(i + 1);
    }
    return S;
  }
  /// (2 - m lambda)(2 - lambda) = 4 cos(k pi / (n + 1))^2, k = 1 ... n / 2. Ascending.
  VectorXd eigenvalues() const {
    const double m = std::exp2(-octaves);
    std::vector<double> all;
    for (Index k = 1; k <= n / 2; ++k) {
      const double sine = std::sin(static_cast<double>(k) * std::numbers::pi /
                                   static_cast<double>(n + 1)),
                   c = 4 * sine * sine, half = 1 + m + std::sqrt((1 + m) * (1 + m) - m * c);
      all.push_back(c / half);
      all.push_back(half / m);
    }
    std::sort(all.begin(), all.end());
    return VectorXd::Map(all.data(), n);
  }
};

VectorXd singular_values_squared(const MatrixXd& S) {
  const Eigen::LDLT<MatrixXd> ldl(S);
  const MatrixXd L = MatrixXd(ldl.matrixL()) * ldl.vectorD().cwiseSqrt().asDiagonal();
  return Eigen::JacobiSVD<MatrixXd>(L, Eigen::ComputeFullU).singularValues().reverse().cwiseAbs2();
}

bool eigenvalues(Index n, int octaves, bool quick) {
  const LightAndHeavy row{n, octaves};
  const MatrixXd S = row.matrix();
  const VectorXd exact = row.eigenvalues();
  const auto error = [&](const VectorXd& found) {
    return (found.cwiseQuotient(exact).array() - 1).abs().maxCoeff();
  };
  const Problem<VectorXd> p{"eigenvalues", fmt::format("{} masses of 1 and 2^-{}", n, octaves),
                            error, quick};
  const bool right = p.row(
      "titop", [&] { return titop::eigh_graded(S).modes.lambda; }, 1e-12);
  p.row("JacobiSVD of a factor", [&] { return singular_values_squared(S); });
  p.row("SelfAdjointEigenSolver",
        [&] { return VectorXd(Eigen::SelfAdjointEigenSolver<MatrixXd>(S).eigenvalues()); });
  return right;
}

// --- (s - A)^-1 B at many s ---------------------------------------------------------------------

/// At the last of these frequencies, against a dense LU.
bool resolvent(Index n, int points, bool quick) {
  Rng rng(4);
  const MatrixXd A = rng.matrix(n, n) - 2 * MatrixXd::Identity(n, n), B = rng.matrix(n, 2);
  const auto s_of = [](int k) { return std::complex<double>(0, 1e-2 * std::pow(1.02, k)); };
  const auto dense = [&](int k) -> MatrixXcd {
    MatrixXcd K = -A.cast<std::complex<double>>();
    K.diagonal().array() += s_of(k);
    return K.partialPivLu().solve(MatrixXcd(B.cast<std::complex<double>>()));
  };
  const MatrixXcd other = dense(points - 1);
  const auto last = [&](const auto& solve) {
    MatrixXcd z;
    for (int k = 0; k < points; ++k) z = solve(k);
    return z;
  };
  const Problem<MatrixXcd> p{"(s - A)^-1 B", fmt::format("{} states at {} frequencies", n, points),
                             [&](const MatrixXcd& z) { return (z - other).norm() / other.norm(); },
                             quick};
  const bool right = p.row(
      "titop",
      [&] {
        const titop::linalg::ShiftedSolver solver(A, B);
        return last([&](int k) { return solver.solve(s_of(k)).z; });
      },
      1e-12);
  p.row("PartialPivLU at each", [&] { return last(dense); });
  return right;
}

// --- spectral radius of |M^-1| |M| --------------------------------------------------------------

/// A loop through n unknowns, each coupled with its two neighbours; or with all others.
MatrixXd loop(Index n, bool dense) {
  Rng rng(5);
  MatrixXd M = rng.matrix(n, n) + 2 * MatrixXd::Identity(n, n);
  for (Index i = 0; i < n && !dense; ++i)
    for (Index j = 0; j < n; ++j)
      if (std::abs(i - j) > 1) M(i, j) = 0;
  return M;
}

double radius_by_eigen(const MatrixXd& M) {
  const MatrixXd product = M.partialPivLu().inverse().cwiseAbs() * M.cwiseAbs();
  return Eigen::EigenSolver<MatrixXd>(product, false).eigenvalues().cwiseAbs().maxCoeff();
}

bool radius(Index n, bool dense, bool quick) {
  const MatrixXd M = loop(n, dense);
  const double exact = radius_by_eigen(M);
  const Problem<double> p{"radius of |M^-1| |M|",
                          fmt::format("{} rows {}", n, dense ? "dense" : "tridiagonal"),
                          [&](double found) { return std::abs(found / exact - 1); }, quick};
  const bool right = p.row(
      "titop", [&] { return titop::linalg::skeel_radius(M); }, 5e-3);
  p.row("EigenSolver", [&] { return radius_by_eigen(M); });
  return right;
}

int run(bool quick) {
  fmt::print("algorithm,input,method,error,seconds\n");
  bool right = true;
  for (const Index n : {4, 12, 60})
    for (const int octaves : {0, 20, 40, 80})
      if (!quick || n < 20) right &= eigenvalues(n, octaves, quick);
  for (const Index n : {12, 40, 270})
    if (!quick || n < 100) right &= resolvent(n, quick ? 20 : 561, quick);
  for (const bool dense : {true, false})
    for (const Index n : {2, 6, 12, 30, 120})
      if (!quick || n < 100) right &= radius(n, dense, quick);
  return right ? 0 : 1;
}

}  // namespace
}  // namespace titop_bench

int main(int argc, char** argv) { return titop_bench::run(titop_bench::is_quick(argc, argv)); }
