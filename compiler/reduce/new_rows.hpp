#pragma once

#include <titop/compiler/reduce/hidden.hpp>
#include <titop/compiler/reduce/undetermined.hpp>

namespace titop::detail {

/// Row group of a scalar row of a joint system, and the row's place in it.
std::pair<int, int> group_of(const solve::Joint& joint, int scalar_row);

/// New equations in place of some scalar rows of the joint system of a skeleton.
class NewRows {
 public:
  NewRows(const Skeleton& k, SystemData& d) : k_(k), d_(d), old_(k.joint) {}

  /// The derivative of the constraint, g x' = -h u' - ... with x' = A x + B u block by block, in
  /// place of its row (without its right-hand side by u'). It is kept by reference.
  void derivative(const Hidden& c) { of_group(c.row).derivatives.push_back(&c); }
  /// A motion at 0, in place of its row. It is kept by reference.
  void hold(const Held& h) { of_group(h.row).held.push_back(&h); }

  /// The system with them: the same variables and row groups, a plan of its own.
  solve::Joint joint();

 private:
  struct Group {
    std::vector<const Hidden*> derivatives = {};
    std::vector<const Held*> held = {};
  };
  Group& of_group(int row) { return by_group_[group_of(old_, row).first]; }

  void rewrite(int r, const Group& group, std::vector<solve::Piece>& pieces,
               std::vector<int>& over);
  void put(std::vector<solve::Piece>& to, solve::Piece p, const Eigen::MatrixXd& matrix);
  void differentiate(const Hidden& c, const Eigen::VectorXd& place, std::vector<solve::Piece>& to,
                     std::vector<int>& over);
  void add(std::vector<solve::Piece>& to, std::vector<int>& over, const Eigen::MatrixXd& matrix,
           int signal);

  const Skeleton& k_;
  SystemData& d_;
  const solve::Joint& old_;
  std::map<int, Group> by_group_;
};

}  // namespace titop::detail
