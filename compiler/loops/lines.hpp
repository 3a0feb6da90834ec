#pragma once

#include <functional>
#include <optional>
#include <titop/compiler/loops/form.hpp>
#include <titop/compiler/loops/motion.hpp>
#include <titop/compiler/loops/relations.hpp>

namespace titop::loops {

/// Rows of homogeneous relations, as forms.
struct RelationRows {
  Form form = {};
  std::vector<int> unit = {};  ///< per row: translations 0, rotations 1, mixed 2
  int equation = -1;           ///< of a closing equation
};

/// One scalar column.
struct ScalarColumn {
  FormColumn column;
  int index = 0;
  auto operator<=>(const ScalarColumn&) const = default;
};

/// Lines that share columns, as relations: a block per line.
struct Component {
  std::vector<int> lines = {};
  std::vector<ScalarColumn> scalars = {};
  Relations relations = {};
};

/// Role of a scalar column; none: it is 0 and left out.
struct ColumnRole {
  Relations::Role role = Relations::Role::unknown;
  double weight = 0;
};
using Classify = std::function<std::optional<ColumnRole>(const ScalarColumn&)>;

/// The connected components of these lines, in order of their first lines. O(entries).
std::vector<Component> components(const std::vector<RelationRows>& lines, const Classify& classify);

/// The rate of each state that is a coordinate, and its stiffness.
class StateRates {
 public:
  StateRates(const Graph& graph, ParameterValues values) : g_(graph), values_(values) {}
  /// State that is the rate of this one, -1 if none is.
  int rate_of(int node, int state) const;
  /// 1 / sqrt(stiffness), 0 if it stores no energy.
  double weight(int node, int state) const;

 private:
  const Graph& g_;
  ParameterValues values_;
  mutable std::map<int, Eigen::VectorXd> stiffness_;
};

/// A closing equation as lines of translations and rotations.
RelationRows line_of(const Closing& closing);

}  // namespace titop::loops
