#include <fmt/format.h>

#include <titop/analysis/reduction/real_modes.hpp>
#include <titop/analysis/reduction/small.hpp>
#include <titop/graph/linalg/dense.hpp>

namespace titop::detail {
namespace {

using Complex = std::complex<double>;
using Eigen::Index;
using Eigen::MatrixXd;

}  // namespace

RealModes real_modes(const MatrixXd& A, const char* instead) {
  const linalg::Eigensystem e = linalg::eigensystem(A);
  if (!(e.rcond_V > kDefective))
    throw Error(
        Code::singular,
        fmt::format("the reduced system's damped modes are too close to defective for blocks "
                    "of 2 x 2: eigenvectors of reciprocal condition {:.1e}",
                    e.rcond_V),
        fmt::format("take {}, which needs no eigenvectors", instead));
  RealModes m{MatrixXd(A.rows(), A.cols()), {}, {}};
  std::vector<Index> real;
  Index column = 0;
  for (Index k = 0; k < e.values.size(); ++k) {
    const Complex p = e.values(k);
    if (p.imag() == 0) real.push_back(k);
    if (p.imag() <= 0) continue;
    m.T.col(column++) = e.V.col(k).real();
    m.T.col(column++) = e.V.col(k).imag();
    m.A.push_back((Eigen::Matrix2d() << p.real(), p.imag(), -p.imag(), p.real()).finished());
  }
  for (std::size_t k = 0; k + 1 < real.size(); k += 2) {
    m.T.col(column++) = e.V.col(real[k]).real();
    m.T.col(column++) = e.V.col(real[k + 1]).real();
    m.A.push_back(
        Eigen::Vector2d(e.values(real[k]).real(), e.values(real[k + 1]).real()).asDiagonal());
  }
  if (real.size() % 2 == 1) {
    m.T.col(column) = e.V.col(real.back()).real();
    m.single.push_back(e.values(real.back()).real());
  }
  return m;
}

}  // namespace titop::detail
