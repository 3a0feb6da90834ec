#include <algorithm>
#include <titop/compiler/minreal/staircase.hpp>
#include <titop/compiler/solve/samples.hpp>
#include <titop/graph/linalg/eigen.hpp>
#include <titop/graph/linalg/rounding.hpp>
#include <vector>

namespace titop::minreal {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

/// One side of a cluster: its inputs or, transposed, its outputs.
struct DrivenSide {
  MatrixXd A, B;
  double A_noise, A_size;
  VectorXd B_noise, B_size;
};

/// The first `reached` columns of U span the reachable subspace of the ports.
struct Stairs {
  MatrixXd U;
  Index reached = 0;
  double angle = 0;                  ///< by which rounding may have turned them
  double visibility = 0, bound = 0;  ///< of parts taken for 0, and rounding's
};

/// Ports by their own rounding: M is larger than 1 unless it is 0.
struct ScaledPorts {
  MatrixXd M;
  double noise, relative;  ///< in M's units, and by the sizes
};

ScaledPorts first_step(const DrivenSide& d) {
  std::vector<Index> ports;
  double relative = 0;
  for (Index l = 0; l < d.B.cols(); ++l)
    if (d.B_size(l) > 0) {
      ports.push_back(l);
      relative = std::max(relative, d.B_noise(l) / d.B_size(l));
    }
  MatrixXd M = d.B(Eigen::all, ports);
  for (std::size_t l = 0; l < ports.size(); ++l)
    M.col(static_cast<Index>(l)) /=
        std::max(d.B_noise(ports[l]), linalg::kEpsilon * d.B_size(ports[l]));
  return {std::move(M), 1, relative};
}

/// `times`: singular values up to this multiple of rounding count as 0. `careful`: if rounding has
/// too few digits, all states count as reached.
Stairs stairs(const DrivenSide& d, double times, bool careful) {
  const Index k = d.A.rows();
  Stairs s{MatrixXd::Identity(k, k)};
  MatrixXd A = d.A;
  A.diagonal().array() -= k > 0 ? A.trace() / static_cast<double>(k) : 0;
  const double own = A.norm();
  ScaledPorts step = first_step(d);
  while (s.reached < k) {
    if (careful && step.relative > kWarn) {
      s.reached = k;
      return s;
    }
    const Index left = k - s.reached;
    MatrixXd U = MatrixXd::Identity(left, left);
    VectorXd sigma;
    if (step.M.cols() > 0) {
      const Eigen::JacobiSVD<MatrixXd> svd(step.M, Eigen::ComputeFullU);
      U = svd.matrixU();
      sigma = svd.singularValues();
    }
    Index rank = 0;
    while (rank < sigma.size() && sigma(rank) > times * step.noise) ++rank;
    if (rank < left) {
      const double zero = rank < sigma.size() ? sigma(rank) : 0;
      if (step.noise > 0) s.visibility = std::max(s.visibility, zero / step.noise * step.relative);
      s.bound = std::max(s.bound, step.relative);
    }
    s.U.rightCols(left) *= U;
    A.rightCols(left) *= U;
    A.bottomRows(left).applyOnTheLeft(U.transpose());
    if (rank == 0) return s;
    s.angle = std::min(1.0, s.angle + step.noise / sigma(rank - 1));
    const Index before = s.reached;
    s.reached += rank;
    const double noise = d.A_noise + s.angle * own;
    step = {A.block(s.reached, before, k - s.reached, rank), noise,
            d.A_size > 0 ? noise / d.A_size : 0};
  }
  return s;
}

struct StairsPair {
  Stairs reach, see;
};
StairsPair part(const ClusterModel& m, double times, bool careful) {
  StairsPair p;
  const Index k = m.A.rows();
  p.reach = m.B.cols() > 0
                ? stairs({m.A, m.B, m.A_noise, m.A_size, m.B_noise, m.B_size}, times, careful)
                : Stairs{MatrixXd::Identity(k, k), k};
  const MatrixXd U = p.reach.U.leftCols(p.reach.reached);
  const double angle = p.reach.angle;
  p.see = m.C.rows() > 0 ? stairs({(U.transpose() * m.A * U).transpose(), (m.C * U).transpose(),
                                   m.A_noise + angle * m.A.norm(), m.A_size,
                                   m.C_noise + angle * m.C.rowwise().norm(), m.C_size},
                                  times, careful)
                         : Stairs{MatrixXd::Identity(U.cols(), U.cols()), U.cols()};
  return p;
}

}  // namespace

MinimalPart minimal_part(const ClusterModel& model) {
  const Index k = model.A.rows();
  const StairsPair p = part(model, detail::kRoundingFactor, /*careful=*/true);
  const Index reached = p.reach.reached;
  return {p.reach.U.rightCols(k - reached),
          p.reach.U.leftCols(reached) * p.see.U.rightCols(reached - p.see.reached),
          std::min(p.see.reached, part(model, kClearly, /*careful=*/false).see.reached),
          std::max(p.reach.visibility, p.see.visibility), std::max(p.reach.bound, p.see.bound)};
}

}  // namespace titop::minreal
