#pragma once

#include <titop/graph/diagram.hpp>

namespace titop {

/// out = gain * in, all plain signals of the same size, 1 or more (`add` throws size). `lower`
/// makes it a coefficient. A gain inside an equation, `k * x`, is the same without a name.
struct Gain {
  Value gain = 1;  ///< [unit of out / unit of in]
  int size = 1;

  struct Handle {
    Handle(Graph* graph, int node);
    Handle(const Handle&) = default;
    Handle& operator=(const Handle& other) { return detail::rebind(*this, other); }
    Port<0, Kind::plain> in;
    Reading out;
  };
};
BlockPtr as_block(const Gain& spec);

/// out = matrix * in, `matrix` rows x columns, neither 0 (`add` throws size); a gain between
/// vectors.
struct MatrixGain {
  Eigen::MatrixXd matrix;
  using Handle = Gain::Handle;
};
BlockPtr as_block(const MatrixGain& spec);

/// out = in: a place at which `loop` (analysis/control/loop.hpp) cuts the diagram; everywhere else
/// an identity that `lower` makes a coefficient. Diagram::loop_point writes it. `add` throws size
/// for a size below 1.
struct LoopPoint {
  int size = 1;
  using Handle = Gain::Handle;
};
BlockPtr as_block(const LoopPoint& spec);
/// True for a block made from a LoopPoint.
bool is_loop_point(const Block& block);

/// out = +-in1 +-in2 ..., one sign per input: Sum{.signs = "+-"}. Ports in1, in2, ... `add` throws
/// bad_value for other signs, size for none of them and for a size below 1.
struct Sum {
  std::string signs = "++";
  int size = 1;

  struct Handle {
    Handle(Graph* graph, int node)
        : out(graph, detail::port_signal(*graph, node, "out")), graph_(graph), node_(node) {}
    Handle(const Handle&) = default;
    Handle& operator=(const Handle& other) { return detail::rebind(*this, other); }
    /// Input number i, counted from 1. Throws unknown_name.
    Port<0, Kind::plain> in(int i) const;
    Reading out;

   private:
    Graph* graph_;
    int node_;
  };
};
BlockPtr as_block(const Sum& spec);

}  // namespace titop
