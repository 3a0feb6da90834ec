#pragma once

#include <array>
#include <complex>
#include <numeric>
#include <string>
#include <titop/blocks/fe/mesh.hpp>
#include <titop/graph/linalg/eigen.hpp>
#include <vector>

/// Reference of the tests of this folder: the same structure without modes.
namespace fe_test {

using titop::Matrix6;
using titop::Vector3d;
using Complex = std::complex<double>;

/// |a - b| / |b|.
inline double relative(double a, double b) { return std::abs(a - b) / std::abs(b); }

/// (14) at s, typed from the paper: rows xdd_C of each child, then F_A/P; columns F_C of each
/// child, then xdd_P.
Eigen::MatrixXcd modal_transfer(const titop::ModalData& d, Complex s);

/// The same from M and K, without modes: x = R x_P + q, (s^2 M + (1 + beta s) K)(R x_P + q) = F
/// with q = 0 at P, solved by LU in the wanted scalar. Damping beta K, beta in s. Real: double or
/// long double.
template <class Real = double>
Eigen::MatrixXcd direct_transfer(const titop::fe::Mesh& mesh, const std::string& parent,
                                 const std::vector<std::string>& children, Complex s_double,
                                 double beta = 0);

}  // namespace fe_test
