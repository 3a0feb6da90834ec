#include <fmt/format.h>

#include <algorithm>
#include <titop/compiler/definition/exact/integers.hpp>

namespace titop::exact {
namespace {

/// Divides a row by the common divisor of its entries.
void shorten(IntegerRow& row) {
  Integer common = 0;
  for (const auto& [column, value] : row) {
    common = gcd(common, value);
    if (common == 1) return;
  }
  for (auto& [column, value] : row) value /= common;
}

/// a * row - b * pivot, both of the same leading column, which cancels.
IntegerRow cancel(const IntegerRow& row, const IntegerRow& pivot) {
  const Integer common = gcd(row.front().second, pivot.front().second);
  const Integer a = pivot.front().second / common, b = row.front().second / common;
  IntegerRow result;
  result.reserve(row.size() + pivot.size());
  auto i = row.begin() + 1;
  auto j = pivot.begin() + 1;
  while (i != row.end() || j != pivot.end()) {
    if (j == pivot.end() || (i != row.end() && i->first < j->first)) {
      result.emplace_back(i->first, a * i->second);
      ++i;
    } else if (i == row.end() || j->first < i->first) {
      result.emplace_back(j->first, -b * j->second);
      ++j;
    } else {
      if (Integer value = a * i->second - b * j->second; value != 0)
        result.emplace_back(i->first, std::move(value));
      ++i, ++j;
    }
  }
  shorten(result);
  return result;
}

}  // namespace

IntegerRow to_row(const Fractions& entries) {
  Integer common = 1;
  for (const auto& [column, value] : entries) common = lcm(common, denominator(value));
  IntegerRow row;
  for (const auto& [column, value] : entries)
    if (value != 0) row.emplace_back(column, numerator(value) * (common / denominator(value)));
  shorten(row);
  return row;
}

IntegerRow Echelon::reduced(IntegerRow row) const {
  while (!row.empty()) {
    const auto pivot = rows_.find(row.front().first);
    if (pivot == rows_.end()) break;
    row = cancel(row, pivot->second);
  }
  return row;
}

bool Echelon::add(IntegerRow row) {
  row = reduced(std::move(row));
  if (row.empty()) return false;
  for (const auto& [column, value] : row)
    if (static_cast<long>(msb(abs(value))) > bits_)
      throw Undecided{fmt::format("its integers exceed {} bits (ExactOptions::bits)", bits_)};
  const int leading = row.front().first;
  rows_.emplace(leading, std::move(row));
  return true;
}

IntegerRow Square::times(const IntegerRow& v) const {
  std::map<int, Integer> sum;
  for (const auto& [column, factor] : v)
    for (const auto& [row, value] : columns[static_cast<std::size_t>(column)])
      sum[row] += value * factor;
  IntegerRow result;
  for (auto& [row, value] : sum)
    if (value != 0) result.emplace_back(row, std::move(value));
  shorten(result);
  return result;
}

Echelon krylov(const Square& M, std::vector<IntegerRow> start, int bits) {
  Echelon space(bits);
  for (std::size_t next = 0; next < start.size(); ++next) {
    // The reduced row spans the same, and is shorter.
    IntegerRow v = space.reduced(start[next]);
    if (v.empty()) continue;
    start.push_back(M.times(v));
    space.add(std::move(v));
  }
  return space;
}

int rank_of_products(const Echelon& a, const Echelon& b, int bits) {
  Echelon products(bits);
  for (const auto& [leading, row] : a.rows()) {
    std::map<int, Integer> dense(row.begin(), row.end());
    IntegerRow product;
    int column = 0;
    for (const auto& [other, entries] : b.rows()) {
      Integer sum = 0;
      for (const auto& [k, value] : entries)
        if (const auto found = dense.find(k); found != dense.end()) sum += value * found->second;
      if (sum != 0) product.emplace_back(column, std::move(sum));
      ++column;
    }
    products.add(std::move(product));
  }
  return products.rank();
}

}  // namespace titop::exact
