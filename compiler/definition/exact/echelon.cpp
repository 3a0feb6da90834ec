#include <titop/compiler/definition/exact/echelon.hpp>

namespace titop::exact {
namespace {

/// row - factor * pivot, whose leading column is the row's and cancels.
SparseRow cancel(const SparseRow& row, const SparseRow& pivot) {
  const Residue factor = row.front().second;
  SparseRow result;
  result.reserve(row.size() + pivot.size());
  auto i = row.begin() + 1;
  auto j = pivot.begin() + 1;
  while (i != row.end() || j != pivot.end()) {
    if (j == pivot.end() || (i != row.end() && i->first < j->first)) {
      result.push_back(*i);
      ++i;
    } else if (i == row.end() || j->first < i->first) {
      result.emplace_back(j->first, -(factor * j->second));
      ++j;
    } else {
      if (const Residue value = i->second - factor * j->second; value != 0)
        result.emplace_back(i->first, value);
      ++i, ++j;
    }
  }
  return result;
}

}  // namespace

SparseRow to_row(const Entries& entries) {
  SparseRow row;
  for (const auto& [column, value] : entries)
    if (value != 0) row.emplace_back(column, value);
  return row;
}

SparseRow Echelon::reduced(SparseRow row) const {
  while (!row.empty()) {
    const auto pivot = rows_.find(row.front().first);
    if (pivot == rows_.end()) break;
    row = cancel(row, pivot->second);
  }
  return row;
}

bool Echelon::add(SparseRow row) {
  row = reduced(std::move(row));
  if (row.empty()) return false;
  const Residue factor = row.front().second.inverse();
  for (auto& [column, value] : row) value *= factor;
  const int leading = row.front().first;
  rows_.emplace(leading, std::move(row));
  return true;
}

SparseRow Square::times(const SparseRow& v) const {
  Entries sum;
  for (const auto& [column, factor] : v)
    for (const auto& [row, value] : columns[static_cast<std::size_t>(column)])
      sum[row] += value * factor;
  return to_row(sum);
}

Echelon krylov(const Square& M, std::vector<SparseRow> start) {
  Echelon space;
  for (std::size_t next = 0; next < start.size(); ++next) {
    // The reduced row spans the same, and is shorter.
    SparseRow v = space.reduced(start[next]);
    if (v.empty()) continue;
    start.push_back(M.times(v));
    space.add(std::move(v));
  }
  return space;
}

int rank_of_products(const Echelon& a, const Echelon& b) {
  Echelon products;
  for (const auto& [leading, row] : a.rows()) {
    std::vector<Residue> dense(static_cast<std::size_t>(row.back().first) + 1);
    for (const auto& [column, value] : row) dense[static_cast<std::size_t>(column)] = value;
    SparseRow product;
    int column = 0;
    for (const auto& [other, entries] : b.rows()) {
      Residue sum;
      for (const auto& [k, value] : entries)
        if (const auto i = static_cast<std::size_t>(k); i < dense.size()) sum += value * dense[i];
      if (sum != 0) product.emplace_back(column, sum);
      ++column;
    }
    products.add(std::move(product));
  }
  return products.rank();
}

}  // namespace titop::exact
