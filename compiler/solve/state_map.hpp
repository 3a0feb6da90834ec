#pragma once

#include <Eigen/Core>
#include <memory>
#include <string>
#include <titop/compiler/passes/stage.hpp>
#include <titop/graph/state_space.hpp>
#include <vector>

namespace titop::detail {

struct Layout;

/// From the states x of the model to those of all blocks, x_blocks = T x + R u: the map that pass
/// `close` and the reduction of singular scenes (compiler/index_reduction/reduce.hpp) found,
/// applied around the solve. The model is A = (A T)(kept rows), B = (B + A R)(kept rows), C T, D +
/// C R. R is 0 unless a force acts on a massless point.
class StateMap {
 public:
  StateMap() = default;
  StateMap(const std::vector<Dependent>& dependents, const Layout& layout);
  /// by_input: R, blocks' states x inputs. shifts: a kept state of the blocks, driven by u at s, is
  /// x + sum of shifts[j] s^j u, kept states x inputs.
  void set_inputs(Eigen::MatrixXd by_input, std::vector<Eigen::MatrixXd> shifts) {
    by_input_ = std::move(by_input), shifts_ = std::move(shifts);
  }

  bool trivial() const { return map_->rows.empty(); }
  const Eigen::MatrixXd& by_input() const { return by_input_; }  ///< empty: 0
  const std::vector<int>& kept() const { return map_->kept; }    ///< among the blocks' states
  /// The model's states; `blocks` are those of the blocks.
  const std::vector<std::string>& names(const std::vector<std::string>& blocks) const {
    return trivial() ? blocks : map_->names;
  }
  int order() const { return static_cast<int>(map_->kept.size()); }

  /// One dependent state: sum of factor * state, all among the blocks' states. A row may refer to
  /// the states of rows before it.
  struct DependentRow {
    int state = -1;
    std::vector<std::pair<int, double>> of;
    std::vector<double> rounding;  ///< of each factor
  };
  const std::vector<DependentRow>& dependent() const { return map_->rows; }

  /// T x: blocks' states x columns. O(entries of the rows) per column.
  template <class Matrix>
  Matrix expanded(const Matrix& x) const {
    if (trivial()) return x;
    const auto& [kept, names, rows] = *map_;
    Matrix all(static_cast<Eigen::Index>(kept.size() + rows.size()), x.cols());
    for (std::size_t i = 0; i < kept.size(); ++i)
      all.row(kept[i]) = x.row(static_cast<Eigen::Index>(i));
    for (const DependentRow& row : rows) {
      all.row(row.state).setZero();
      for (const auto& [of, factor] : row.of)
        all.row(row.state) += typename Matrix::Scalar(factor) * all.row(of);
    }
    return all;
  }
  /// Sizes of the rounding of T x, for the states of all blocks; 0 in those that are kept.
  Eigen::VectorXd rounding(const Eigen::VectorXd& all) const;
  /// T x + R u.
  template <class Matrix>
  Matrix expanded(const Matrix& x, const Matrix& u) const {
    Matrix all = expanded(x);
    if (by_input_.size() > 0) all += by_input_.cast<typename Matrix::Scalar>() * u;
    return all;
  }
  /// The model's states if the blocks' states and the inputs are these at s.
  template <class Matrix>
  Matrix model_states(const Matrix& all, const Matrix& u, typename Matrix::Scalar s) const {
    using T = typename Matrix::Scalar;
    Matrix x = kept_rows(all);
    T power = 1;
    for (const Eigen::MatrixXd& shift : shifts_) {
      x -= power * (shift.cast<T>() * u);
      power *= s;
    }
    return x;
  }
  /// The kept rows of a matrix over all blocks' states.
  template <class Matrix>
  Matrix kept_rows(const Matrix& all) const {
    if (trivial()) return all;
    return all(map_->kept, Eigen::all);
  }
  /// The model of all blocks' states becomes the model of the kept ones; entries that cancel to
  /// rounding (64 units) are 0. O(order * entries of the rows).
  void reduce(StateSpace& model) const;

 private:
  struct Map {
    std::vector<int> kept;
    std::vector<std::string> names;  ///< of those kept; none if all are
    std::vector<DependentRow> rows;
  };
  std::shared_ptr<const Map> map_ = std::make_shared<const Map>();  ///< updates share it
  Eigen::MatrixXd by_input_;
  std::vector<Eigen::MatrixXd> shifts_;
};

}  // namespace titop::detail
