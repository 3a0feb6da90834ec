#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <string>
#include <titop/blocks/flexible_body.hpp>
#include <titop/blocks/joint.hpp>
#include <titop/blocks/spring_mass.hpp>
#include <titop/graph/nodes/gain.hpp>
#include <titop/graph/nodes/lti.hpp>
#include <vector>

#include "generate/diagrams/units.hpp"
#include "generate/shape.hpp"

/// Seeded random diagrams without closed chains, for the central property.
namespace titop::generate {

struct RandomOptions {
  std::uint64_t seed = 1;
  Family family = Family::scalar;
  Shape shape = Shape::tree;
  int bodies = 6;      ///< of the largest assembly
  int assemblies = 1;  ///< parts without coupling
  Damping damping = Damping::some;
  bool controllers = true;    ///< Lti, Gain, Sum and MatrixGain between outputs and forces
  bool incomplete = false;    ///< parts without inputs or outputs, now and then a whole diagram
  bool prescribed = true;     ///< accelerations as inputs
  int large_controllers = 0;  ///< dense Lti of 3 to 12 states, several inputs and outputs, of every
                              ///< kind of lti.hpp, in and out of loops; drawn last
};

/// The family, shape and sizes that belong to this seed; `larger` for the long tests.
RandomOptions random_options(std::uint64_t seed, bool larger = false);

/// The diagram under construction, and its parts by name.
struct Build {
  Diagram d;
  Units units;
  std::map<std::string, InputRef> inputs;
  std::map<std::string, SpringMass::Handle> springs;
  std::map<std::string, BodyHandle> bodies;
  /// Hinges and slides, under the same names for both.
  struct OneAxis {
    DualPort<6> child, parent;
    Joint::AxisPorts axis;
  };
  std::map<std::string, OneAxis> joints;
  std::map<std::string, Lti::Handle> filters;
  std::map<std::string, Gain::Handle> gains;  ///< and MatrixGain
  std::map<std::string, Sum::Handle> sums;

  explicit Build(const std::string& name, const Units& u) : d(name), units(u) {}
};

/// A diagram as a list of steps: the same one can be written in any order and in any units.
class RandomDiagram {
 public:
  using Step = std::function<void(Build&)>;

  std::string name;
  std::vector<Step> adds, equations;
  std::vector<std::vector<Dim>> inputs, outputs;  ///< of each, scalar by scalar; declared order
  /// Relative motions without stiffness (a free hinge) or that inputs impose on the springs
  /// (both ends of a chain prescribed): at most two poles at 0 each.
  int loose = 0;

  /// As drawn.
  Diagram build(const Units& units = {}) const;
  /// All adds and all equations in another order.
  Diagram shuffled(std::uint64_t seed) const;
  /// Factors of all input or output scalars in other units.
  static Eigen::VectorXd factors(const std::vector<std::vector<Dim>>& dims, const Units& units);
  /// Blocks for transfer_error.
  static std::vector<Eigen::Index> blocks(const std::vector<std::vector<Dim>>& dims);
};

RandomDiagram random_diagram(const RandomOptions& options);

}  // namespace titop::generate
