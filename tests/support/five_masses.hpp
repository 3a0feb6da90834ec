#pragma once

#include <array>
#include <complex>
#include <titop/titop.hpp>

/// [Alazard 2015] Fig. 7: five masses, 2 and 3 are mounted on 1, 4 and 5 on 2, 1 on the wall.
namespace titop_test {

using Five = std::array<double, 5>;

inline constexpr Five kMasses{5, 4, 3, 2, 1}, kStiffnesses{500, 300, 450, 260, 170};

/// s^2 M + K by hand.
inline Eigen::Matrix<std::complex<double>, 5, 5> impedance(const Five& m, const Five& k,
                                                           std::complex<double> s) {
  constexpr std::array<int, 5> hangs_on{-1, 0, 0, 1, 1};
  Eigen::Matrix<std::complex<double>, 5, 5> Z;
  Z.setZero();
  for (int i = 0; i < 5; ++i) {
    const auto at = static_cast<std::size_t>(i);
    const int p = hangs_on[at];
    Z(i, i) += m[at] * s * s + k[at];
    if (p < 0) continue;
    Z(p, p) += k[at];
    Z(i, p) -= k[at];
    Z(p, i) -= k[at];
  }
  return Z;
}

/// Positions of the five masses for the actuator u between masses 1 and 2: -u on 1, +u on 2.
Eigen::Matrix<std::complex<double>, 5, 1> positions(const Five& m, const Five& k,
                                                    std::complex<double> s);

/// The scene with these numbers; outputs x1 ... x5 (positions) and a3 (acceleration of mass 3).
titop::Diagram five_masses_scene(const Five& m, const Five& k);

/// The scene by `mount`; output x3 alone.
titop::Diagram third_of_five(const Five& m, const Five& k);

}  // namespace titop_test
