#pragma once

#include <titop/graph/diagram.hpp>
#include <titop/graph/mount.hpp>
#include <vector>

namespace titop {

/// A symmetric matrix on the six degrees of freedom (x, y, z, rx, ry, rz): its diagonal, or all of
/// it (6 x 6; a vector of 6 is a diagonal). Every number may be a parameter:
///
///     .stiffness = {k, k, 9e4, 300, 300, 100}
///     .stiffness = SixAxes(K).with(1, 5, k15)
class SixAxes {
 public:
  /// A value at (row, column) and (column, row), counted from 0 (`with` counts from 1).
  struct Entry {
    int row, column;
    Value value;
  };

  SixAxes() : SixAxes(0, 0, 0, 0, 0, 0) {}
  SixAxes(Value x, Value y, Value z, Value rx, Value ry, Value rz);
  template <class M>
  SixAxes(const Eigen::MatrixBase<M>& m) : SixAxes() {
    static_assert(M::RowsAtCompileTime == 6 || M::RowsAtCompileTime == Eigen::Dynamic);
    if (m.rows() != 6 || (m.cols() != 6 && m.cols() != 1))
      throw Error(Code::size, "stiffness and damping of six axes are 6 x 6",
                  "give a 6 x 6 matrix, a vector of 6, or six numbers");
    Matrix6 K = Matrix6::Zero();
    if (m.cols() == 1)
      for (Eigen::Index i = 0; i < 6; ++i) K(i, i) = m(i, 0);
    else
      for (Eigen::Index j = 0; j < 6; ++j)
        for (Eigen::Index i = 0; i < 6; ++i) K(i, j) = m(i, j);
    numbers_ = K, diagonal_ = false;
  }
  /// The same with this value at (row, column) and (column, row), 1 to 6. Throws bad_value.
  SixAxes with(int row, int column, Value value) const;
  Matrix6 at(ParameterValues values) const;  ///< 6 x 6, for these parameter values
  Matrix6 nominal() const;                   ///< at the parameters' nominal values
  /// Those that are parameters, or were given by `with`.
  const std::vector<Entry>& entries() const { return entries_; }
  bool is_diagonal() const { return diagonal_; }  ///< given as six values

 private:
  Matrix6 numbers_ = Matrix6::Zero();
  std::vector<Entry> entries_;  ///< in place of numbers
  bool diagonal_ = true;
};

/// Spring-damper of six axes between two points (bushing, isolator), massless, in the frame of the
/// body at its child end. With the relative displacement q = x_C - x_P [m; rad]:
///
///     F_P = F_C = K q + C qd        (F_P: by the bushing on its parent; F_C: by the child on it)
///     qdd = xdd_C - xdd_P
///
/// States: q (x, y, z, rx, ry, rz), then qd. Both ends take the acceleration, u = [xdd_C; xdd_P],
/// y = [F_C; F_P; q; qd]; no direct feedthrough.
///
/// In the posture both ends coincide, and K and C are about that point, K from static tests or from
/// its elastic centre E by tau_EC' K_E tau_EC. Preloads are not modelled.
///
/// K and C are symmetric and positive semidefinite, checked by `add`, and by `update` for new
/// values (bad_value; not_finite); an axis without stiffness is a free one.
struct Bushing {
  SixAxes stiffness;     ///< K [N/m, N, N m/rad]
  SixAxes damping = {};  ///< C [N s/m, N s, N m s/rad]

  struct Handle {
    Handle(Graph* graph, int node)
        : child(detail::channel<6>(graph, node, 0)),
          parent(detail::channel<6>(graph, node, 1)),
          displacement(graph, detail::port_signal(*graph, node, "displacement")),
          rate(graph, detail::port_signal(*graph, node, "rate")) {}
    Handle(const Handle&) = default;
    Handle& operator=(const Handle& other) { return detail::rebind(*this, other); }
    DualPort<6> child;     ///< C, mount of the body
    DualPort<6> parent;    ///< P, mount of the bushing
    Reading displacement;  ///< q = x_C - x_P [m; rad], 6
    Reading rate;          ///< qd [m/s; rad/s], 6
  };
};
BlockPtr as_block(const Bushing& spec);

/// Mounts `body` on the child point `site` through a bushing called `name`, in the frame of the
/// body, with T_ba the mounting rotation, body to site. On the ground: add it, `ground` it and
/// `mount(body, b.child)`.
///
///     auto iso = bushing(d, "isolator", wheel, hub.child("W"), T_ba,
///                        {.stiffness = {4e4, 4e4, 9e4, 300, 300, 100}, .damping = c});
template <class Handle>
  requires HasParent<Handle, 6>
Bushing::Handle bushing(Diagram& d, std::string name, const Handle& body, const DualPort<6>& site,
                        const Rotation& T_ba, const Bushing& spec,
                        SourceLine at = std::source_location::current()) {
  const Bushing::Handle result = d.add(name, spec, at);
  detail::mount_through(result, name, body, site, T_ba, at);
  return result;
}

/// The same between any two points a (its child end, whose frame it has) and b, both of which have
/// their own equations already or are left free: it only adds its force to both. For a parent point
/// this `+=` alone is a release. T_ba: frame of a to frame of b.
///
///     bushing(d, "snubber", wheel.child("rim"), hub.child("S"), T_ba, {.stiffness = k});
Bushing::Handle bushing(Diagram& d, std::string name, const DualPort<6>& a, const DualPort<6>& b,
                        const Rotation& T_ba, const Bushing& spec,
                        SourceLine at = std::source_location::current());

}  // namespace titop
