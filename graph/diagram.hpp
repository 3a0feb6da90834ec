#pragma once

#include <functional>
#include <memory>
#include <string>
#include <string_view>
#include <titop/graph/graph.hpp>
#include <titop/graph/port.hpp>

namespace titop {

/// A spec that `Diagram::add` takes: `as_block(spec)` gives its block, `Handle` its ports.
template <class Spec>
concept BlockSpec = requires(const Spec& spec, Graph* graph, int node) {
  { as_block(spec) } -> std::convertible_to<BlockPtr>;
  typename Spec::Handle;
  { typename Spec::Handle(graph, node) };
};

/// An output of the diagram: `d.output("x3") = z1.stretch + z3.stretch;`
class OutputRef {
 public:
  OutputRef(Graph* graph, int index) : graph_(graph), index_(index) {}
  OutputRef(const OutputRef&) = default;
  OutputRef& operator=(const OutputRef&) = delete;  // it would have no effect
  void operator=(const Rhs& rhs) const;
  void operator=(Zero zero) const { *this = Rhs(zero); }

 private:
  Graph* graph_;
  int index_;
};

/// The user's description: blocks, equations on their ports, inputs, outputs, parameters.
///
/// It owns its graph and can be moved, not copied (`clone()` copies); handles and ports point into
/// it. Mistakes in names and equations are collected and thrown together by `compile`. Two kinds
/// are thrown at once: invalid data of a block (a negative mass), by `add`, with the node's name;
/// and expressions without meaning: a part that does not exist, a signal of another diagram, a
/// product of rotations whose inner frames differ. Inputs, outputs and states of the model are in
/// the order of their declaration here.
class Diagram {
 public:
  explicit Diagram(std::string name);
  Diagram(Diagram&&) = default;
  Diagram& operator=(Diagram&&) = default;
  Diagram(const Diagram&) = delete;
  Diagram& operator=(const Diagram&) = delete;
  /// An independent copy; blocks and their data are shared. Handles of the original keep pointing
  /// into the original. O(size).
  Diagram clone() const;

  /// Adds a node; its handle has the block's ports. O(ports); the block's data are shared. A spec
  /// with `connect(handle, at)` writes equations of its own there (Rotor). Throws the errors of the
  /// block, with the node's name.
  template <BlockSpec Spec>
  typename Spec::Handle add(std::string name, const Spec& spec,
                            SourceLine at = std::source_location::current()) {
    const int node = add_block(
        std::move(name), [&] { return as_block(spec); }, at);
    const typename Spec::Handle handle{graph_.get(), node};
    if constexpr (requires { spec.connect(handle, at); }) spec.connect(handle, at);
    return handle;
  }

  /// External input: `size` plain scalars; quantity and frame are those of the signals that it
  /// drives. `compile` reports size (below 1) and duplicate_name, here and below. O(1).
  InputRef input(std::string name, int size = 1, SourceLine at = std::source_location::current());

  /// External output of `size` scalars, to be set once by `=`.
  OutputRef output(std::string name, int size = 1, SourceLine at = std::source_location::current());

  /// A parameter: a number with a name and this nominal value, for use wherever a block or an
  /// equation takes a number. Its unit is that of the number which it replaces. `compile` reports
  /// not_finite. O(1).
  Param param(std::string name, double value, SourceLine at = std::source_location::current());

  /// A loop point: returns `signal`, as a plain signal, for use in its place. It changes nothing
  /// until `loop(system, "name")` (analysis/control/loop.hpp) cuts the loop there, for S, T, L and
  /// margins. Adds a node called `name`, of the size of the signal. Throws unknown_name for a
  /// signal of another diagram. O(terms).
  ///
  ///     hub.parent.force.angular = -d.loop_point("attitude", law.out);
  Reading loop_point(std::string name, const Rhs& signal);

  const std::string& name() const { return graph_->name; }
  const Graph& graph() const { return *graph_; }

 private:
  int add_block(std::string name, const std::function<BlockPtr()>& make, SourceLine at);
  std::unique_ptr<Graph> graph_;
};

}  // namespace titop
