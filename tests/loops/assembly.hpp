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

/// Rows that are held: the motions that they leave, and the multipliers along which they say
/// nothing new, which stay open.
struct Rows {
  Eigen::JacobiSVD<MatrixXd> svd;
  Index rank = 0;
  bool clear = true;  ///< no singular value is near the limit of the rank

  explicit Rows(const MatrixXd& held) : svd(held, Eigen::ComputeFullU | Eigen::ComputeFullV) {
    const VectorXd& sigma = svd.singularValues();
    for (Index i = 0; i < sigma.size(); ++i) {
      const double relative = sigma(i) / sigma(0);
      rank += relative > 1e-9;
      clear = clear && (relative > 1e-4 || relative < 1e-13);
    }
  }
  MatrixXd motions() const { return svd.matrixV().rightCols(svd.matrixV().cols() - rank); }
  MatrixXd open() const { return svd.matrixU().rightCols(svd.matrixU().cols() - rank); }
  /// The smallest q with held q = right.
  MatrixXcd motion(const MatrixXcd& right) const {
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

/// What is left of a structure where some rows are held.
struct Left {
  by_hand::Structure structure;
  bool clear = true;   ///< see Rows
  bool twice = false;  ///< the rows say something more than once
};

/// On the null space of `held` q = 0.
inline Left left_free(const by_hand::Structure& a, const MatrixXd& held) {
  const Rows rows(held);
  const MatrixXd Z = rows.motions();
  return {{Z.transpose() * a.M * Z, Z.transpose() * a.D * Z, Z.transpose() * a.K * Z,
           Z.transpose() * a.B, a.C * Z},
          rows.clear,
          rows.rank < held.rows()};
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
