#pragma once

#include <Eigen/SparseCore>
#include <string>
#include <vector>

namespace titop {

/// The same model before elimination, sparse: E vdot = A v + B u, y = C v + D u with v = [x; z], x
/// the states, z algebraic variables: dependent states of closed chains, then the interface
/// unknowns (accelerations and forces). E = diag(I, 0). Its size is that of the diagram, O(bodies)
/// entries for any wiring with few children per body.
struct Descriptor {
  Eigen::SparseMatrix<double> E, A;     ///< (n + unknowns) x (n + unknowns)
  Eigen::SparseMatrix<double> B, C, D;  ///< (n + unknowns) x nu, ny x (n + unknowns), ny x nu
  int states = 0;                       ///< n
  std::vector<std::string> names;       ///< of v: "z1.stretch", ..., then "B.C1.accel(1)", ...
  std::vector<std::string> inputs, outputs;
};

}  // namespace titop
