#pragma once

#include <Eigen/Core>
#include <titop/titop.hpp>
#include <vector>

#include "against.hpp"

/// Trees of modal and rigid bodies as one M, D and K, assembled by hand from the bodies' data: the
/// coordinates are the motion of the root, if it is free, and the modes of all bodies clamped. In
/// long double, since a bound may be as low as 1e-12 of a peak, and 5e-14 of a pair's size without
/// symmetry: double loses more when a free root is eliminated, and between heavy and light bodies.
namespace titop_test {

using MatrixXl = Eigen::Matrix<long double, Eigen::Dynamic, Eigen::Dynamic>;
using VectorXl = Eigen::Matrix<long double, Eigen::Dynamic, 1>;

/// M xdd + D xd + K x = B u, y = C x.
struct Assembled {
  MatrixXl M, D, K, B, C;
};

class Tree {
 public:
  explicit Tree(bool free) : columns_(free ? 6 : 0), root_(free) {}

  /// Bodies as the diagram mounts them: on child `port` of body `on` (-1: the root), turned by T.
  int add(const titop::ModalData& m, int on = -1, int port = 0,
          const Eigen::Matrix3d& T = Eigen::Matrix3d::Identity());
  int add(const titop::RigidBody& r, int on = -1, int port = 0,
          const Eigen::Matrix3d& T = Eigen::Matrix3d::Identity());

  /// Six rows: the motion of a body's P (port -1) or of a child point, in its frame.
  MatrixXl motion(int body, int port = -1) const;

  /// M, D and K; B and C by motions: forces on the rows of `driven`, outputs `read`.
  Assembled structure(const MatrixXl& driven, const MatrixXl& read) const;

 private:
  struct Body {
    MatrixXl mass;
    int on, port;
    Eigen::Matrix3d T;
    Eigen::Index first;
    VectorXl omega, damping;
    std::vector<MatrixXl> ports = {};
  };
  int add(Body b);
  Eigen::Index columns_;
  bool root_;
  std::vector<Body> bodies_;
};

/// A structure in its modes: C (s^2 M + K)^-1 B = rigid / s^2 + sum of c_j b_j / (1 + s^2 mu_j).
struct InModes {
  Eigen::MatrixXd rigid;  ///< outputs x inputs
  Eigen::VectorXd mu;     ///< 1 / omega^2, ascending: the last mode is the lowest
  Eigen::MatrixXd b, c;   ///< modes of stiffness 1 x inputs, outputs x modes
  MatrixXl Z;             ///< damping of these modes; 0 x 0: undamped
};

/// The free root is eliminated; modes are found from M x = mu K x with stiffnesses scaled to 1, so
/// that the low ones are sharp. In `Real`, for double is faster if the structure is large.
template <class Real = long double>
InModes in_modes(const Assembled& a, bool free);

/// Times s^p of positions: 0 positions, 1 rates, 2 accelerations, per output. A sum over modes;
/// over poles if there is damping, compared with one LU of M, D and K.
Truth truth_of(const Assembled& a, bool free, const std::vector<int>& power);
Truth truth_of(const Assembled& a, bool free = false, int power = 2);

}  // namespace titop_test
