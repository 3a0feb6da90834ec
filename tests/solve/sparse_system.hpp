#pragma once

#include <memory>
#include <string>
#include <titop/compiler/solve/elimination.hpp>
#include <titop/graph/linalg/eigen.hpp>
#include <titop/graph/linalg/index.hpp>
#include <vector>

#include "support/rng.hpp"

/// Block-sparse systems for the solver alone, without any diagram.
namespace solve_test {

using Eigen::MatrixXd;
using Eigen::VectorXd;
using titop::solve::RowMatrix;
using titop::solve::Structure;

/// Coefficient blocks of one row group, in the order of its variables.
template <class T>
using RowEntries = std::vector<Eigen::Matrix<T, Eigen::Dynamic, Eigen::Dynamic>>;

template <class T>
class EntryRows : public titop::solve::Rows<T> {
 public:
  explicit EntryRows(const std::vector<RowEntries<T>>& entries) : entries_(entries) {}
  void add(int r, T* to, std::ptrdiff_t stride, const int* column) const override {
    for (const auto& block : entries_[static_cast<std::size_t>(r)]) {
      for (Eigen::Index i = 0; i < block.rows(); ++i)
        for (Eigen::Index j = 0; j < block.cols(); ++j) to[i * stride + *column + j] += block(i, j);
      ++column;
    }
  }

 private:
  const std::vector<RowEntries<T>>& entries_;
};

template <class T>
titop::solve::Factors<T> factors_of(const Structure& structure,
                                    const std::vector<RowEntries<T>>& entries) {
  return {std::make_shared<const titop::solve::Plan>(plan(structure)), EntryRows<T>(entries)};
}

/// Unknowns in the order of the variables.
template <class T>
Eigen::Matrix<T, Eigen::Dynamic, Eigen::Dynamic> solve(const titop::solve::Factors<T>& factors,
                                                       const RowMatrix<T>& b) {
  const RowMatrix<T> z = factors.solve(b);
  Eigen::Matrix<T, Eigen::Dynamic, Eigen::Dynamic> x(z.rows(), z.cols());
  Eigen::Index row = 0;
  const auto& plan = factors.plan();
  for (std::size_t v = 0; v < plan.first.size(); ++v) {
    const int size = plan.structure.variable_size[v];
    x.middleRows(row, size) = z.middleRows(plan.first[v], size);
    row += size;
  }
  return x;
}

/// Of the transposed matrix: right-hand sides by variable, unknowns by row.
template <class T>
Eigen::Matrix<T, Eigen::Dynamic, Eigen::Dynamic> solve_transposed(
    const titop::solve::Factors<T>& factors,
    const Eigen::Matrix<T, Eigen::Dynamic, Eigen::Dynamic>& b) {
  RowMatrix<T> rhs(b.rows(), b.cols());
  Eigen::Index row = 0;
  const auto& plan = factors.plan();
  for (std::size_t v = 0; v < plan.first.size(); ++v) {
    const int size = plan.structure.variable_size[v];
    rhs.middleRows(plan.first[v], size) = b.middleRows(row, size);
    row += size;
  }
  return factors.solve_transposed(rhs);
}

using titop::linalg::at;

/// Pairs of groups that see each other; group i also sees itself.
using Links = std::vector<std::pair<int, int>>;

inline Links chain(int n) {
  Links links;
  for (int i = 1; i < n; ++i) links.emplace_back(i - 1, i);
  return links;
}
inline Links ring(int n) {
  Links links = chain(n);
  links.emplace_back(0, n - 1);
  return links;
}
inline Links star(int n) {
  Links links;
  for (int i = 1; i < n; ++i) links.emplace_back(0, i);
  return links;
}
inline Links tree(int n, titop_test::Rng& rng) {
  Links links;
  for (int i = 1; i < n; ++i) links.emplace_back(rng.below(i), i);
  return links;
}
inline Links grid(int width, int height) {
  Links links;
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x) {
      if (x > 0) links.emplace_back(y * width + x - 1, y * width + x);
      if (y > 0) links.emplace_back((y - 1) * width + x, y * width + x);
    }
  return links;
}
inline Links dense(int n) {
  Links links;
  for (int i = 0; i < n; ++i)
    for (int j = 0; j < i; ++j) links.emplace_back(j, i);
  return links;
}

struct System {
  Structure structure;
  std::vector<RowEntries<double>> entries;

  int size() const {
    int total = 0;
    for (const int n : structure.variable_size) total += n;
    return total;
  }
  MatrixXd to_dense() const {
    std::vector<int> first;
    int total = 0;
    for (const int n : structure.variable_size) first.push_back(total), total += n;
    MatrixXd A = MatrixXd::Zero(total, total);
    int row = 0;
    for (std::size_t r = 0; r < entries.size(); ++r) {
      for (std::size_t k = 0; k < entries[r].size(); ++k)
        A.block(row, first[at(structure.row(static_cast<int>(r))[k])], entries[r][k].rows(),
                entries[r][k].cols()) = entries[r][k];
      row += structure.row_size[r];
    }
    return A;
  }
  /// Takes the entries of another matrix of the same structure.
  void from_dense(const MatrixXd& A) {
    std::vector<int> first;
    int total = 0;
    for (const int n : structure.variable_size) first.push_back(total), total += n;
    int row = 0;
    for (std::size_t r = 0; r < entries.size(); ++r) {
      for (std::size_t k = 0; k < entries[r].size(); ++k)
        entries[r][k] = A.block(row, first[at(structure.row(static_cast<int>(r))[k])],
                                entries[r][k].rows(), entries[r][k].cols());
      row += structure.row_size[r];
    }
  }
};

inline Structure structure_of(const Links& links, const std::vector<int>& sizes) {
  std::vector<std::vector<int>> over(sizes.size());
  for (std::size_t i = 0; i < sizes.size(); ++i) over[i].push_back(static_cast<int>(i));
  for (const auto& [a, b] : links) {
    over[at(a)].push_back(b);
    over[at(b)].push_back(a);
  }
  Structure s;
  for (const int size : sizes) s.add_variable(size);
  for (std::size_t i = 0; i < sizes.size(); ++i) s.add_row(sizes[i], over[i]);
  return s;
}

/// Entries in [-1, 1], plus `diagonal` on the diagonal; groups of 1, 3 and 6 scalars. The rows are
/// in random order, so that the places of pivots do not matter.
inline System random_system(const Links& links, int n, titop_test::Rng& rng, double diagonal) {
  std::vector<int> sizes;
  for (int i = 0; i < n; ++i) sizes.push_back(std::vector<int>{1, 1, 3, 6}[at(rng.below(4))]);
  System s{structure_of(links, sizes), {}};
  for (int r = 0; r < n; ++r) {
    RowEntries<double> row;
    for (const int v : s.structure.row(r)) {
      MatrixXd block = rng.matrix(sizes[at(r)], sizes[at(v)]);
      if (v == r) block += diagonal * MatrixXd::Identity(sizes[at(r)], sizes[at(r)]);
      row.push_back(block);
    }
    s.entries.push_back(row);
  }
  return s;
}

struct Kind {
  std::string name;
  Links links;
  int n;
};
/// One of each shape, sizes drawn anew.
inline std::vector<Kind> kinds(titop_test::Rng& rng) {
  const int n = 2 + rng.below(20);
  return {{"chain", chain(n), n},    {"ring", ring(n + 1), n + 1}, {"star", star(n), n},
          {"tree", tree(n, rng), n}, {"grid", grid(4, 3), 12},     {"dense", dense(6), 6}};
}

}  // namespace solve_test
