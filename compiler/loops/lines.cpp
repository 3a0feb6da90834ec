#include <algorithm>
#include <cmath>
#include <set>
#include <titop/compiler/loops/lines.hpp>
#include <titop/compiler/passes/union_find.hpp>
#include <titop/graph/linalg/index.hpp>

namespace titop::loops {
namespace {

using Eigen::Index;
using linalg::at;

/// Per line its group: lines that share a column have the same.
std::vector<int> groups(const std::vector<RelationRows>& lines) {
  passes::UnionFind joined(static_cast<int>(lines.size()));
  std::map<FormColumn, int> first;
  for (int l = 0; l < static_cast<int>(lines.size()); ++l)
    for (const auto& [column, matrix] : lines[at(l)].form)
      if (const auto [place, added] = first.try_emplace(column, l); !added)
        joined.unite(place->second, l);
  std::vector<int> result;
  for (int l = 0; l < static_cast<int>(lines.size()); ++l) result.push_back(joined.find(l));
  return result;
}

/// Scalars with an entry other than 0, in order, with their meaning.
std::map<ScalarColumn, ColumnRole> scalars_of(const std::vector<RelationRows>& lines,
                                              const std::vector<int>& own,
                                              const Classify& classify) {
  std::map<ScalarColumn, ColumnRole> result;
  for (const int l : own)
    for (const auto& [column, matrix] : lines[at(l)].form)
      for (Index j = 0; j < matrix.cols(); ++j)
        if (const ScalarColumn s{column, static_cast<int>(j)};
            !matrix.col(j).isZero(0) && !result.contains(s))
          if (const auto meaning = classify(s)) result.emplace(s, *meaning);
  return result;
}

Component component(const std::vector<RelationRows>& lines, std::vector<int> own,
                    const Classify& classify) {
  Component c{.lines = std::move(own)};
  std::map<ScalarColumn, int> place;
  const auto scalars = scalars_of(lines, c.lines, classify);
  c.relations.weight.resize(static_cast<Index>(scalars.size()));
  for (const auto& [scalar, meaning] : scalars) {
    const int i = static_cast<int>(c.scalars.size());
    place[scalar] = i;
    c.scalars.push_back(scalar);
    c.relations.role.push_back(meaning.role);
    c.relations.weight(i) = meaning.weight;
  }
  int units = 0;
  for (const int l : c.lines) {
    std::map<int, std::pair<const Eigen::MatrixXd*, Index>> entries;  // column: where it is from
    for (const auto& [column, matrix] : lines[at(l)].form)
      for (Index j = 0; j < matrix.cols(); ++j)
        if (const auto found = place.find({column, static_cast<int>(j)});
            found != place.end() && !matrix.col(j).isZero(0))
          entries.try_emplace(found->second, &matrix, j);
    RowBlock block;
    block.M.resize(static_cast<Index>(lines[at(l)].unit.size()),
                   static_cast<Index>(entries.size()));
    for (const auto& [at_place, from] : entries) {
      block.M.col(static_cast<Index>(block.columns.size())) = from.first->col(from.second);
      block.columns.push_back(at_place);
    }
    c.relations.blocks.push_back(std::move(block));
    c.relations.unit.emplace_back();
    for (const int u : lines[at(l)].unit) c.relations.unit.back().push_back(units + u);
    units += 3;
  }
  return c;
}

}  // namespace

std::vector<Component> components(const std::vector<RelationRows>& lines,
                                  const Classify& classify) {
  const std::vector<int> group = groups(lines);
  std::map<int, std::vector<int>> members;
  for (int l = 0; l < static_cast<int>(lines.size()); ++l) members[group[at(l)]].push_back(l);
  std::vector<Component> result;
  for (auto& [first, own] : members) result.push_back(component(lines, std::move(own), classify));
  return result;
}

int StateRates::rate_of(int node, int state) const {
  return g_.nodes[at(node)].block->interface().rate_of(state);
}

double StateRates::weight(int node, int state) const {
  const auto [place, added] = stiffness_.try_emplace(node);
  if (const Block& block = *g_.nodes[at(node)].block; added)
    place->second = stiffness_of(block, *block.dynamics(values_), values_);
  const double stiffness = rate_of(node, state) < 0 ? 0 : place->second(state);
  return stiffness > 0 ? 1 / std::sqrt(stiffness) : 0;
}

RelationRows line_of(const Closing& closing) {
  RelationRows line{.form = closing.form, .unit = {}, .equation = closing.tie->equation};
  const Eigen::MatrixXd& S = closing.tie->S;
  for (Index i = 0; i < S.rows(); ++i) {
    const bool six = S.cols() == 6;
    const bool linear = !six || !S.row(i).head(3).isZero(0);
    const bool angular = six && !S.row(i).tail(3).isZero(0);
    line.unit.push_back(linear && angular ? 2 : angular ? 1 : 0);
  }
  return line;
}

}  // namespace titop::loops
