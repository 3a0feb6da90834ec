#include "order_search.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <titop/graph/linalg/eigen.hpp>
#include <titop/graph/linalg/index.hpp>

namespace titop_test {
namespace {

using Eigen::Index;
using Eigen::MatrixXcd;
using Eigen::MatrixXd;
using Eigen::VectorXd;
using titop::linalg::at;

/// Two measures of errors over the accuracy: the largest, or the sum of the logarithms above 1.
enum class Measure { largest, logarithms };

class Search {
 public:
  Search(const Searched& searched, double accuracy) : in_(searched), accuracy_(accuracy) {
    add_modes();
    for (const double omega : {0.0, 0.6 * in_.end, in_.end})
      for (const bool above : {false, true}) add_responses(omega, above);
    add_principal();
  }

  /// Number of columns of the pool; none if no choice meets the accuracy.
  std::optional<int> run(Measure measure) const {
    std::vector<std::size_t> chosen;
    MatrixXd V(in_.modes.mu.size(), 0);
    double left = excess(V, measure);
    while (left > 0) {
      std::size_t best = pool_.size();
      MatrixXd with_best;
      for (std::size_t k = 0; k < pool_.size(); ++k) {
        const MatrixXd more = extended(V, pool_[k]);
        if (more.cols() == V.cols()) continue;
        if (const double e = excess(more, measure); e < left) left = e, best = k, with_best = more;
      }
      if (best == pool_.size()) return std::nullopt;
      chosen.push_back(best);
      V = with_best;
    }
    spare(chosen);
    return static_cast<int>(chosen.size());
  }

 private:
  bool in_band(Index mode) const { return in_.modes.mu(mode) * in_.end * in_.end >= 1; }

  void add_modes() {
    for (Index j = 0; j < in_.modes.mu.size(); ++j)
      if (in_band(j)) pool_.push_back(VectorXd::Unit(in_.modes.mu.size(), j));
  }

  /// (1 - omega^2 mu)^-1 b and c of each input and output.
  void add_responses(double omega, bool above) {
    VectorXd weight = (1 - omega * omega * in_.modes.mu.array()).inverse();
    for (Index j = 0; j < weight.size(); ++j)
      if (above && in_band(j)) weight(j) = 0;
    for (Index i = 0; i < in_.modes.b.cols(); ++i)
      pool_.push_back(weight.cwiseProduct(in_.modes.b.col(i)).normalized());
    for (Index i = 0; i < in_.modes.c.rows(); ++i)
      pool_.push_back(weight.cwiseProduct(in_.modes.c.row(i).transpose()).normalized());
  }

  /// Of the responses so far, without the modes.
  void add_principal() {
    const auto first =
        std::ranges::count_if(in_.modes.mu, [&](double mu) { return mu * in_.end * in_.end >= 1; });
    MatrixXd all(in_.modes.mu.size(), static_cast<Index>(pool_.size()) - first);
    for (Index k = 0; k < all.cols(); ++k) all.col(k) = pool_[at(first + k)];
    const Eigen::SelfAdjointEigenSolver<MatrixXd> gram(all.transpose() * all);
    for (Index k = 0; k < std::min<Index>(12, all.cols()); ++k) {
      const VectorXd v = all * gram.eigenvectors().col(all.cols() - 1 - k);
      if (v.norm() > 1e-6) pool_.push_back(v.normalized());
    }
  }

  /// V and the part of v outside of it, if there is one.
  static MatrixXd extended(const MatrixXd& V, VectorXd v) {
    for (int twice = 0; twice < 2; ++twice) {
      v -= V * (V.transpose() * v);
      if (!(v.norm() > 1e-6)) return V;
      v.normalize();
    }
    MatrixXd more(V.rows(), V.cols() + 1);
    more << V, v;
    return more;
  }

  /// 0 if the accuracy is met.
  double excess(const MatrixXd& V, Measure measure) const {
    const MatrixXd over = errors(V) / accuracy_;
    if (over.maxCoeff() <= 1) return 0;
    if (measure == Measure::largest) return over.maxCoeff();
    return over.array().max(1).log().sum();
  }

  /// Largest error of each pair over its peak.
  MatrixXd errors(const MatrixXd& V) const {
    VectorXd mu(V.cols());
    MatrixXd W = V;
    if (V.cols() > 0) {
      const Eigen::SelfAdjointEigenSolver<MatrixXd> small(V.transpose() *
                                                          in_.modes.mu.asDiagonal() * V);
      mu = small.eigenvalues();
      W = V * small.eigenvectors();
    }
    const MatrixXd b = W.transpose() * in_.modes.b, c = in_.modes.c * W;
    MatrixXd worst = MatrixXd::Zero(in_.peak.rows(), in_.peak.cols());
    for (std::size_t k = 0; k < in_.s.size(); ++k) {
      const std::complex<double> s = in_.s[k];
      const Eigen::VectorXcd gain = s * s / (1.0 + in_.damping * s + s * s * mu.array());
      MatrixXcd off = in_.H[k] - in_.modes.rigid;
      off -= c * (gain.asDiagonal() * b);
      worst = worst.cwiseMax(off.cwiseAbs().cwiseQuotient(in_.peak));
    }
    return worst;
  }

  /// Removes one after the other what the accuracy does not need, the least needed first.
  void spare(std::vector<std::size_t>& chosen) const {
    while (!chosen.empty()) {
      double least = accuracy_;
      std::size_t which = chosen.size();
      for (std::size_t k = 0; k < chosen.size(); ++k) {
        MatrixXd V(in_.modes.mu.size(), 0);
        for (std::size_t i = 0; i < chosen.size(); ++i)
          if (i != k) V = extended(V, pool_[chosen[i]]);
        if (const double e = errors(V).maxCoeff(); e <= least) least = e, which = k;
      }
      if (which == chosen.size()) return;
      chosen.erase(chosen.begin() + static_cast<std::ptrdiff_t>(which));
    }
  }

  const Searched& in_;
  double accuracy_;
  std::vector<VectorXd> pool_;
};

}  // namespace

int least_coordinates(const Searched& searched, double accuracy) {
  const Search search(searched, accuracy);
  int least = -1;
  for (const Measure measure : {Measure::largest, Measure::logarithms})
    if (const std::optional<int> found = search.run(measure))
      least = least < 0 ? *found : std::min(least, *found);
  return least;
}

}  // namespace titop_test
