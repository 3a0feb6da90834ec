#include <fmt/format.h>

#include <algorithm>
#include <titop/blocks/fe/op2_results.hpp>
#include <titop/blocks/fe/text_file.hpp>

/// op2_matrices: the degree of freedom of each row.
namespace titop::fe {

using Eigen::Index;

namespace {

/// Integers of this record behind the header of the first table of these names; none without it.
std::vector<long long> integers(const Op2File& file, const std::vector<std::string>& names,
                                std::size_t record) {
  std::vector<long long> result;
  for (const Op2Table& t : file.tables) {
    if (std::ranges::find(names, t.name) == names.end() || t.records.size() <= record) continue;
    const std::string& bytes = t.records[record];
    for (std::size_t at = 0; at + file.layout.word <= bytes.size(); at += file.layout.word)
      result.push_back(file.layout.integer(&bytes[at]));
    break;
  }
  return result;
}

/// Degrees of freedom of the g-set in Nastran's order. The second record of EQEXIN has for each
/// point its number and 10 times its first row, plus 1 for a grid, of six rows, or 2 for a scalar
/// point.
std::vector<GridDof> all_dofs(const Op2File& file) {
  const std::vector<long long> pairs = integers(file, {"EQEXIN", "EQEXINS"}, 2);
  std::map<long long, std::pair<int, bool>> points;  // by first row
  for (std::size_t i = 0; i + 1 < pairs.size(); i += 2) {
    const long long number = pairs[i], kind = pairs[i + 1] % 10;
    if (number < 1 || number > 2'000'000'000 || (kind != 1 && kind != 2))
      refuse_file(file.name, fmt::format("EQEXIN has point {} of kind {}", number, kind),
                  "grids are of kind 1, scalar points of kind 2");
    points[pairs[i + 1] / 10] = {static_cast<int>(number), kind == 1};
  }
  std::vector<GridDof> dofs;
  for (const auto& [row, point] : points) {
    if (row != std::ssize(dofs) + 1)
      refuse_file(file.name, fmt::format("EQEXIN has row {} behind {} rows", row, dofs.size()),
                  "the tables of one superelement");
    const auto [number, is_grid] = point;
    for (int c = is_grid ? 1 : 0; c <= (is_grid ? 6 : 0); ++c) dofs.push_back({number, c});
  }
  return dofs;
}

/// Bits of the sets m, o, sg, sb and e [NDDL]: a degree of freedom of none of them is in the a-set.
constexpr long long kOutsideA = 1 | 1 << 2 | 1 << 9 | 1 << 10 | 1 << 11;

/// Those of the rows of KAA: from USET, a word per row of the g-set. Empty without the table.
std::vector<GridDof> a_set(const Op2File& file, const std::vector<GridDof>& all) {
  const std::vector<long long> sets = integers(file, {"USET", "USETS", "USET0"}, 1);
  if (sets.empty()) return {};
  if (sets.size() != all.size())
    refuse_file(file.name, fmt::format("USET has {} rows, EQEXIN {}", sets.size(), all.size()),
                "write both tables of one superelement");
  std::vector<GridDof> dofs;
  for (std::size_t i = 0; i < sets.size(); ++i)
    if ((sets[i] & kOutsideA) == 0) dofs.push_back(all[i]);
  return dofs;
}

}  // namespace

GridMatrices op2_matrices(const Op2File& file, const std::string& stiffness,
                          const std::string& mass) {
  const Op4Matrix &K = find_matrix(file.matrices, stiffness), &M = find_matrix(file.matrices, mass);
  const double digits = std::min(K.digits, M.digits);
  const std::vector<GridDof> all = all_dofs(file), a = a_set(file, all);
  for (const std::vector<GridDof>* dofs : {&a, &all})
    if (!dofs->empty() && std::ssize(*dofs) == K.value.rows()) {
      GridMatrices result{file.name, *dofs, K.value, M.value, digits};
      check(result);
      return result;
    }
  if (!a.empty())
    refuse_file(file.name,
                fmt::format("{} has {} rows, the a-set {}, the g-set {}", stiffness, K.value.rows(),
                            a.size(), all.size()),
                "name matrices of one of these sets: KAA and MAA, or KGG and MGG");
  std::vector<int> ids;
  for (const Grid& g : op2_grids(file)) ids.push_back(g.id);
  return grid_matrices(file.name, K.value, M.value, ids, digits);
}

}  // namespace titop::fe
