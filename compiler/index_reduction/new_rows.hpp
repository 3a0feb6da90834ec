#pragma once

#include <titop/compiler/index_reduction/hidden.hpp>
#include <titop/compiler/index_reduction/undetermined.hpp>

namespace titop::detail {

/// Row groups of the scalar rows of a joint system, and the rows' places in them. O(rows) once.
class RowGroups {
 public:
  explicit RowGroups(const solve::Plan& plan);
  std::pair<int, int> of(int scalar_row) const { return of_[static_cast<std::size_t>(scalar_row)]; }

 private:
  std::vector<std::pair<int, int>> of_;
};

/// New equations in place of some scalar rows of the joint system of a skeleton.
class NewRows {
 public:
  NewRows(const Skeleton& k, Factored& d);

  /// The derivative of the constraint, g x' = -h u' - ... with x' = A x + B u block by block, in
  /// place of its row (without its right-hand side by u'). It is kept by reference.
  void derivative(const Hidden& c) { of_group(c.row).derivatives.push_back(&c); }
  /// A motion at 0, in place of its row. It is kept by reference.
  void hold(const HeldDirection& h) { of_group(h.row).held.push_back(&h); }

  /// The system with them: the same variables and row groups, with a separate plan.
  solve::JointSystem joint();

 private:
  struct Group {
    std::vector<const Hidden*> derivatives = {};
    std::vector<const HeldDirection*> held = {};
  };
  Group& of_group(int row) { return by_group_[groups_.of(row).first]; }

  void rewrite(int r, const Group& group, std::vector<solve::Piece>& pieces,
               std::vector<int>& over);
  void put(std::vector<solve::Piece>& to, solve::Piece p, const Eigen::MatrixXd& matrix);
  void differentiate(const Hidden& c, const Eigen::VectorXd& place, std::vector<solve::Piece>& to,
                     std::vector<int>& over);
  void add(std::vector<solve::Piece>& to, std::vector<int>& over, const Eigen::MatrixXd& matrix,
           int signal);

  const Skeleton& k_;
  Factored& d_;
  const solve::JointSystem& old_;
  RowGroups groups_;
  std::vector<int> node_of_;  ///< per state
  std::map<int, Group> by_group_;
};

}  // namespace titop::detail
