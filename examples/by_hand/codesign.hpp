#pragma once

#include <Eigen/LU>
#include <boost/multiprecision/cpp_bin_float.hpp>
#include <boost/multiprecision/eigen.hpp>
#include <cmath>

/// The numbers of examples/20_codesign.cpp, and its satellite assembled by hand in 50 digits, in
/// the plane of the wing.
namespace codesign {

using Eigen::VectorXd;

inline constexpr double kHub = 600, kHubInertia = 250;           // [kg], [kg m^2]
inline constexpr double kPanel = 40, kArm = 3, kPanelTurn = 60;  // wing: [kg], [m], [kg m^2]
inline constexpr double kLag = 4;                                // actuator of the law [rad/s]

/// Design variables, each relative to its reference: stiffness of the root, its damper, distance of
/// the root from the hub's centre, gains of the attitude law.
enum Design { stiffness, damper, place, proportional, derivative };
inline constexpr int kVariables = 5;
inline const VectorXd kReference = (VectorXd(kVariables) << 2400, 60, 1, 120, 300).finished();
inline constexpr double kLeast = 0.02, kMost = 6;  // of all variables
inline constexpr double kStart = 1.5;              // all variables
inline constexpr double kClearance = 0.6;          // least place of the wing [m]

/// Mass of the structure that a design needs [kg]: the boom by the root of its stiffness, the
/// bracket of the wing, the damper, the wheels by the gains.
template <class T>
T boom_mass(const T& x) {
  using std::sqrt;
  return 9 * sqrt(x);
}
inline double mass_of(const VectorXd& x, VectorXd& gradient) {
  gradient.resize(kVariables);
  gradient << 4.5 / std::sqrt(x(stiffness)), 0.3, 1, 2, 6;
  return boom_mass(x(stiffness)) + 0.3 * x(damper) + x(place) + 2 * x(proportional) +
         6 * x(derivative);
}

inline constexpr double kPointing = 2.6e-3;  // H2 norm from unit torque noise to the angle [rad]
inline constexpr double kSensitivity = 1.6;  // largest: the loop gain stays 1/1.6 from -1
inline constexpr double kFrequency = 4;      // of the wing [rad/s]
inline constexpr int kConstraints = 3;

using Real = boost::multiprecision::number<boost::multiprecision::cpp_bin_float<50>,
                                           boost::multiprecision::et_off>;
using Digits = Eigen::Matrix<Real, Eigen::Dynamic, Eigen::Dynamic>;

/// Motions: hub along x and y, turn of the hub, angle of the root.
struct ByHand {
  Digits M = Digits::Zero(4, 4);
  Real k, c, kp, kd;

  explicit ByHand(const Digits& x) {
    k = x(stiffness) * kReference(stiffness), c = x(damper) * kReference(damper);
    kp = x(proportional) * kReference(proportional), kd = x(derivative) * kReference(derivative);
    const Real y = x(place) * kReference(place), m = kPanel + boom_mass(x(stiffness));
    M(0, 0) = M(1, 1) = kHub, M(2, 2) = kHubInertia;
    Digits along(1, 4), across(1, 4), turn(1, 4);  // of the wing's centre
    along << Real(1), Real(0), -(y + kArm), Real(-kArm);
    across << Real(0), Real(1), Real(0), Real(0);
    turn << Real(0), Real(0), Real(1), Real(1);
    M += along.transpose() * along * m + across.transpose() * across * m +
         turn.transpose() * turn * Real(kPanelTurn);
  }
  /// [turn, angle, their rates, torque of the law], from the disturbing torque.
  void closed(Digits& A, Digits& B) const {
    const Digits inverse = M.fullPivLu().inverse().bottomRightCorner(2, 2);
    A = Digits::Zero(5, 5), B = Digits::Zero(5, 1);
    A.topRows(2).middleCols(2, 2).setIdentity();
    A.block(2, 1, 2, 1) = -inverse.col(1) * k;
    A.block(2, 3, 2, 1) = -inverse.col(1) * c;
    A.block(2, 4, 2, 1) = -inverse.col(0);
    A(4, 0) = kLag * kp, A(4, 2) = kLag * kd, A(4, 4) = -kLag;
    B.block(2, 0, 2, 1) = inverse.col(0);
  }
  /// sqrt of the first entry of P, A P + P A' + B B' = 0.
  Real pointing() const {
    Digits A, B;
    closed(A, B);
    Digits L = Digits::Zero(25, 25), b(25, 1);
    const Digits BB = B * B.transpose();
    for (int i = 0; i < 5; ++i)
      for (int j = 0; j < 5; ++j) {
        b(5 * i + j) = -BB(i, j);
        for (int l = 0; l < 5; ++l)
          L(5 * i + j, 5 * l + j) += A(i, l), L(5 * i + j, 5 * i + l) += A(j, l);
      }
    const Digits P = L.fullPivLu().solve(b);
    return sqrt(P(0));
  }
  /// |1 - (law from T)| at j w, squared.
  Real sensitivity2(const Real& w) const {
    Digits A, B;
    closed(A, B);
    Digits E(10, 10), b = Digits::Zero(10, 1);
    const Digits W = Digits::Identity(5, 5) * w;
    E << -A, -W, W, -A;
    b.topRows(5) = B;
    const Digits X = E.fullPivLu().solve(b);
    return (1 - X(4)) * (1 - X(4)) + X(9) * X(9);
  }
  /// The largest, by Newton's iteration from w.
  Real sensitivity(Real w) const {
    const Real h = 1e-12;
    for (int i = 0; i < 4; ++i) {
      const Real less = sensitivity2(w - h), here = sensitivity2(w), more = sensitivity2(w + h);
      w -= (more - less) / 2 * h / (more - 2 * here + less);
    }
    return sqrt(sensitivity2(w));
  }
  /// Imaginary part of the root of det(M s^2 + C s + K) = s^6 (a s^2 + c b s + k b).
  Real frequency() const {
    const Digits inverse = M.fullPivLu().inverse();
    const Real b = inverse(3, 3);
    return sqrt(4 * b * k - b * b * c * c) / 2;
  }
};

/// Constraints of the model by hand; the peak of the sensitivity is near `peak`.
inline Digits constraints_by_hand(const Digits& x, double peak) {
  const ByHand model(x);
  Digits g(kConstraints, 1);
  g << model.pointing() / kPointing - 1, model.sensitivity(Real(peak)) / kSensitivity - 1,
      1 - model.frequency() / kFrequency;
  return g;
}

}  // namespace codesign
