#pragma once

// Closed structures by hand: every element's coordinates in terms of shared ones.

#include <titop/graph/linalg/eigen.hpp>

#include "../scenes/by_hand.hpp"

namespace loop_test {

using namespace scene_test;

/// M, D, K of all parts in shared coordinates q: parts come with what their own coordinates are.
struct Assembly {
  by_hand::Structure a;

  Assembly(Index n, Index inputs, Index outputs) : a(by_hand::empty(n, inputs, outputs)) {}

  /// own = Y q
  void add(const MatrixXd& M, const MatrixXd& K, const MatrixXd& Y) {
    a.M += Y.transpose() * M * Y;
    a.K += Y.transpose() * K * Y;
  }

  /// A beam: `start` and `end` (6 x n, in the beam's frame) move its ends, its inner nodes have
  /// coordinates of their own from `first` on.
  void beam(const by_hand::Beam& b, const MatrixXd& start, const MatrixXd& end, Index first) {
    const by_hand::FreeBeam fe = by_hand::free_beam(b);
    const Index inner = 6 * (b.elements - 1);
    MatrixXd Y = MatrixXd::Zero(fe.M.rows(), a.M.rows());
    Y.topRows(6) = start;
    Y.block(6, first, inner, inner).setIdentity();
    Y.bottomRows(6) = end;
    add(fe.M, fe.K, Y);
  }

  MatrixXd unit(Index first, Index count) const {
    MatrixXd rows = MatrixXd::Zero(count, a.M.rows());
    rows.middleCols(first, count).setIdentity();
    return rows;
  }
};

/// omegas of K x = omega^2 M x, the `zeros` lowest left out.
inline std::vector<Complex> elastic_poles(const by_hand::Structure& a, Index zeros) {
  const Eigen::GeneralizedSelfAdjointEigenSolver<MatrixXd> modes(a.K, a.M, Eigen::EigenvaluesOnly);
  std::vector<Complex> list;
  for (Index i = zeros; i < a.M.rows(); ++i)
    list.emplace_back(0, std::sqrt(std::max(modes.eigenvalues()(i), 0.0)));
  return list;
}

/// Poles with Im s >= 0 of a dense model, whatever they are.
inline std::vector<Complex> all_poles(const titop::System& system) {
  std::vector<Complex> list;
  for (const titop::Pole& p : system.poles()) list.push_back(p.s);
  return list;
}

}  // namespace loop_test
