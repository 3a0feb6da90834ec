#include <fmt/format.h>

#include <Eigen/LU>
#include <boost/multiprecision/cpp_bin_float.hpp>
#include <boost/multiprecision/eigen.hpp>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <functional>
#include <numbers>
#include <titop/titop.hpp>

#include "support/quick.hpp"

/// Error and time of the derivative of a transfer by the tilt of two wings: exact, and by central
/// differences over their step, of compiled models in double, and of the model assembled by hand in
/// 50 digits. Reference: the latter at a step of 1e-15. Returns 1 if the exact one is off by more
/// than 1e-12.
namespace {

using namespace titop;
using Eigen::MatrixXcd;

constexpr double kTilt = 0.4;
const std::complex<double> kAt{0.05, 1.6};

const Vector3d kHub(400, 500, 600), kSites[] = {{0, 1, 0.2}, {0, -1, 0.2}};
const double kYaw[] = {std::numbers::pi / 2, -std::numbers::pi / 2};

ModalData wing() {
  ModalData data;
  data.omega = Vector3d(1.57, 3.77, 6.91);
  data.xi = Vector3d::Constant(0.005);
  data.L_P.resize(3, 6);
  data.L_P << 0, 0, 6.5, 0, -21, 0, 0, 5.8, 0, 0, 0, 19, 0, 0, 0, 3.9, 0, 0.5;
  data.D_P = rigid_mass(60, Vector3d(20, 180, 200).asDiagonal(), Vector3d(-2.5, 0, 0));
  return data;
}

/// A hub with two equal wings of three modes, both tilted.
Diagram satellite() {
  Diagram d{"satellite"};
  const Param tilt = d.param("tilt", kTilt);
  auto hub = d.add("hub", RigidBody{.mass = 1000,
                                    .inertia = kHub.asDiagonal(),
                                    .children = {{"L", kSites[0]}, {"R", kSites[1]}}});
  const FlexibleBody panel{wing()};
  auto left = d.add("left", panel), right = d.add("right", panel);
  const Rotation tilted = Rotation::about({1, 0, 0}, tilt);
  mount(left, hub.child("L"), Rotation::about({0, 0, 1}, kYaw[0]) * tilted);
  mount(right, hub.child("R"), Rotation::about({0, 0, 1}, kYaw[1]) * tilted);
  hub.parent.force = -d.input("U", 6);
  d.output("y", 6) = hub.parent.accel;
  return d;
}

using Real = boost::multiprecision::number<boost::multiprecision::cpp_bin_float<50>,
                                           boost::multiprecision::et_off>;
using Matrix = Eigen::Matrix<Real, Eigen::Dynamic, Eigen::Dynamic>;

Matrix dual(const Matrix& R) {
  Matrix m = Matrix::Zero(6, 6);
  m.topLeftCorner(3, 3) = m.bottomRightCorner(3, 3) = R;
  return m;
}

Matrix about(int axis, const Real& angle) {
  const int i = (axis + 1) % 3, j = (axis + 2) % 3;
  Matrix R = Matrix::Identity(3, 3);
  R(i, i) = R(j, j) = cos(angle), R(j, i) = sin(angle), R(i, j) = -R(j, i);
  return R;
}

/// [real; imaginary] part of the transfer: M, D and K of six motions of the hub and six modes.
Matrix by_hand(const Real& tilt) {
  const ModalData data = wing();
  Matrix M = Matrix::Identity(12, 12), D = Matrix::Zero(12, 12), K = D;
  M.topLeftCorner(6, 6) = rigid_mass(1000, kHub.asDiagonal(), Vector3d::Zero()).cast<Real>();
  for (int w = 0; w < 2; ++w) {
    const Matrix R = about(2, Real(kYaw[w])) * about(0, tilt);
    const Matrix to_wing = dual(R.transpose()) * tau(-kSites[w]).cast<Real>();
    const Matrix L = data.L_P.cast<Real>() * to_wing;
    M.topLeftCorner(6, 6) += to_wing.transpose() * data.D_P.cast<Real>() * to_wing;
    M.block(6 + 3 * w, 0, 3, 6) = L, M.block(0, 6 + 3 * w, 6, 3) = L.transpose();
    for (int i = 0; i < 3; ++i) {
      const Real omega = data.omega(i), xi = data.xi(i);
      K(6 + 3 * w + i, 6 + 3 * w + i) = omega * omega;
      D(6 + 3 * w + i, 6 + 3 * w + i) = 2 * xi * omega;
    }
  }
  const Real a = kAt.real(), b = kAt.imag();  // s^2 = a^2 - b^2 + 2 a b j
  const Matrix re = M * (a * a - b * b) + D * a + K, im = M * (2 * a * b) + D * b;
  Matrix E(24, 24), F = Matrix::Zero(24, 6);
  E << re, -im, im, re;
  F.topRows(6).setIdentity();
  const Matrix x = E.partialPivLu().solve(F);
  Matrix y(12, 6);
  y << x.topRows(6) * (a * a - b * b) - x.middleRows(12, 6) * (2 * a * b),
      x.topRows(6) * (2 * a * b) + x.middleRows(12, 6) * (a * a - b * b);
  return y;
}

MatrixXcd of_digits(const Real& h) {
  const Matrix d = (by_hand(Real(kTilt) + h) - by_hand(Real(kTilt) - h)) / (2 * h);
  MatrixXcd result(6, 6);
  result.real() = d.topRows(6).cast<double>(), result.imag() = d.bottomRows(6).cast<double>();
  return result;
}

/// The fastest of some runs.
double seconds_of(const std::function<void()>& f) {
  using Clock = std::chrono::steady_clock;
  double best = HUGE_VAL;
  for (int i = 0; i < 20; ++i) {
    const auto start = Clock::now();
    f();
    best = std::min(best, std::chrono::duration<double>(Clock::now() - start).count());
  }
  return best;
}

MatrixXcd of_models(const System& system, double h) {
  const auto at = [&](double p) { return system.update({{"tilt", p}}).transfer(kAt); };
  return (at(kTilt + h) - at(kTilt - h)) / (2 * h);
}

}  // namespace

int main(int argc, char** argv) {
  const System system = compile(satellite());
  const MatrixXcd reference = of_digits(Real(1e-15));
  const auto off = [&](const MatrixXcd& m) { return (m - reference).norm() / reference.norm(); };
  const auto row = [](const char* way, double step, double error, double seconds) {
    std::puts(fmt::format("{},{:.6g},{:.6g},{:.6g}", way, step, error, seconds).c_str());
  };
  const auto exact = [&] { return derivatives(system, {"tilt"}).transfer(kAt, "tilt"); };
  const double error = off(exact());
  std::puts("way,step,error,seconds");
  row("compile", 0, 0, seconds_of([] { compile(satellite()); }));
  for (int k = 1; k <= (titop_bench::is_quick(argc, argv) ? 4 : 14); ++k) {
    const double h = std::pow(10, -k);
    row("exact", h, error, seconds_of([&] { exact(); }));
    row("differences in double", h, off(of_models(system, h)),
        seconds_of([&] { of_models(system, h); }));
    row("differences in 50 digits", h, off(of_digits(Real(h))),
        seconds_of([&] { of_digits(Real(h)); }));
  }
  return error <= 1e-12 ? 0 : 1;
}
