#include <titop/compiler/definition/exact/solve.hpp>
#include <titop/graph/linalg/index.hpp>

namespace titop::exact {
namespace {

using Eigen::Index;
using linalg::at;

SparseRow joined_row(const ExactMatrix& E, const ExactMatrix* F, Index i) {
  SparseRow row;
  for (Index j = 0; j < E.cols; ++j)
    if (E(i, j) != 0) row.emplace_back(static_cast<int>(j), E(i, j));
  for (Index j = 0; F && j < F->cols; ++j)
    if ((*F)(i, j) != 0) row.emplace_back(static_cast<int>(E.cols + j), (*F)(i, j));
  return row;
}

/// Adds the rows of m, sparse, to those of the matrix, from this column on.
void add_rows(ExactMatrix& to, Index column, const std::vector<SparseRow>& rows) {
  for (std::size_t i = 0; i < rows.size(); ++i)
    for (const auto& [j, value] : rows[i]) to(static_cast<Index>(i), column + j) += value;
}

}  // namespace

ExactMatrix solved(const ExactMatrix& E, const ExactMatrix& F) {
  Echelon rows;
  for (Index i = 0; i < E.rows; ++i) rows.add(joined_row(E, &F, i));
  ExactMatrix X(E.cols, F.cols);
  for (Index i = E.cols - 1; i >= 0; --i) {
    const auto found = rows.rows().find(static_cast<int>(i));
    if (found == rows.rows().end()) throw Undecided{"a matrix is singular"};
    for (auto e = found->second.begin() + 1; e != found->second.end(); ++e) {
      if (e->first >= E.cols) {
        X(i, e->first - E.cols) += e->second;
        continue;
      }
      for (Index j = 0; j < F.cols; ++j)
        if (X(e->first, j) != 0) X(i, j) -= e->second * X(e->first, j);
    }
  }
  return X;
}

ExactMatrix transfer_of(const Model& m, const Residue& s) {
  const Index n = m.states, nu = static_cast<Index>(m.B.size()),
              ny = static_cast<Index>(m.C.size());
  ExactMatrix E(n, n), B(n, nu), C(ny, n), result(ny, nu);
  for (Index i = 0; i < n; ++i) {
    E(i, i) = s;
    for (const auto& [row, value] : m.A.columns[at(i)]) E(row, i) -= value;
  }
  for (Index j = 0; j < nu; ++j)
    for (const auto& [row, value] : m.B[at(j)]) B(row, j) = value;
  add_rows(C, 0, m.C);
  result = C * solved(E, B);
  add_rows(result, 0, m.D);
  return result;
}

int rank_of(const ExactMatrix& m) {
  Echelon rows;
  for (Index i = 0; i < m.rows; ++i) rows.add(joined_row(m, nullptr, i));
  return rows.rank();
}

}  // namespace titop::exact
