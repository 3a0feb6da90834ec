#include <titop/blocks/fe/hermite.hpp>

namespace titop::fe {

using Eigen::Matrix4d;

Matrix4d hermite_mass(double a) {
  Matrix4d M;
  M << 156, 22 * a, 54, -13 * a, 22 * a, 4 * a * a, 13 * a, -3 * a * a, 54, 13 * a, 156, -22 * a,
      -13 * a, -3 * a * a, -22 * a, 4 * a * a;
  return M;
}

Matrix4d hermite_bending(double a) {
  Matrix4d K;
  K << 12, 6 * a, -12, 6 * a, 6 * a, 4 * a * a, -6 * a, 2 * a * a, -12, -6 * a, 12, -6 * a, 6 * a,
      2 * a * a, -6 * a, 4 * a * a;
  return K;
}

HermiteIntegrals hermite_integrals(double h) {
  HermiteIntegrals of{hermite_mass(h) * (h / 420), {}, hermite_bending(h) / (h * h * h), {}};
  of.slopes << 36, 3 * h, -36, 3 * h, 3 * h, 4 * h * h, -3 * h, -h * h, -36, -3 * h, 36, -3 * h,
      3 * h, -h * h, -3 * h, 4 * h * h;
  of.slopes /= 30 * h;
  // By parts: f'' f is f' f at the two ends less f' f'.
  of.mixed = -of.slopes;
  of.mixed(3, 2) += 1;
  of.mixed(1, 0) -= 1;
  return of;
}

}  // namespace titop::fe
