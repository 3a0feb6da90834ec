#include <algorithm>
#include <limits>
#include <numeric>
#include <titop/compiler/definition/compare.hpp>
#include <titop/compiler/solve/backward_error.hpp>
#include <titop/compiler/solve/transfer_blocks.hpp>
#include <titop/graph/linalg/index.hpp>

namespace titop::detail {
namespace {

using Eigen::Index;
using linalg::at;
using solve::kUnderflow;

/// `list`: all inputs or outputs of the graph, with their first places.
template <class List>
PortGroups groups_of(const List& list, const std::vector<int>& first,
                     const std::vector<int>& ports) {
  constexpr int kDual = 6, kHalf = 3;
  std::vector<int> all;
  for (std::size_t i = 0; i < list.size(); ++i) {
    all.push_back(first[i]);
    if (list[i].size == kDual) all.push_back(first[i] + kHalf);
  }
  std::sort(all.begin(), all.end());
  PortGroups g;
  const auto add = [&](int place, int size) {
    g.index.push_back(std::lower_bound(all.begin(), all.end(), place) - all.begin());
    g.first.push_back(g.first.back() + size);
  };
  for (const int p : ports) {
    const bool dual = list[at(p)].size == kDual;
    add(first[at(p)], dual ? kHalf : list[at(p)].size);
    if (dual) add(first[at(p)] + kHalf, kHalf);
  }
  return g;
}

/// The ports by their places.
std::vector<int> by_place(const std::vector<int>& first) {
  std::vector<int> ports(first.size());
  std::iota(ports.begin(), ports.end(), 0);
  std::sort(ports.begin(), ports.end(), [&](int a, int b) { return first[at(a)] < first[at(b)]; });
  return ports;
}

}  // namespace

PortGroups groups_of_inputs(const Factored& d, const std::vector<int>& ports) {
  return groups_of(d.graph().inputs, d.layout().input_first, ports);
}

PortGroups groups_of_outputs(const Factored& d, const std::vector<int>& ports) {
  return groups_of(d.graph().outputs, d.layout().output_first, ports);
}

std::vector<int> all_inputs(const Factored& d) { return by_place(d.layout().input_first); }
std::vector<int> all_outputs(const Factored& d) { return by_place(d.layout().output_first); }

Eigen::MatrixXd block_sizes(const Eigen::MatrixXcd& m, const PortGroups& rows,
                            const PortGroups& cols) {
  Eigen::MatrixXd result(rows.size(), cols.size());
  const auto length = [](const PortGroups& g, Index i) {
    return g.first[at(i + 1)] - g.first[at(i)];
  };
  for (Index i = 0; i < result.rows(); ++i)
    for (Index j = 0; j < result.cols(); ++j)
      result(i, j) = m.block(rows.first[at(i)], cols.first[at(j)], length(rows, i), length(cols, j))
                         .cwiseAbs()
                         .maxCoeff();
  return result;
}

Eigen::MatrixXd beside_blocks(const Eigen::MatrixXd& size) {
  if (size.size() == 0) return size;
  return size.rowwise().maxCoeff().cwiseSqrt() * size.colwise().maxCoeff().cwiseSqrt();
}

double relative_change(const Eigen::MatrixXcd& of, const Eigen::MatrixXcd& change,
                       const PortGroups& rows, const PortGroups& cols,
                       const std::function<ZeroBlock(Index, Index)>& zero) {
  if (!of.allFinite() || !change.allFinite()) return std::numeric_limits<double>::infinity();
  const Eigen::MatrixXd size = block_sizes(of, rows, cols), off = block_sizes(change, rows, cols);
  // A block that is 0 by symmetry is rounding alone: it counts relative to its neighbours.
  const Eigen::MatrixXd around = beside_blocks(size);
  double worst = 0;
  for (Index i = 0; i < size.rows(); ++i)
    for (Index j = 0; j < size.cols(); ++j) {
      if (off(i, j) <= kUnderflow) continue;
      const ZeroBlock noise = size(i, j) <= kNoise * off(i, j) ? zero(i, j) : ZeroBlock::no;
      const double beside = noise == ZeroBlock::no ? size(i, j) : around(i, j);
      // If all are 0 there is no size to compare with.
      const double of_none = noise == ZeroBlock::confirmed ? 0 : 1;
      worst = std::max(worst, beside > 0 ? off(i, j) / beside : of_none);
    }
  return worst;
}

}  // namespace titop::detail
