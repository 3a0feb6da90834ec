#include <cmath>
#include <limits>
#include <titop/graph/linalg/index.hpp>
#include <titop/graph/linalg/rounding.hpp>
#include <titop/graph/linalg/schur.hpp>
#include <titop/graph/linalg/spectral.hpp>

namespace titop::linalg {
namespace {

using Eigen::Index;
using Eigen::MatrixXcd;
using Eigen::MatrixXd;

/// Number of states of the pole at j: 2 for a pair.
Index states_at(const MatrixXcd& T, Index j) { return T(j, j).imag() != 0 ? 2 : 1; }

/// The pole, from `rest` on, that is nearest to one of those in [first, rest).
Index nearest(const MatrixXcd& T, Index first, Index rest) {
  Index best = rest;
  double least = std::numeric_limits<double>::infinity();
  for (Index j = rest; j < T.rows(); j += states_at(T, j))
    for (Index i = first; i < rest; ++i)
      if (const double distance = std::abs(T(i, i) - T(j, j)); distance < least)
        least = distance, best = j;
  return best;
}

/// Moves the pole at j to the place `to` before it; the order of all others stays.
void move_up(Schur& s, Index j, Index to) {
  std::vector<char> first(at(s.T.rows()), 0);
  for (Index i = 0; i < to; ++i) first[at(i)] = 1;
  for (Index i = j; i < j + states_at(s.T, j); ++i) first[at(i)] = 1;
  reorder(s, std::move(first));
}

/// Poles of T that are nearer than this are equal: their difference is rounding.
double rounding_of(const MatrixXcd& T) { return kOneNumber * T.norm(); }

/// True if the poles in [first, rest) are separate from those after them.
bool parted(const MatrixXcd& T, Index first, Index rest, double same, double bound) {
  const Index k = rest - first, m = T.rows() - rest;
  const Index j = nearest(T, first, rest);
  if ((T.diagonal().segment(first, k).array() - T(j, j)).abs().minCoeff() <= same) return false;
  const MatrixXcd X = sylvester(T.block(first, first, k, k), T.bottomRightCorner(m, m),
                                -T.block(first, rest, k, m));
  return X.norm() <= bound;  // false for NaN: a common pole
}

std::vector<Spectrum::Cluster> find_clusters(Schur& s, double bound) {
  std::vector<Spectrum::Cluster> clusters;
  const Index n = s.T.rows();
  const double same = rounding_of(s.T);
  for (Index first = 0, rest; first < n; first = rest) {
    const Index one = states_at(s.T, first);
    rest = first + one;
    while (rest < n && !parted(s.T, first, rest, same, bound)) {
      const Index j = nearest(s.T, first, rest), more = states_at(s.T, j);
      move_up(s, j, rest);
      rest += more;
    }
    bool simple = rest - first == one;
    if (simple && one == 2) {
      const double apart = 2 * std::abs(s.T(first, first).imag());
      simple = apart > same && std::abs(s.T(first, first + 1)) <= bound * apart;
    }
    clusters.push_back({first, rest - first, simple});
  }
  return clusters;
}

/// T R = R D with D the diagonal blocks of T, R and its inverse unit upper triangular in blocks.
struct Decoupling {
  MatrixXcd R, inverse, D;
  Decoupling(const MatrixXcd& T, const std::vector<Spectrum::Cluster>& clusters)
      : R(MatrixXcd::Identity(T.rows(), T.cols())),
        inverse(R),
        D(MatrixXcd::Zero(T.rows(), T.cols())) {
    for (std::size_t c = clusters.size(); c-- > 0;) {
      const auto [first, k, simple] = clusters[c];
      const Index m = T.rows() - first - k;
      D.block(first, first, k, k) = T.block(first, first, k, k);
      if (m == 0) continue;
      const MatrixXcd right = -T.block(first, first + k, k, m) * R.bottomRightCorner(m, m);
      R.block(first, first + k, k, m) =
          sylvester(D.block(first, first, k, k), D.bottomRightCorner(m, m), right);
      inverse.block(first, first + k, k, m) =
          -R.block(first, first + k, k, m) * inverse.bottomRightCorner(m, m);
    }
  }
};

/// Replaces the basis of a pair by its two vectors: conjugate, as those of W are.
void take_vectors(Spectrum& s, Index j) {
  const std::complex<double> share = s.T(j, j + 1) / (s.T(j + 1, j + 1) - s.T(j, j));
  s.W.row(j) -= share * s.W.row(j + 1);
  s.T(j, j + 1) = 0;
  s.V.col(j + 1) = s.V.col(j).conjugate();
  s.W.row(j + 1) = s.W.row(j).conjugate();
}

}  // namespace

Spectrum spectrum(const MatrixXd& A, double bound) {
  Schur s = schur(A);
  Spectrum result;
  result.clusters = find_clusters(s, bound);
  const Decoupling d(s.T, result.clusters);
  result.V = s.Q * d.R;
  result.W = d.inverse * s.Q.adjoint();
  result.T = d.D;
  result.values = d.D.diagonal();
  for (const auto& [first, count, simple] : result.clusters)
    if (simple && count == 2) take_vectors(result, first);
  return result;
}

}  // namespace titop::linalg
