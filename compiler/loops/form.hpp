#pragma once

#include <Eigen/Core>
#include <compare>
#include <map>

/// Positions as linear forms: small displacements about the posture.
namespace titop::loops {

/// A term of a displacement. The same columns are used on position and on velocity level.
struct FormColumn {
  enum class Kind {
    root,        ///< of a free assembly, or a port that moves by itself; id: channel of the point
    angle,       ///< free motion of a joint; id: equation
    prescribed,  ///< double integral of a signal that is no acceleration of a point; id: signal
    states,      ///< the states of a block; id: node
    integral,    ///< the states of an Integrator; id: node
  };
  Kind kind = Kind::root;
  int id = 0;
  int level = 0;  ///< prescribed: 0 for accelerations, 1 for rates
  auto operator<=>(const FormColumn&) const = default;
};

/// Sum of matrix * column; all matrices have the same number of rows.
using Form = std::map<FormColumn, Eigen::MatrixXd>;

inline void add(Form& to, const FormColumn& column, const Eigen::MatrixXd& matrix) {
  const auto [place, added] = to.try_emplace(column, matrix);
  if (!added) place->second += matrix;
}

/// to += factor * form
inline void add(Form& to, const Eigen::MatrixXd& factor, const Form& form) {
  for (const auto& [column, matrix] : form) add(to, column, factor * matrix);
}

}  // namespace titop::loops
