#pragma once

#include <titop/compiler/solve/factored.hpp>
#include <titop/compiler/solve/scalar.hpp>

namespace titop::detail {

/// The rows of the joint system with the numbers of the state space as numbers of type T, and the
/// matrices that they refer to.
template <class T>
class LiftedRows {
 public:
  explicit LiftedRows(const Factored& data) : data_(data) {
    direct_.reserve(data.numbers.blocks.size()), output_.reserve(data.numbers.blocks.size());
    for (const auto& block : data.numbers.blocks) {
      direct_.push_back(solve::lifted<T>(block->D));
      output_.push_back(solve::lifted<T>(block->C));
    }
  }
  /// Valid while this object exists.
  solve::JointRows<T> rows() const {
    solve::Matrices<T> m;
    for (const auto& D : direct_) m.direct.push_back(&D);
    for (const auto& C : output_) m.output.push_back(&C);
    return {data_.skeleton->stage.graph, data_.skeleton->joint, data_.numbers.coefficients,
            std::move(m)};
  }

 private:
  const Factored& data_;
  std::vector<solve::Dense<T>> direct_, output_;
};

}  // namespace titop::detail
