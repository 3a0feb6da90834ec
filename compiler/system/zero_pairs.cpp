#include <titop/compiler/solve/evaluate.hpp>
#include <titop/compiler/system/system_data.hpp>
#include <titop/compiler/system/zero_pairs.hpp>
#include <titop/graph/linalg/index.hpp>

namespace titop::detail {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using linalg::at;

/// Entries with the sizes of their blocks.
MatrixXd expanded(const MatrixXd& blocks, const PortGroups& rows, const PortGroups& cols) {
  MatrixXd result(rows.first.back(), cols.first.back());
  for (Index i = 0; i < blocks.rows(); ++i)
    for (Index j = 0; j < blocks.cols(); ++j)
      result(Eigen::seq(rows.first[at(i)], rows.first[at(i + 1)] - 1),
             Eigen::seq(cols.first[at(j)], cols.first[at(j + 1)] - 1))
          .setConstant(blocks(i, j));
  return result;
}

/// Raises the sizes of rows that are 0 altogether to those of the others of their group.
void raise_rows(Eigen::Ref<MatrixXd> sizes, const PortGroups& groups,
                const Eigen::ArrayX<bool>& zero) {
  for (Index g = 0; g < groups.size(); ++g) {
    const Index first = groups.first[at(g)], end = groups.first[at(g + 1)];
    Eigen::RowVectorXd largest = Eigen::RowVectorXd::Zero(sizes.cols());
    for (Index i = first; i < end; ++i)
      if (!zero(i)) largest = largest.cwiseMax(sizes.row(i));
    for (Index i = first; i < end; ++i)
      if (zero(i)) sizes.row(i) = sizes.row(i).cwiseMax(largest);
  }
}

}  // namespace

ZeroPairs::ZeroPairs(const SystemData& data, const std::vector<Eigen::MatrixXcd>& H)
    : outputs_(groups_of_outputs(data, all_outputs(data))),
      inputs_(groups_of_inputs(data, all_inputs(data))),
      zero_(Eigen::ArrayXX<bool>::Constant(outputs_.first.back(), inputs_.first.back(), true)) {
  for (const Eigen::MatrixXcd& here : H) {
    const MatrixXd block = expanded(block_sizes(here, outputs_, inputs_), outputs_, inputs_);
    zero_ = zero_ && here.array().abs() <= kEnough * block.array();
  }
}

MatrixXd ZeroPairs::cleared(const MatrixXd& sizes) const { return zero_.select(0.0, sizes); }

MatrixXd ZeroPairs::of_ports(MatrixXd sizes) const {
  raise_rows(sizes, outputs_, zero_.rowwise().all());
  MatrixXd columns = sizes.transpose();
  raise_rows(columns, inputs_, zero_.colwise().all().transpose());
  return columns.transpose();
}

}  // namespace titop::detail
