#pragma once

#include <fmt/format.h>

#include <titop/graph/mount.hpp>

#include "generate/diagrams/random_diagram.hpp"

/// Shared by the sources of random_diagram: a random diagram while it is being drawn.
namespace titop::generate {

struct Draft {
  RandomOptions options;
  Rng rng;
  RandomDiagram drawn;
  int names = 0;
  bool has_inputs = true, has_outputs = true;     ///< of the assembly that is being drawn
  std::vector<std::string> springs, bodies;       ///< drawn so far
  std::map<std::string, int> controller_outputs;  ///< of 3 to 12 states

  explicit Draft(const RandomOptions& o) : options(o), rng(o.seed) {}

  /// A random letter first, so that the order of names is not the order of drawing.
  std::string fresh(const char* kind) {
    return fmt::format("{}{}{}", static_cast<char>('a' + rng.below(26)), kind, ++names);
  }
  void add(RandomDiagram::Step step) { drawn.adds.push_back(std::move(step)); }
  void equation(RandomDiagram::Step step) { drawn.equations.push_back(std::move(step)); }

  std::string input(std::vector<Dim> dims) {
    const std::string name = fresh("u");
    const int size = static_cast<int>(dims.size());
    drawn.inputs.push_back(std::move(dims));
    add([=](Build& b) { b.inputs.emplace(name, b.d.input(name, size)); });
    return name;
  }
  void output(std::vector<Dim> dims, std::function<Expr(Build&)> value) {
    const std::string name = fresh("y");
    const int size = static_cast<int>(dims.size());
    drawn.outputs.push_back(std::move(dims));
    equation([=](Build& b) { b.d.output(name, size) = value(b); });
  }
  bool damped() {
    return options.damping == Damping::all || (options.damping == Damping::some && rng.chance(0.5));
  }
  bool may_prescribe() const { return options.prescribed && has_inputs; }
};

inline std::vector<Dim> dual(Dim linear, Dim angular) {
  return {linear, linear, linear, angular, angular, angular};
}

enum class Root {
  ground,
  prescribed,  ///< its acceleration is an input
  released,    ///< under a force, if the assembly has inputs
  pinned,      ///< free to turn
  turning,     ///< free to move without turning: its angular acceleration is 0
  sliding      ///< held along one direction
};
/// One of the first `kinds`.
Root draw_root(Draft& d, int kinds);

/// The root of an assembly, `part(build)`, as a whole: its acceleration, or the force on it.
template <class Part>
void hold_root(Draft& d, Root root, const Part& part, std::vector<Dim> accel,
               std::vector<Dim> force) {
  if (root == Root::ground) {
    d.equation([=](Build& b) { ground(part(b)); });
  } else if (root == Root::prescribed) {
    const std::string a = d.input(std::move(accel));
    d.equation([=](Build& b) { part(b).parent.accel = b.inputs.at(a); });
  } else if (d.has_inputs) {
    const std::string u = d.input(std::move(force));
    d.equation([=](Build& b) { part(b).parent.force = -b.inputs.at(u); });
  } else {
    d.equation([=](Build& b) { release(part(b)); });
  }
}

/// A body or a spring-mass by its place in the tree; -1 for the root.
std::vector<int> draw_tree(Draft& d, int count);

/// A stable filter of order 1 or 2 from a signal of dimension `in` to one of dimension `out`, with
/// this direct term.
std::string draw_filter(Draft& d, Dim in, Dim out, double gain, double direct);

/// A spring-mass; its parent mass is positive if that end is `free`.
std::string draw_spring(Draft& d, bool free);
/// Forces, controllers and outputs on a spring-mass mounted in a drawn.
void use_spring(Draft& d, const std::string& z);

/// Controllers of 3 to 12 states (lti.hpp) around all that has been drawn.
void draw_controllers(Draft& d, int count);

void draw_scalar(Draft& d, int count);
void draw_spatial(Draft& d, int count, bool with_springs);

}  // namespace titop::generate
