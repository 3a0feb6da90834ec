#pragma once

#include <titop/graph/block.hpp>
#include <titop/graph/graph.hpp>

/// Blocks without a finite state space.
namespace titop {

/// A block that has infinitely many modes, and whose transfer is known in closed form at every s,
/// derives from this too (ExactBeam). It has no states in its interface, and overrides
/// Block::response. Its dynamics() have Y at one real s > 0 as D, which decides the pivots of the
/// elimination; transfers use the closed form alone. Results that need a state space are refused
/// (require_state_space).
class ClosedForm {
 public:
  /// Y at s (outputs x inputs), as the sum of this many matrices: the first is Y rounded to double,
  /// the second the rest rounded to double, and so on: 1 has 16 digits, 2 have 32, 4 more than 50.
  /// Throws singular if s is a pole of the block, not_finite if numbers overflow.
  virtual std::vector<Eigen::MatrixXcd> closed_form(std::complex<double> s, ParameterValues values,
                                                    int doubles) const = 0;
  /// Kinematics of the ports as if the block did not deform, without states: the geometry of closed
  /// chains. The block constrains no motion: each port moves by itself, too.
  virtual Kinematics undeformed() const = 0;
  /// "has infinitely many modes", as in Block::why_singular, and a block to take in its place.
  virtual Block::Cause no_state_space() const = 0;

 protected:
  ~ClosedForm() = default;
};

/// The same block, none if it has a finite state space. O(1).
const ClosedForm* closed_form_of(const Block& block);

/// True if a block of this graph has no finite state space. O(nodes).
bool has_closed_form(const Graph& graph);

/// Throws not_rational if the graph has such blocks, one mistake for each.
void require_state_space(const Graph& graph);
/// The same for one block.
void require_state_space(const Block& block);

}  // namespace titop
