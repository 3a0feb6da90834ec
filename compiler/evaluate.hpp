#pragma once

#include <map>
#include <titop/compiler/system_data.hpp>

namespace titop::detail {

/// A compiled diagram at one s, driven by its external inputs: every signal on demand. T is a
/// complex scalar of any precision; blocks that are the same object are evaluated once.
template <class T>
class Evaluation {
 public:
  /// u: inputs x columns. Throws singular if s is a pole of the system or of a block.
  Evaluation(const SystemData& data, const T& s, const solve::RowMatrix<T>& u);

  /// signal size x columns.
  solve::RowMatrix<T> value(int signal) const;

  /// The diagram's outputs x columns.
  solve::RowMatrix<T> outputs() const;

 private:
  solve::Matrices<T> respond(const T& s);

  const SystemData& data_;
  solve::RowMatrix<T> u_;
  std::vector<int> first_;  ///< per signal: first row of u
  std::map<std::pair<const Block*, const Dynamics*>, solve::Response<T>> responses_;
  std::vector<const solve::Response<T>*> of_node_;
  solve::JointRows<T> rows_;
  solve::RowMatrix<T> unknowns_;
};

}  // namespace titop::detail
