#pragma once

#include <Eigen/Core>
#include <boost/multiprecision/cpp_bin_float.hpp>
#include <complex>
#include <titop/blocks/fe/modal_data.hpp>
#include <vector>

/// Transfers of chains in 150 digits, from the same doubles that the library is given: block
/// matrices by their formulas at s, then Gaussian elimination with partial pivoting. No library
/// code but `ModalData` and its plain fields.
namespace solve_test {

using Real = boost::multiprecision::number<boost::multiprecision::cpp_bin_float<150>,
                                           boost::multiprecision::et_off>;

struct Complex {
  Real re = 0, im = 0;

  Complex() = default;
  Complex(const Real& r, const Real& i = 0) : re(r), im(i) {}
  Complex(double r) : re(r) {}
  explicit Complex(std::complex<double> z) : re(z.real()), im(z.imag()) {}
  bool is_zero() const { return re == 0 && im == 0; }
  Real squared() const { return re * re + im * im; }
};
inline Complex operator+(const Complex& a, const Complex& b) { return {a.re + b.re, a.im + b.im}; }
inline Complex operator-(const Complex& a, const Complex& b) { return {a.re - b.re, a.im - b.im}; }
inline Complex operator*(const Complex& a, const Complex& b) {
  return {a.re * b.re - a.im * b.im, a.re * b.im + a.im * b.re};
}
inline Complex operator/(const Complex& a, const Complex& b) {
  const Real d = b.squared();
  return {(a.re * b.re + a.im * b.im) / d, (a.im * b.re - a.re * b.im) / d};
}

struct BigMatrix {
  int rows, cols;
  std::vector<Complex> entries;

  BigMatrix(int r, int c) : rows(r), cols(c), entries(static_cast<std::size_t>(r * c)) {}
  explicit BigMatrix(const Eigen::MatrixXd& m)
      : BigMatrix(static_cast<int>(m.rows()), static_cast<int>(m.cols())) {
    for (int i = 0; i < rows; ++i)
      for (int j = 0; j < cols; ++j) (*this)(i, j) = Complex(m(i, j));
  }
  Complex& operator()(int i, int j) { return entries[static_cast<std::size_t>(i * cols + j)]; }
  const Complex& operator()(int i, int j) const {
    return entries[static_cast<std::size_t>(i * cols + j)];
  }
};
inline BigMatrix operator*(const BigMatrix& a, const BigMatrix& b) {
  BigMatrix c(a.rows, b.cols);
  for (int i = 0; i < a.rows; ++i)
    for (int k = 0; k < a.cols; ++k)
      if (!a(i, k).is_zero())
        for (int j = 0; j < b.cols; ++j) c(i, j) = c(i, j) + a(i, k) * b(k, j);
  return c;
}

/// X = E^-1 F in place of F; zeros of E are skipped, so that banded systems cost little.
inline BigMatrix solve(BigMatrix E, BigMatrix F) {
  const int n = E.rows;
  for (int k = 0; k < n; ++k) {
    int best = k;
    for (int i = k + 1; i < n; ++i)
      if (E(i, k).squared() > E(best, k).squared()) best = i;
    for (int j = 0; j < n; ++j) std::swap(E(best, j), E(k, j));
    for (int j = 0; j < F.cols; ++j) std::swap(F(best, j), F(k, j));
    std::vector<int> right;
    for (int j = k + 1; j < n; ++j)
      if (!E(k, j).is_zero()) right.push_back(j);
    for (int i = k + 1; i < n; ++i) {
      if (E(i, k).is_zero()) continue;
      const Complex l = E(i, k) / E(k, k);
      for (const int j : right) E(i, j) = E(i, j) - l * E(k, j);
      for (int j = 0; j < F.cols; ++j)
        if (!F(k, j).is_zero()) F(i, j) = F(i, j) - l * F(k, j);
    }
  }
  for (int k = n - 1; k >= 0; --k)
    for (int c = 0; c < F.cols; ++c) {
      for (int j = k + 1; j < n; ++j)
        if (!E(k, j).is_zero()) F(k, c) = F(k, c) - E(k, j) * F(j, c);
      F(k, c) = F(k, c) / E(k, k);
    }
  return F;
}

/// (14) at s for a body with one child: [xdd_C; F_P] by [F_C; xdd_P], 12 x 12. The direct term is
/// formed in 150 digits from L_P, Phi_C and D_P.
inline BigMatrix modal_transfer(const titop::ModalData& d, const Complex& s) {
  const titop::ModalChild& c = d.children.front();
  BigMatrix Y(12, 12);
  for (int i = 0; i < 6; ++i) {
    Y(i, 6 + i) = Complex(1);
    Y(6 + i, i) = Complex(1);
    for (int j = 0; j < 6; ++j) Y(6 + i, 6 + j) = Complex(-d.D_P(i, j));
  }
  // tau_CP with CP = -PC in its upper right corner.
  const double x = -c.PC.x(), y = -c.PC.y(), z = -c.PC.z();
  const double cross[3][3] = {{0, -z, y}, {z, 0, -x}, {-y, x, 0}};
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) {
      Y(i, 9 + j) = Complex(cross[i][j]);
      Y(9 + j, i) = Complex(cross[i][j]);
    }
  for (int k = 0; k < d.omega.size(); ++k) {
    const Real w = d.omega(k), xi = d.xi(k);
    const Complex gain = s * s / (s * s + Complex(2 * xi * w) * s + Complex(w * w));
    std::vector<Complex> row;
    for (int i = 0; i < 6; ++i) row.emplace_back(c.Phi_C(i, k));
    for (int i = 0; i < 6; ++i) row.emplace_back(-d.L_P(k, i));
    for (int i = 0; i < 12; ++i)
      for (int j = 0; j < 12; ++j)
        Y(i, j) =
            Y(i, j) + gain * row[static_cast<std::size_t>(i)] * row[static_cast<std::size_t>(j)];
  }
  return Y;
}

/// (6) with damping at s: [xdd_C; f_P] by [f_C; xdd_P].
inline BigMatrix spring_transfer(double m, double k, double c, double m0, const Complex& s) {
  const Complex spring = Complex(k) + Complex(c) * s, den = Complex(m) * s * s + spring;
  BigMatrix Y(2, 2);
  Y(0, 0) = s * s / den;
  Y(0, 1) = Y(1, 0) = spring / den;
  Y(1, 1) = Complex(-m0) - Complex(m) * spring / den;
  return Y;
}

/// Chain of two-ports Y[i] with p degrees of freedom per junction, T[i] from the frame of body i +
/// 1 to that of body i; wrench U at the free root (F_P = -U), nothing at the tip. Returns the
/// accelerations [xdd at the root; xdd at the tip], 2p x p.
inline BigMatrix chain_transfer(const std::vector<BigMatrix>& Y, const std::vector<BigMatrix>& T,
                                int p) {
  const int n = static_cast<int>(Y.size()), size = (2 * n + 1) * p;
  // Unknowns body by body: xdd_P, F_P; at last xdd at the tip.
  BigMatrix E(size, size), F(size, p);
  int row = 0;
  for (int i = 0; i < p; ++i, ++row) {
    E(row, p + i) = Complex(1);
    F(row, i) = Complex(-1);
  }
  for (int b = 0; b < n; ++b) {
    const BigMatrix& y = Y[static_cast<std::size_t>(b)];
    const int a_P = 2 * b * p, F_P = a_P + p, a_next = a_P + 2 * p, F_next = a_next + p;
    for (int i = 0; i < p; ++i, ++row) {  // xdd_C = T a_next, F_C = T F_next
      for (int j = 0; j < p; ++j) E(row, a_P + j) = y(i, p + j);
      for (int j = 0; j < p; ++j) {
        if (b + 1 == n) {
          E(row, a_next + j) = Complex(i == j ? -1.0 : 0.0);
          continue;
        }
        const BigMatrix& t = T[static_cast<std::size_t>(b)];
        E(row, a_next + j) = Complex(0) - t(i, j);
        for (int k = 0; k < p; ++k) E(row, F_next + j) = E(row, F_next + j) + y(i, k) * t(k, j);
      }
    }
    for (int i = 0; i < p; ++i, ++row) {
      E(row, F_P + i) = Complex(-1);
      for (int j = 0; j < p; ++j) E(row, a_P + j) = y(p + i, p + j);
      for (int j = 0; b + 1 < n && j < p; ++j)
        for (int k = 0; k < p; ++k)
          E(row, F_next + j) =
              E(row, F_next + j) + y(p + i, k) * T[static_cast<std::size_t>(b)](k, j);
    }
  }
  const BigMatrix z = solve(std::move(E), std::move(F));
  BigMatrix result(2 * p, p);
  for (int j = 0; j < p; ++j)
    for (int i = 0; i < p; ++i) {
      result(i, j) = z(i, j);
      result(p + i, j) = z(2 * n * p + i, j);
    }
  return result;
}

/// Rounded to double.
inline Eigen::MatrixXcd rounded(const BigMatrix& m) {
  Eigen::MatrixXcd result(m.rows, m.cols);
  for (int i = 0; i < m.rows; ++i)
    for (int j = 0; j < m.cols; ++j)
      result(i, j) = {static_cast<double>(m(i, j).re), static_cast<double>(m(i, j).im)};
  return result;
}

}  // namespace solve_test
