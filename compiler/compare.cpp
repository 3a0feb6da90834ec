#include <algorithm>
#include <cmath>
#include <limits>
#include <titop/compiler/compare.hpp>

namespace titop::detail {

using Eigen::Index;
using Eigen::MatrixXd;

Difference difference(const std::vector<Eigen::MatrixXcd>& a,
                      const std::vector<Eigen::MatrixXcd>& exact) {
  Difference worst;
  if (exact.empty() || exact.front().size() == 0) return worst;
  MatrixXd size = MatrixXd::Zero(exact.front().rows(), exact.front().cols());
  for (const auto& G : exact) size = size.cwiseMax(G.cwiseAbs());
  // A row or a column that is 0 by nature holds nothing but rounding.
  const double all = size.maxCoeff() > 0 ? size.maxCoeff() : 1;
  const auto or_all = [all](double largest) { return largest > 1e-12 * all ? largest : all; };
  const Eigen::VectorXd rows = size.rowwise().maxCoeff().unaryExpr(or_all),
                        cols = size.colwise().maxCoeff().unaryExpr(or_all);
  for (Index i = 0; i < size.rows(); ++i)
    for (Index j = 0; j < size.cols(); ++j)
      size(i, j) = std::max(size(i, j), 1e-3 * std::sqrt(rows(i)) * std::sqrt(cols(j)));
  for (std::size_t k = 0; k < exact.size(); ++k) {
    const bool finite = a[k].allFinite() && exact[k].allFinite();
    for (Index i = 0; i < size.rows(); ++i)
      for (Index j = 0; j < size.cols(); ++j) {
        const double off = finite ? std::abs(a[k](i, j) - exact[k](i, j)) : HUGE_VAL;
        if (off > worst.relative * size(i, j)) worst = {off / size(i, j), k};
      }
  }
  return worst;
}

}  // namespace titop::detail
