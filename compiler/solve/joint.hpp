#pragma once

#include <memory>
#include <titop/compiler/solve/elimination.hpp>
#include <titop/compiler/stage.hpp>
#include <vector>

/// The joint system of all interface unknowns of a graph: block rows `y - D u = C x` and the
/// user's equations, with signals that an equation merely copies or rotates written out.
namespace titop::solve {

/// coefficient * signal; the signal is a variable, a state or an input.
template <class T>
struct Piece {
  int signal;
  Eigen::Matrix<T, Eigen::Dynamic, Eigen::Dynamic> c;
};

/// What does not depend on s: variables, what every signal is in terms of them, and the plan.
struct Joint {
  std::vector<int> variables;                       ///< signal of each variable
  std::vector<int> variable_of;                     ///< signal -> variable, -1 if written out
  std::vector<std::vector<Piece<double>>> meaning;  ///< signal -> variables, states and inputs
  std::vector<int> rows;                            ///< Stage row of each row group
  Plan plan;
};

/// Numbers of the joint system: real with D and C for the state space, complex with the blocks'
/// transfers at one s.
template <class T>
struct Numbers {
  std::vector<RowEntries<T>> entries;
  std::vector<std::vector<Piece<T>>> rhs;  ///< per row group: states and inputs on the right side
};

/// A whole equation whose terms are no targets themselves is written out (its pivot is 1 and needs
/// no search); everything else stays an unknown: substituting further would be tearing.
/// O(terms) and the cost of the plan.
Joint joint(const Stage& stage);

/// blocks[node] are the matrices of that node.
Numbers<double> numbers(const Stage& stage, const Joint& joint,
                        const std::vector<std::shared_ptr<const Dynamics>>& blocks);
/// responses[node] is that node alone at s; states are written out by their inputs.
Numbers<std::complex<double>> numbers(const Stage& stage, const Joint& joint,
                                      const std::vector<Block::Response>& responses);

}  // namespace titop::solve
