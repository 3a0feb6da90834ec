#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <string>
#include <titop/blocks/flexible_body.hpp>
#include <titop/blocks/hinge.hpp>
#include <titop/blocks/joint.hpp>
#include <titop/blocks/rigid_body.hpp>
#include <titop/blocks/slide.hpp>
#include <titop/blocks/spring_mass.hpp>
#include <titop/graph/nodes/gain.hpp>
#include <titop/graph/nodes/lti.hpp>
#include <vector>

#include "support/rng.hpp"

/// Seeded random diagrams without closed chains, for the central property.
namespace titop_test {

/// Factors of the numbers when the units change: a length of 2 becomes 2 * length, and so on.
struct Units {
  double length = 1, mass = 1, time = 1;
};

/// Exponents of a quantity in length, mass and time.
struct Dim {
  int length = 0, mass = 0, time = 0;
  double factor(const Units& u) const;
};
inline constexpr Dim kForce{1, 1, -2}, kTorque{2, 1, -2}, kAccel{1, 0, -2}, kAngularAccel{0, 0, -2},
    kLength{1, 0, 0}, kAngle{0, 0, 0}, kRate{0, 0, -1}, kMass{0, 1, 0};

enum class Family {
  scalar,   ///< one degree of freedom per junction: SpringMass
  spatial,  ///< six: rigid and flexible bodies, beams, hinges and slides
  mixed     ///< spatial, with spring-masses hanging on the bodies along oblique directions
};
enum class Shape { chain, tree, star };
enum class Damping { none, some, all };

struct SceneOptions {
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
                              ///< kind of random_lti.hpp, in and out of loops; drawn last
};

/// The family, shape and sizes that belong to this seed; `larger` for the long tests.
SceneOptions random_options(std::uint64_t seed, bool larger = false);

/// The diagram under construction, and its parts by name.
struct Build {
  titop::Diagram d;
  Units units;
  std::map<std::string, titop::InputRef> inputs;
  std::map<std::string, titop::SpringMass::Handle> springs;
  std::map<std::string, titop::BodyHandle> bodies;
  /// Hinges and slides, under the same names for both.
  struct OneAxis {
    titop::DualPort<6> child, parent;
    titop::Joint::AxisPorts axis;
  };
  std::map<std::string, OneAxis> joints;
  std::map<std::string, titop::Lti::Handle> filters;
  std::map<std::string, titop::Gain::Handle> gains;  ///< and MatrixGain
  std::map<std::string, titop::Sum::Handle> sums;

  explicit Build(const std::string& name, const Units& u) : d(name), units(u) {}
};

/// A scene as a list of steps: the same scene can be written in any order and in any units.
class Scene {
 public:
  using Step = std::function<void(Build&)>;

  std::string name;
  std::vector<Step> adds, equations;
  std::vector<std::vector<Dim>> inputs, outputs;  ///< of each, scalar by scalar; declared order
  /// Relative motions without stiffness (a free hinge) or that inputs impose on the springs
  /// (both ends of a chain prescribed): at most two poles at 0 each.
  int loose = 0;

  /// As drawn.
  titop::Diagram build(const Units& units = {}) const;
  /// All adds and all equations in another order.
  titop::Diagram shuffled(std::uint64_t seed) const;
  /// Factors of all input or output scalars in other units.
  static Eigen::VectorXd factors(const std::vector<std::vector<Dim>>& dims, const Units& units);
  /// Blocks for transfer_error.
  static std::vector<Eigen::Index> blocks(const std::vector<std::vector<Dim>>& dims);
};

Scene random_scene(const SceneOptions& options);

/// Modal data that some body could have: D_P of a rigid body, modes that carry at most 64 % of it,
/// frequencies between 1 and 128 rad/s, random Phi. Damping ratios 0 or about 0.01.
titop::ModalData random_modes(Rng& rng, int modes, const std::vector<std::string>& children,
                              bool damped);
/// The same body, in other units.
titop::ModalData scaled(titop::ModalData data, const Units& units);

}  // namespace titop_test
