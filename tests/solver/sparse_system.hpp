#pragma once

#include <Eigen/Dense>
#include <string>
#include <titop/compiler/solve/elimination.hpp>
#include <vector>

#include "support/rng.hpp"

/// Block-sparse systems for the solver alone, without any diagram.
namespace solver_test {

using Eigen::MatrixXd;
using Eigen::VectorXd;
using titop::solve::RowEntries;
using titop::solve::Structure;

inline std::size_t at(int i) { return static_cast<std::size_t>(i); }

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
        A.block(row, first[at(structure.variables[r][k])], entries[r][k].rows(),
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
        entries[r][k] = A.block(row, first[at(structure.variables[r][k])], entries[r][k].rows(),
                                entries[r][k].cols());
      row += structure.row_size[r];
    }
  }
  /// Right-hand sides, row group by row group.
  std::vector<MatrixXd> split(const MatrixXd& b) const {
    std::vector<MatrixXd> result;
    int row = 0;
    for (const int n : structure.row_size) result.push_back(b.middleRows(row, n)), row += n;
    return result;
  }
};

inline Structure structure_of(const Links& links, const std::vector<int>& sizes) {
  Structure s;
  s.variable_size = s.row_size = sizes;
  s.variables.resize(sizes.size());
  for (std::size_t i = 0; i < sizes.size(); ++i) s.variables[i].push_back(static_cast<int>(i));
  for (const auto& [a, b] : links) {
    s.variables[at(a)].push_back(b);
    s.variables[at(b)].push_back(a);
  }
  for (auto& list : s.variables) std::sort(list.begin(), list.end());
  return s;
}

/// Entries in [-1, 1], plus `diagonal` on the diagonal; groups of 1, 3 and 6 scalars. The rows are
/// in random order, so that nothing hangs on where the pivots stand.
inline System random_system(const Links& links, int n, titop_test::Rng& rng, double diagonal) {
  std::vector<int> sizes;
  for (int i = 0; i < n; ++i) sizes.push_back(std::vector<int>{1, 1, 3, 6}[at(rng.below(4))]);
  System s{structure_of(links, sizes), {}};
  for (int r = 0; r < n; ++r) {
    RowEntries<double> row;
    for (const int v : s.structure.variables[at(r)]) {
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

}  // namespace solver_test
