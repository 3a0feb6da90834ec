#include <algorithm>
#include <cmath>
#include <titop/analysis/lft/derivatives.hpp>
#include <titop/graph/linalg/dense.hpp>
#include <titop/graph/linalg/eigen.hpp>
#include <titop/graph/linalg/index.hpp>
#include <titop/graph/linalg/rounding.hpp>
#include <titop/graph/linalg/spectral.hpp>

namespace titop {
namespace {

using Eigen::Index;
using Eigen::MatrixXcd;
using Eigen::MatrixXd;
using linalg::at;

/// Rounding moves the two poles of a defective pair apart by its root, and leaves their vectors
/// parallel to it [G 7.2]; those of equal poles with vectors of their own by rounding times their
/// condition number, of which kApart allows 1e4. A reciprocal condition number of the vectors above
/// kDoubleRoot is none of a defective pair. Subspaces are split while that costs less than four
/// digits.
constexpr double kApart = 1e4;

/// Poles of one invariant subspace: A R = R diag(values), L R = I.
struct Subspace {
  Eigen::VectorXcd values;
  MatrixXcd L, R;
  bool defective = false;
};

/// A cluster's poles with their vectors; those of several poles from the real matrix in their
/// subspace.
Subspace subspace(const MatrixXd& A, const linalg::Spectrum& s,
                  const linalg::Spectrum::Cluster& c) {
  const MatrixXcd V = s.V.middleCols(c.first, c.count), W = s.W.middleRows(c.first, c.count);
  if (c.simple) return {s.values.segment(c.first, c.count), W, V};
  MatrixXd both(A.rows(), 2 * c.count);
  both << V.real(), V.imag();
  const MatrixXd U =
      Eigen::JacobiSVD<MatrixXd>(both, Eigen::ComputeThinU).matrixU().leftCols(c.count);
  const MatrixXcd to_real = W * U;  // its inverse takes W to the left basis of U
  const Eigen::PartialPivLU<MatrixXcd> lu(to_real);
  const MatrixXd left = MatrixXcd(lu.solve(W)).real();
  const linalg::Eigensystem e = linalg::eigensystem(left * A * U);
  return {e.values, e.W * left, U * e.V, !(e.rcond_V > linalg::kDoubleRoot)};
}

/// Rounding moves two equal real poles off the axis.
bool is_real(const std::complex<double>& s) {
  return std::abs(s.imag()) <= linalg::kHalfDigits * std::abs(s);
}

/// The next places of `todo` whose poles are equal to the first one's.
std::vector<Index> equal_ones(const Eigen::VectorXcd& values, std::vector<Index>& todo) {
  const std::complex<double> s = values(todo.front());
  std::vector<Index> equal, others;
  for (const Index i : todo)
    (std::abs(values(i) - s) <= 2 * linalg::kHalfDigits * std::abs(s) || values(i) == s ? equal
                                                                                        : others)
        .push_back(i);
  todo = std::move(others);
  return equal;
}

}  // namespace

std::vector<PoleSlopes> Derivatives::poles() const {
  std::vector<PoleSlopes> result;
  if (m_.order() == 0) return result;
  MatrixXd A = m_.A;
  const Eigen::VectorXd d = linalg::similarity_scaling(A);
  const linalg::Spectrum s = linalg::spectrum(A, kApart);
  for (const auto& cluster : s.clusters) {
    const Subspace sub = subspace(A, s, cluster);
    std::vector<Index> todo;
    for (Index i = 0; i < sub.values.size(); ++i)
      if (sub.values(i).imag() >= 0 || is_real(sub.values(i))) todo.push_back(i);
    while (!todo.empty()) {
      const std::vector<Index> own = equal_ones(sub.values, todo);
      PoleSlopes p{.s = sub.values(own.front()),
                   .count = static_cast<int>(own.size()),
                   .slopes = {},
                   .defective = sub.defective};
      if (is_real(p.s)) p.s.imag(0);
      for (const Pairs& pairs : pairs_) {
        if (sub.defective) break;
        const MatrixXd Bw =
                           d.cwiseInverse().asDiagonal() * m_.B.middleCols(pairs.first, pairs.size),
                       Cz = m_.C.middleRows(pairs.first, pairs.size) * d.asDiagonal();
        const MatrixXcd small =
            MatrixXcd(sub.L(own, Eigen::all) * Bw) * MatrixXcd(Cz * sub.R(Eigen::all, own));
        p.slopes.push_back(pairs.slope *
                           Eigen::ComplexEigenSolver<MatrixXcd>(small, false).eigenvalues());
      }
      result.push_back(std::move(p));
    }
  }
  std::stable_sort(result.begin(), result.end(), [](const PoleSlopes& a, const PoleSlopes& b) {
    return std::abs(a.s) < std::abs(b.s);
  });
  return result;
}

}  // namespace titop
