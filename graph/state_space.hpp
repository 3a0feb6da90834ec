#pragma once

#include <Eigen/Core>
#include <complex>
#include <string>
#include <vector>

namespace titop {

/// One linear model: xdot = A x + B u, y = C x + D u, with names for every row and column. Inputs,
/// outputs and states are in the order of their declaration in the diagram.
struct StateSpace {
  Eigen::MatrixXd A;                                 ///< n x n
  Eigen::MatrixXd B;                                 ///< n x nu
  Eigen::MatrixXd C;                                 ///< ny x n
  Eigen::MatrixXd D;                                 ///< ny x nu
  std::vector<std::string> states, inputs, outputs;  ///< "z1.stretch", "U(3)", ...
  /// Per state the name of its rate, "" if it has none; empty: not known. `compile` takes it from
  /// the blocks (Interface::rates).
  std::vector<std::string> rates = {};

  int order() const { return static_cast<int>(A.rows()); }

  /// C (s - A)^-1 B + D, ny x nu. Throws singular if s is a pole, size if A, B, C, D do not fit
  /// each other. O(n^3).
  Eigen::MatrixXcd transfer(std::complex<double> s) const;
  /// Row of the output / column of the input / position of the state of this name; throws
  /// unknown_name with the valid ones.
  int output(const std::string& name) const;
  int input(const std::string& name) const;
  int state(const std::string& name) const;
};

/// Position of `name`; throws unknown_name, with the first of the valid ones, for a `subject`
/// ("input") that the model does not have. O(names).
int position_of(const std::vector<std::string>& names, const std::string& name,
                std::string_view subject);

/// Throws size, with all matrices that do not fit: A must be n x n, B n x nu, C ny x n, D ny x nu,
/// with n the rows of A, nu the columns of B and ny the rows of C. `user`: for the message.
void require_fitting(const StateSpace& model, const std::string& user);
/// Throws size unless every input and every output has a name.
void require_names(const StateSpace& model, const std::string& user);

/// Column of the only entry in this row of A if it is 1 and off the diagonal, else -1: xdot of the
/// state is another state.
int unit_entry(const Eigen::MatrixXd& A, Eigen::Index row);
/// Per state the index of its rate; -1 if it is no coordinate. The state's row of A must have one
/// entry, a 1 at its rate (unit_entry); if the model has `rates`, they must name the same state. A
/// model by hand has none. O(n^2).
std::vector<int> rates_of(const StateSpace& model);

/// The matrices with their names, for reading; wide models are truncated with a note.
std::string to_string(const StateSpace& model);

}  // namespace titop
