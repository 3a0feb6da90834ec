#pragma once

#include <titop/compiler/solve/factored.hpp>
#include <titop/graph/linalg/index.hpp>

namespace titop::detail {

/// All signals of a compiled system at one instant, with numbers of type T: states and inputs, and
/// the unknowns of the joint system, column by column.
template <class T>
struct InstantIn {
  const Factored& data;
  solve::JointRows<T> rows;
  solve::RowMatrix<T> known;          ///< [x; u] with the states of all blocks
  solve::RowMatrix<T> unknowns = {};  ///< in the order of Plan::first

  /// Right-hand sides of the joint system.
  solve::RowMatrix<T> rhs() const { return rows.rhs(known, data.layout().known_first); }

  /// to += the signal, size x columns, row-major.
  void add_value(int signal, T* to) const {
    rows.add_value(signal, unknowns, known, data.layout().known_first, to);
  }

  /// add(first row of xdot, matrix, its factor, row-major), of all products whose sum is xdot: A x
  /// + B (inputs of the block), of all blocks' states.
  template <class Add>
  void products_of_xdot(Add add) const {
    using Matrix = Eigen::Map<const Eigen::MatrixXd>;
    solve::RowMatrix<T> input;
    for (const int i : data.layout().state_nodes) {
      const Node& node = data.graph().nodes[linalg::at(i)];
      const Dynamics& m = *data.numbers.blocks[linalg::at(i)];
      const Eigen::Index first = data.layout().state_first[linalg::at(i)], n = m.A.rows();
      add(first, Matrix(m.A.data(), n, n), known.data() + first * known.cols());
      for (int s = node.first_signal; s < node.state; ++s)
        if (const Signal& in = data.graph().signals[linalg::at(s)];
            in.role == Signal::Role::input && in.active) {
          input.setZero(in.size, known.cols());
          add_value(s, input.data());
          add(first, Matrix(m.B.data() + in.first * n, n, in.size), input.data());
        }
    }
  }

  /// Likewise of the diagram's outputs.
  template <class Add>
  void products_of_outputs(Add add) const {
    solve::RowMatrix<T> value;
    for (std::size_t o = 0; o < data.graph().outputs.size(); ++o) {
      const auto& terms = data.graph().outputs[o].terms;
      const int first = data.skeleton->joint.output_coefficient[o];
      for (std::size_t k = 0; k < terms.size(); ++k) {
        value.setZero(data.graph().signals[linalg::at(terms[k].signal)].size, known.cols());
        add_value(terms[k].signal, value.data());
        add(data.layout().output_first[o], *data.numbers.coefficients[linalg::at(first) + k],
            value.data());
      }
    }
  }
};

}  // namespace titop::detail
