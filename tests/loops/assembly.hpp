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

/// Of a rigid body at P, whose center of mass is at PA and whose inertia is about that.
inline by_hand::Matrix6 mass_at_P(double mass, const Eigen::Matrix3d& inertia,
                                  const Eigen::Vector3d& PA) {
  by_hand::Matrix6 D = by_hand::Matrix6::Zero();
  D.topLeftCorner<3, 3>().diagonal().setConstant(mass);
  D.bottomRightCorner<3, 3>() = inertia;
  const by_hand::Matrix6 t = by_hand::tau(-PA);
  return t.transpose() * D * t;
}

/// A frame whose x axis points along `direction`.
inline Eigen::Matrix3d along_x(const Eigen::Vector3d& direction, const Eigen::Matrix3d& any) {
  Eigen::Matrix3d R;
  R.col(0) = direction.normalized();
  R.col(1) = R.col(0).cross(any.col(1)).normalized();
  R.col(2) = R.col(0).cross(R.col(1));
  return R;
}

/// Constraints held q = 0 by the singular values of their matrix: the motions that they leave, and
/// the multipliers along which they say nothing new, which stay open.
struct Constraints {
  MatrixXd held;
  Eigen::JacobiSVD<MatrixXd> svd;
  Index rank = 0;
  bool clear = true;  ///< no singular value is near the limit of the rank

  explicit Constraints(const MatrixXd& rows)
      : held(rows), svd(rows, Eigen::ComputeFullU | Eigen::ComputeFullV) {
    const VectorXd& sigma = svd.singularValues();
    for (Index i = 0; i < sigma.size(); ++i) {
      const double relative = sigma(i) / sigma(0);
      rank += relative > 1e-9;
      clear = clear && (relative > 1e-4 || relative < 1e-13);
    }
  }
  bool redundant() const { return rank < held.rows(); }
  MatrixXd motions() const { return svd.matrixV().rightCols(svd.matrixV().cols() - rank); }
  MatrixXd open() const { return svd.matrixU().rightCols(svd.matrixU().cols() - rank); }
  /// The smallest q with held q = right.
  template <class Matrix>
  Matrix motion(const Matrix& right) const {
    return svd.matrixV().leftCols(rank) *
           (inverse().asDiagonal() * (svd.matrixU().leftCols(rank).transpose() * right));
  }
  /// The smallest multipliers with held' multipliers = f.
  MatrixXcd multipliers(const MatrixXcd& f) const {
    return svd.matrixU().leftCols(rank) *
           (inverse().asDiagonal() * (svd.matrixV().leftCols(rank).transpose() * f));
  }

 private:
  VectorXd inverse() const { return svd.singularValues().head(rank).cwiseInverse(); }
};

/// A structure under constraints, in coordinates of the motions that they leave.
inline by_hand::Structure constrained(const by_hand::Structure& a, const Constraints& constraints) {
  const MatrixXd N = constraints.motions();
  return {N.transpose() * a.M * N, N.transpose() * a.D * N, N.transpose() * a.K * N,
          N.transpose() * a.B, a.C * N};
}

/// What forces do at s, and what the constraints bear.
struct ConstrainedMotion {
  MatrixXcd q;      ///< `given` and motions that the constraints leave
  MatrixXcd borne;  ///< force - (s^2 M + s D + K) q, which does no work on these motions
};

/// `given`: a motion that is prescribed. Beams are up to 1e9 N/m stiff: rounding of q times that
/// would be forces of 1e-8, not little beside springs of 20 N/m. So what is left over is formed in
/// long double, and the motions and q are refined by it.
inline ConstrainedMotion constrained_motion(const by_hand::Structure& a,
                                            const Constraints& constraints, Complex s,
                                            const MatrixXcd& force, const MatrixXcd& given) {
  using Wide = std::complex<long double>;
  using RealWide = Eigen::Matrix<long double, Eigen::Dynamic, Eigen::Dynamic>;
  using ComplexWide = Eigen::Matrix<Wide, Eigen::Dynamic, Eigen::Dynamic>;
  const MatrixXd motions = constraints.motions();
  RealWide real = motions.cast<long double>();
  const RealWide off = constraints.held.cast<long double>() * real;
  real -= constraints.motion(MatrixXd(off.cast<double>())).cast<long double>();
  const ComplexWide N = real.cast<Wide>(), F = force.cast<Wide>();
  const Wide z(s);
  const ComplexWide Z = z * z * a.M.cast<Wide>() + z * a.D.cast<Wide>() + a.K.cast<Wide>();
  ComplexWide q = given.cast<Wide>(), borne = F - Z * q;
  if (N.cols() > 0) {
    const MatrixXcd dynamic = s * s * a.M + s * a.D + a.K;
    const Eigen::PartialPivLU<MatrixXcd> lu(motions.transpose() * dynamic * motions);
    for (int step = 0; step < 4; ++step) {
      const ComplexWide work = N.transpose() * borne;
      const MatrixXcd y = lu.solve(MatrixXcd(work.cast<Complex>()));
      q += N * y.cast<Wide>();
      borne = F - Z * q;
    }
  }
  return {q.cast<Complex>(), borne.cast<Complex>()};
}

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
