#pragma once

#include <titop/graph/diagram.hpp>

/// A free satellite with reaction wheels, and the orders that its momenta leave. For tests.
namespace titop_test {

struct Wheels {
  int count = 3;           ///< 0: torques act on the hub from outside; 1: about x; 3: x, y, z; 4: a
                           ///< pyramid about z
  double friction = 1e-4;  ///< of each wheel's bearing [N m s/rad]
  bool law = true;         ///< attitude law with three states; else inputs are the wheels' torques
  bool off_centre = true;  ///< the wheels' common point is 0.1 m from the hub's centre of mass
};

/// Rigid hub, flexible boom of four modes, wheels as free rotors. Outputs: "att" (3), "speed1", ...
titop::Diagram satellite(const Wheels& wheels);

/// Order by momentum. The total momenta are constant, 0: with three or four wheels, three of the
/// rates of hub and wheels follow from the others; wheel angles are not seen. The rest counts:
/// three angles of the hub, eight states of the boom, three of the law. Of four wheels under the
/// law, the motion that exerts no torque on the hub is not excited. One wheel about x moves the hub
/// about x and y and the boom out of its plane (two of its modes); y follows from the others.
int order_by_momentum(const Wheels& wheels);

}  // namespace titop_test
