#pragma once

#include <titop/graph/diagram.hpp>

namespace titop {

/// A controller or filter: xdot = A x + B in, out = C x + D in; plain signals without frames. `add`
/// checks shapes (code size), entries (not_finite) and places of values (bad_value: outside of the
/// matrix, or given twice). With A = 0, B = C = 1 and D = 0 it is an Integrator; an integral that
/// is already a state of a body adds no state. One transfer costs O(n^3) below 32 states or with
/// parameters among `values`; from 32 states O(n^2) for each uncoupled part of A (2 x 2 modal
/// blocks: O(n)), after O(n^3) once.
///
///     auto K = d.add("K", Lti{.A = a, .B = b, .C = c, .D = Eigen::MatrixXd::Zero(1, 1)});
///     K.in = h.rate;   h.torque = K.out;
struct Lti {
  /// A value in place of a number of a matrix, one per place.
  struct Entry {
    char matrix = 'A';        ///< 'A', 'B', 'C' or 'D'
    int row = 1, column = 1;  ///< from 1
    Value value = 0;
  };
  Eigen::MatrixXd A = {};          ///< n x n; leave A, B and C empty for a pure D
  Eigen::MatrixXd B = {};          ///< n x nu
  Eigen::MatrixXd C = {};          ///< ny x n
  Eigen::MatrixXd D = {};          ///< ny x nu; empty: 0
  std::vector<Entry> values = {};  ///< parameters: {{'A', 2, 1, -1 * k}, {'A', 2, 2, -1 * c}}

  struct Handle {
    Handle(Graph* graph, int node);
    Handle(const Handle&) = default;
    Handle& operator=(const Handle& other) { return detail::rebind(*this, other); }
    Port<0, Kind::plain> in;
    Reading out;
  };
};
BlockPtr as_block(const Lti& spec);
/// The values of a block made from an Lti, for the diagram file; empty of others.
std::vector<Lti::Entry> lti_values(const Block& block);

/// out = integral of in, `size` scalars, 0 at the start; one state per scalar.
/// Integrates an acceleration to a velocity and a velocity to a position: `out` has that quantity.
/// `add` throws size for a size below 1.
struct Integrator {
  int size = 1;
  using Handle = Lti::Handle;
};
BlockPtr as_block(const Integrator& spec);

}  // namespace titop
