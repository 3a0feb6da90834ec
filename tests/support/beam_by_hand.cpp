#include "support/beam_by_hand.hpp"

#include <Eigen/LU>
#include <array>
#include <boost/multiprecision/cpp_complex.hpp>
#include <boost/multiprecision/eigen.hpp>

using Complex = std::complex<double>;
using Eigen::Index;
using Eigen::MatrixXcd;
using titop::ExactBeam;

namespace titop_test {
namespace {

using Real100 = boost::multiprecision::cpp_bin_float_100;
using Complex100 = boost::multiprecision::cpp_complex_100;
using Matrix2 = Eigen::Matrix<Complex100, 2, 2>;
using Matrix4 = Eigen::Matrix<Complex100, 4, 4>;
using Row4 = Eigen::Matrix<Complex100, 1, 4>;

/// One uniform body of length L and inertia m per length, clamped at x = 0, of stiffness EI in
/// bending, EA as a rod, GJ as a shaft:
///
///     p m v + EI v'''' = -m gain (a0 + a1 x),   p m v - EA v'' = -m gain a0
///
/// v is the motion relative to the root, which accelerates by a0 and turns with a1.
struct Strip {
  Real100 stiffness, m, L;
  Complex100 s, p, gain, viscous;

  Strip(const ExactBeam& b, double stiffness_of, double m_of, Complex at)
      : stiffness(stiffness_of), m(m_of), L(b.length), s(at.real(), at.imag()) {
    viscous = 1 + Real100(b.damping.stiffness) * s;
    p = s * (s + Real100(b.damping.mass)) / viscous;
    gain = s * s / viscous;
  }

  /// [a_end; angular a_end; f_root; moment_root] by [f_end; moment_end; a0; a1]. v is the sum of
  /// c_i exp(r_i x) and the particular solution -(gain / p) (a0 + a1 x) / s^2; c follows from v =
  /// v' = 0 at the root, EI v'' = moment and EI v''' = -force at the end.
  Matrix4 bending() const {
    const Complex100 k = sqrt(sqrt(Complex100(-p * m / stiffness))), j(0, 1), s2 = s * s,
                     part = -gain / p / s2, elastic = stiffness * viscous;
    const std::array<Complex100, 4> r = {k, -k, Complex100(j * k), Complex100(-j * k)};
    Matrix4 conditions, loads = Matrix4::Zero();
    Row4 end, slope_end, integral, first_moment;  // of exp(r x): at L, and over the length
    for (Index i = 0; i < 4; ++i) {
      const Complex100 q = r[static_cast<std::size_t>(i)], e = exp(Complex100(q * L));
      conditions.col(i) << Complex100(1), q, Complex100(q * q * e), Complex100(q * q * q * e);
      end(i) = e, slope_end(i) = q * e;
      integral(i) = (e - 1) / q;
      first_moment(i) = L * e / q - (e - 1) / (q * q);
    }
    loads(3, 0) = -1 / elastic, loads(2, 1) = 1 / elastic;
    loads(0, 2) = loads(1, 3) = -part;
    const Matrix4 c = conditions.partialPivLu().solve(loads);
    const Complex100 L2 = L * L / 2, L3 = L * L * L / 3, rigid = 1 + s2 * part, inertia = -m * s2;
    Matrix4 Y;  // motion of the end; reactions at the root: loads less inertia
    Y.row(0) = s2 * (end * c), Y.row(1) = s2 * (slope_end * c);
    Y.row(2) = inertia * (integral * c), Y.row(3) = inertia * (first_moment * c);
    Y(0, 2) += rigid, Y(0, 3) += rigid * L, Y(1, 3) += rigid;
    Y(2, 0) += 1, Y(3, 0) += L, Y(3, 1) += 1;
    Y(2, 2) -= m * rigid * L, Y(2, 3) -= m * rigid * L2;
    Y(3, 2) -= m * rigid * L2, Y(3, 3) -= m * rigid * L3;
    return Y;
  }

  /// [a_end; f_root] by [f_end; a0], likewise with EA v' = force at the end.
  Matrix2 axial() const {
    const Complex100 k = sqrt(Complex100(p * m / stiffness)), e = exp(Complex100(k * L)),
                     s2 = s * s, part = -gain / p / s2, rigid = 1 + s2 * part;
    Matrix2 conditions, loads = Matrix2::Zero();
    conditions << Complex100(1), Complex100(1), Complex100(k * e), Complex100(-k / e);
    loads(1, 0) = 1 / (stiffness * viscous), loads(0, 1) = -part;
    const Matrix2 c = conditions.partialPivLu().solve(loads);
    Matrix2 Y;
    for (Index u = 0; u < 2; ++u) {
      Y(0, u) = s2 * (c(0, u) * e + c(1, u) / e);
      Y(1, u) = -m * s2 * (c(0, u) * (e - 1) / k - c(1, u) * (1 / e - 1) / k);
    }
    Y(0, 1) += rigid, Y(1, 0) += 1, Y(1, 1) -= m * rigid * L;
    return Y;
  }
};

Complex rounded(const Complex100& z) {
  return {static_cast<double>(z.real()), static_cast<double>(z.imag())};
}

}  // namespace

MatrixXcd beam_by_hand(const ExactBeam& b, Complex s) {
  const double A = b.section.area, rho = b.material.rho, E = b.material.E;
  MatrixXcd Y = MatrixXcd::Zero(12, 12);
  const auto add_axial = [&](Index i, double stiffness, double m) {
    const Matrix2 y = Strip(b, stiffness, m, s).axial();
    const std::array<Index, 2> at = {i, 6 + i};
    for (std::size_t r = 0; r < 2; ++r)
      for (std::size_t c = 0; c < 2; ++c)
        Y(at[r], at[c]) = rounded(y(static_cast<Index>(r), static_cast<Index>(c)));
  };
  const auto add_bending = [&](Index w, Index angle, double sign, double EI) {
    const Matrix4 y = Strip(b, EI, rho * A, s).bending();
    const std::array<Index, 4> at = {w, angle, 6 + w, 6 + angle};
    for (std::size_t r = 0; r < 4; ++r)
      for (std::size_t c = 0; c < 4; ++c)
        Y(at[r], at[c]) =
            (r % 2 == c % 2 ? 1 : sign) * rounded(y(static_cast<Index>(r), static_cast<Index>(c)));
  };
  add_axial(0, E * A, rho * A);
  add_axial(3, *b.material.G * b.section.J, rho * *b.section.I_x);
  add_bending(1, 5, 1, E * b.section.I_z);
  add_bending(2, 4, -1, E * b.section.I_y);
  return Y;
}

}  // namespace titop_test
