#include "generate/diagrams/lti.hpp"

#include <algorithm>
#include <numeric>

namespace titop::generate {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;

std::vector<Index> permutation(Rng& rng, Index n) {
  std::vector<Index> order(static_cast<std::size_t>(n));
  std::iota(order.begin(), order.end(), Index{0});
  rng.shuffle(order);
  return order;
}

MatrixXd whole_numbers(Rng& rng, Index rows, Index cols) {
  MatrixXd m(rows, cols);
  for (double& x : m.reshaped()) x = rng.below(7) - 3;
  return m;
}

MatrixXd state_matrix(Rng& rng, LtiKind kind, Index n) {
  if (kind == LtiKind::singular) {
    const Index rank = n - 1 - rng.below(2) * (n > 2);
    const MatrixXd right = whole_numbers(rng, rank, n), left = whole_numbers(rng, n, rank);
    return left * right;
  }
  MatrixXd A = 2 * rng.matrix(n, n);
  const std::vector<Index> order = permutation(rng, n);
  const auto place = [&](Index i) { return order[static_cast<std::size_t>(i)]; };
  if (kind == LtiKind::permuted) {
    A /= 64;
    for (Index i = 0; i < n; ++i) A(place(i), place((i + 1) % n)) = rng.octaves(0, 6);
  } else if (kind == LtiKind::integrators) {
    // The first states feed one another and take nothing else.
    const Index chain = 1 + rng.below(std::min(static_cast<int>(n), 4));
    for (Index i = 0; i < chain; ++i) {
      A.row(place(i)).setZero();
      if (i > 0) A(place(i), place(i - 1)) = rng.octaves(-1, 2);
    }
  } else if (kind == LtiKind::unstable) {
    A.diagonal().array() += 2 * static_cast<double>(n);
  }
  return A;
}

}  // namespace

Lti random_lti(Rng& rng, LtiKind kind, Index states, Index inputs, Index outputs) {
  Lti K{.A = MatrixXd(0, 0), .B = rng.matrix(states, inputs), .C = rng.matrix(outputs, states)};
  if (states > 0) K.A = state_matrix(rng, kind, states);
  if (kind == LtiKind::scaled)
    for (Index i = 0; i < states; ++i) {
      const double unit = std::ldexp(1.0, rng.below(41) - 20);
      K.A.row(i) *= unit, K.B.row(i) *= unit;
      K.A.col(i) /= unit, K.C.col(i) /= unit;
    }
  if (states == 0 || rng.chance(0.5)) K.D = rng.matrix(outputs, inputs);
  return K;
}

}  // namespace titop::generate
