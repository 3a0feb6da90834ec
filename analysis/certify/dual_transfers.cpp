#include <algorithm>
#include <titop/analysis/certify/dual_transfers.hpp>
#include <titop/compiler/system/elimination_terms.hpp>

namespace titop::certification {

using Eigen::MatrixXd;

double DualTransfers::floor(Eigen::Index row, Eigen::Index column, Eigen::Index rows,
                            Eigen::Index columns) const {
  if (by.terms.size() == 0) return 0;
  return detail::kLeastSize * std::max(by.terms.block(row, column, rows, columns).maxCoeff(),
                                       by.terms.block(column, row, columns, rows).maxCoeff());
}

DualTransfers dual_transfers(const passes::DualPairs& pairs,
                             const std::vector<std::complex<double>>& points,
                             const std::vector<Eigen::MatrixXcd>& transfers) {
  DualTransfers result{points, {}, {pairs.sizes, pairs.sizes}};
  for (const Eigen::MatrixXcd& G : transfers) result.G.push_back(G(pairs.out, pairs.in));
  return result;
}

DualTransfers with_rounding(const System& system, const passes::DualPairs& pairs,
                            DualTransfers transfers) {
  // At all points: rounding may show at one of them only.
  const MatrixXd terms = detail::terms(detail::data_of(system), transfers.points);
  detail::add_rounding(transfers.by, transfers.G, terms(pairs.out, pairs.in));
  return transfers;
}

}  // namespace titop::certification
