#include <algorithm>
#include <cmath>
#include <titop/compiler/solve/equilibration.hpp>
#include <titop/compiler/solve/scalar.hpp>
#include <titop/graph/linalg/index.hpp>

namespace titop::solve {
namespace {

using linalg::at;

/// Each halves the remaining exponents, up to the coupling of rows and columns: of 2^60 remain
/// about two.
constexpr int kSweeps = 5;

/// The largest entry of a scalar row in one unit.
struct LargestEntry {
  int unit;
  float exponent;  ///< of two
};

/// The matrix by scalar rows and units.
struct RowSizes {
  std::vector<int> unit_of;  ///< unknown -> unit
  int units = 0;
  std::vector<LargestEntry> entries;
  std::vector<std::size_t> begin = {0};  ///< per scalar row, and the end
};

template <class T>
class SizeReader {
 public:
  SizeReader(const Plan& plan, const Rows<T>& rows) : plan_(plan), rows_(rows) {
    const Structure& s = plan.structure;
    sizes_.unit_of.resize(at(plan.unknowns));
    for (std::size_t v = 0; v < plan.first.size(); ++v)
      for (int i = 0; i < s.variable_size[v]; ++i) {
        sizes_.units += i % s.variable_unit[v] == 0;
        sizes_.unit_of[at(plan.first[v] + i)] = sizes_.units - 1;
      }
    for (int r = 0; r < static_cast<int>(s.row_size.size()); ++r) read(r);
  }

  RowSizes take() { return std::move(sizes_); }

 private:
  void read(int r) {
    const Structure& s = plan_.structure;
    columns_.clear();
    int width = 0;
    for (const int v : s.row(r)) columns_.push_back(width), width += s.variable_size[at(v)];
    group_.assign(at(width * s.row_size[at(r)]), T(0));
    rows_.add(r, group_.data(), width, columns_.data());
    for (int i = 0; i < s.row_size[at(r)]; ++i) read(r, group_.data() + i * width);
  }

  void read(int r, const T* row) {
    const Structure& s = plan_.structure;
    for (const int v : s.row(r))
      for (int i = 0; i < s.variable_size[at(v)]; i += s.variable_unit[at(v)]) {
        double largest = 0;
        for (int k = 0; k < s.variable_unit[at(v)]; ++k)
          if (*row != T(0))
            largest = std::max(largest, size_of(*row++));
          else
            ++row;
        if (largest > 0 && std::isfinite(largest))
          sizes_.entries.push_back(
              {sizes_.unit_of[at(plan_.first[at(v)] + i)], static_cast<float>(std::log2(largest))});
      }
    sizes_.begin.push_back(sizes_.entries.size());
  }

  const Plan& plan_;
  const Rows<T>& rows_;
  RowSizes sizes_;
  std::vector<int> columns_;
  std::vector<T> group_;
};

/// One exponent per unit.
std::vector<float> equilibrated(const RowSizes& sizes) {
  constexpr float kNone = -1e30F;
  std::vector<float> of_units(at(sizes.units), 0), most(of_units.size());
  std::vector<float> of_rows(sizes.begin.size() - 1, 0);
  for (int sweep = 0; sweep < kSweeps; ++sweep) {
    std::fill(most.begin(), most.end(), kNone);
    for (std::size_t i = 0; i < of_rows.size(); ++i) {
      float largest = kNone;
      for (std::size_t e = sizes.begin[i]; e < sizes.begin[i + 1]; ++e) {
        const LargestEntry& entry = sizes.entries[e];
        const float own = entry.exponent + of_rows[i] + of_units[at(entry.unit)];
        largest = std::max(largest, own);
        most[at(entry.unit)] = std::max(most[at(entry.unit)], own);
      }
      if (largest > kNone) of_rows[i] -= largest / 2;
    }
    for (std::size_t u = 0; u < most.size(); ++u)
      if (most[u] > kNone) of_units[u] -= most[u] / 2;
  }
  return of_units;
}

}  // namespace

template <class T>
std::vector<std::int16_t> equilibration(const Plan& plan, const Rows<T>& rows) {
  const RowSizes sizes = SizeReader<T>(plan, rows).take();
  const std::vector<float> of_units = equilibrated(sizes);
  std::vector<std::int16_t> result;
  result.reserve(at(plan.unknowns));
  for (const int unit : sizes.unit_of)
    result.push_back(
        static_cast<std::int16_t>(std::lround(std::clamp(of_units[at(unit)], -1000.0F, 1000.0F))));
  return result;
}

#define TITOP_INSTANTIATE(T) \
  template std::vector<std::int16_t> equilibration(const Plan&, const Rows<T>&);
TITOP_INSTANTIATE(double)
TITOP_COMPLEX_SCALARS(TITOP_INSTANTIATE)
#undef TITOP_INSTANTIATE

}  // namespace titop::solve
