#pragma once

#include <map>
#include <set>
#include <titop/compiler/solve/factored.hpp>
#include <titop/compiler/solve/layout.hpp>
#include <titop/compiler/solve/null_rows.hpp>

/// Hidden constraints of a singular joint system, and the states that they determine.
namespace titop::detail {

/// g x + h[0] u + h[1] udot + ... = 0, over the states of all blocks.
struct Hidden {
  solve::SparseRow g;
  std::vector<Eigen::RowVectorXd> h;
  int row = -1;                ///< a scalar row of the joint system in the combination y of this
                               ///< constraint, and of no other
  std::vector<int> rows = {};  ///< all that y combines, among Stage::rows
};

/// States that follow from the others and from inputs:
/// x(state) = sum of factor * x(of) + sum of by[j] u^(j), `of` independent.
class Followers {
 public:
  Followers(const Skeleton& k, const Factored& d);

  /// Each constraint makes one state depend on the others: a rate if it contains any (a massless
  /// point has no velocity of its own), else a coordinate that stores energy, else another one; of
  /// these the one with the largest factor in units of energy (a coordinate by 1 /
  /// sqrt(stiffness)). A state that was dependent in Stage::before is preferred if its factor is at
  /// least 1e-3 of that. Returns the constraints that determine none, written in independent
  /// states: g = 0.
  std::vector<Hidden> add(std::vector<Hidden> constraints);

  std::vector<Dependent> dependents() const;
  /// by[j] of all states, blocks' states x inputs, j = 0 ...; as many as there are.
  std::vector<Eigen::MatrixXd> by_input() const;
  /// The states that `add` has made dependent.
  const std::vector<int>& added() const { return added_; }

 private:
  struct Follower {
    std::map<int, double> of = {};
    std::vector<Eigen::RowVectorXd> by = {};
  };
  void substitute(Hidden& c) const;
  int choose(const Hidden& c) const;
  void follow(int state, const Hidden& c);
  void follow_through(int other, int state, const Follower& f);

  const Layout& layout_;
  Eigen::Index inputs_;
  std::map<int, Follower> of_state_;
  std::map<int, std::set<int>>
      read_by_;  ///< per independent state: the dependent ones with a share
  std::vector<int> added_;
  std::vector<int> node_, first_;       ///< per state
  std::vector<char> is_rate_, before_;  ///< per state
  Eigen::VectorXd weight_;              ///< per state: 1/sqrt(stiffness) of it or its coordinate
};

}  // namespace titop::detail
