#pragma once

#include <memory>
#include <string_view>
#include <titop/graph/expr.hpp>

/// Ports: the signals in the user's equations. They point into their diagram, which must outlive
/// them; copying one rebinds nothing: `=` between two ports is always an equation.
namespace titop {

/// Side of a channel, or a one-way port.
enum class Kind { accel, force, plain };

namespace detail {

/// A signal, or part of one, that can be read.
class SignalRef {
 public:
  SignalRef() = default;
  SignalRef(Graph* graph, int signal, Term::Of of = Term::Of::signal)
      : graph_(graph), signal_(signal), of_(of) {}

  Expr expr() const;
  Graph* graph() const { return graph_; }
  int signal() const { return signal_; }
  const titop::Part& part() const { return part_; }

  SignalRef linear() const;
  SignalRef angular() const;
  SignalRef along(const Vector3d& r) const;

 protected:
  void set(const Rhs& rhs, bool accumulate, double sign) const;

 private:
  SignalRef half(std::string name, Eigen::Index first) const;

  Graph* graph_ = nullptr;
  /// -1: a port that does not exist; that mistake is already noted. -2 - node: `.child` of a node
  /// that has none or several; noted at its use, with that line.
  int signal_ = -1;
  Term::Of of_ = Term::Of::signal;
  titop::Part part_;
};

/// Makes a handle's name mean another node (`auto tip = z1; tip = z2;`). Ports cannot be assigned
/// one by one: `=` on a port writes an equation.
template <class Handle>
Handle& rebind(Handle& name, const Handle& other) {
  if (&name == &other) return name;
  std::destroy_at(&name);
  return *std::construct_at(&name, other);
}

}  // namespace detail

/// A port of N scalars (1, 3 or 6; 0: any) that equations can drive.
///  - `port = rhs;` writes its equation, `= 0` included. A second `=` is an error.
///  - `port += rhs;` (forces only) adds a term, before or after `=`.
template <int N, Kind K>
class PortBase : public detail::SignalRef {
 public:
  PortBase() = default;
  explicit PortBase(detail::SignalRef ref) : SignalRef(std::move(ref)) {}
  PortBase(const PortBase&) = default;
  // Port-to-port `=` must go through Rhs like any other right-hand side.
  PortBase& operator=(const PortBase&)
    requires detail::never<PortBase>
  = delete;

  void operator=(const Rhs& rhs) const { set(rhs, /*accumulate=*/false, 1); }
  void operator=(Zero zero) const { set(Rhs(zero), /*accumulate=*/false, 1); }
  void operator+=(const Rhs& rhs) const
    requires(K == Kind::force)
  {
    set(rhs, /*accumulate=*/true, 1);
  }
  void operator+=(Zero zero) const
    requires(K == Kind::force)
  {
    set(Rhs(zero), /*accumulate=*/true, 1);
  }
  void operator-=(const Rhs& rhs) const
    requires(K == Kind::force)
  {
    set(rhs, /*accumulate=*/true, -1);
  }
};

template <int N, Kind K>
class Port : public PortBase<N, K> {
 public:
  using PortBase<N, K>::PortBase;
  using PortBase<N, K>::operator=;
  Port() = default;
  Port(const Port&) = default;
  Port& operator=(const Port&)
    requires detail::never<Port>
  = delete;
};

/// Three components: the linear or the angular half of a dual vector.
template <Kind K>
class Port<3, K> : public PortBase<3, K> {
 public:
  using PortBase<3, K>::PortBase;
  using PortBase<3, K>::operator=;
  Port() = default;
  Port(const Port&) = default;
  Port& operator=(const Port&)
    requires detail::never<Port>
  = delete;
  /// The component along the vector r (any length but 0), in the port's frame. Throws bad_value for
  /// r = 0.
  Port<1, K> along(const Vector3d& r) const { return Port<1, K>(detail::SignalRef::along(r)); }
};

/// A dual vector (linear; angular).
template <Kind K>
class Port<6, K> : public PortBase<6, K> {
 public:
  Port() = default;
  explicit Port(detail::SignalRef ref)
      : PortBase<6, K>(ref), linear(ref.linear()), angular(ref.angular()) {}
  using PortBase<6, K>::operator=;
  Port(const Port&) = default;
  Port& operator=(const Port&)
    requires detail::never<Port>
  = delete;
  /// The linear component along the vector r (any length but 0). Throws bad_value for r = 0.
  Port<1, K> along(const Vector3d& r) const { return linear.along(r); }
  /// The angular component about the vector r (any length but 0). Throws bad_value for r = 0.
  Port<1, K> about(const Vector3d& r) const { return angular.along(r); }

  Port<3, K> linear, angular;
};

/// A signal of a block that can only be read: nothing can be assigned to it. Its parts are
/// `.linear()`, `.angular()` and, of three components, `.along(r)`: `p.rate.linear().along(r)`.
class Reading : public detail::SignalRef {
 public:
  using SignalRef::SignalRef;
  explicit Reading(SignalRef ref) : SignalRef(std::move(ref)) {}
  Reading(const Reading&) = default;
  Reading& operator=(const Reading&) = delete;
};

/// An external input of the diagram.
class InputRef : public detail::SignalRef {
 public:
  using SignalRef::SignalRef;
};

/// A two-way port: acceleration and wrench at one point, in its body's frame.
///  - child channel: `force` is the wrench applied BY the child ON the body at C;
///  - parent channel: `force` is the wrench applied BY the body ON its parent at P. An external
///    wrench U on the body is therefore `parent.force = -U`; the compile log notes `= U`.
/// Exactly one of the two is driven, per degree of freedom; the other one can be read.
template <int N>
class DualPort {
 public:
  DualPort() = default;
  DualPort(Graph* graph, int accel_signal, int force_signal)
      : accel(detail::SignalRef(graph, accel_signal)),
        force(detail::SignalRef(graph, force_signal)),
        reaction(graph, force_signal, Term::Of::reaction),
        position(graph, accel_signal, Term::Of::position),
        rate(graph, accel_signal, Term::Of::rate) {}
  DualPort(const DualPort&) = default;
  /// Deleted: `a.parent = b.child` would look like an equation, but rebind the port. Write mount(a,
  /// b.child). Along a chain keep the points in a list: `sites.push_back(panel.child)`.
  DualPort& operator=(const DualPort&) = delete;

  Port<N, Kind::accel> accel;  ///< [m/s^2; rad/s^2]
  Port<N, Kind::force> force;  ///< [N; N m]
  /// Force without the terms added by `+=`: the support force, if the motion is imposed.
  Reading reaction;
  /// Displacement from rest [m; rad], small, in the body's frame; the rotation is a rotation
  /// vector. If the states determine it (a chain to the ground), it adds no state. For rigid and
  /// prescribed motions, which the states do not determine, integrators are added, separately for
  /// the linear and the angular half, once for all points that move together: one per degree of
  /// freedom for a rate, two for a position, initial value 0.
  Reading position;
  Reading rate;  ///< velocity [m/s; rad/s], likewise

  /// One axis of the six: the point's motion along r and the force along r, as a port for blocks of
  /// one axis. r: any length but 0, in the port's frame.
  DualPort<1> along(const Vector3d& r) const
    requires(N == 6)
  {
    return part([&](const detail::SignalRef& s) { return s.linear().along(r); });
  }
  /// The same about r: angular acceleration and torque.
  DualPort<1> about(const Vector3d& r) const
    requires(N == 6)
  {
    return part([&](const detail::SignalRef& s) { return s.angular().along(r); });
  }

 private:
  template <int>
  friend class DualPort;
  DualPort(const detail::SignalRef& a, const detail::SignalRef& f, const detail::SignalRef& r,
           const detail::SignalRef& x, const detail::SignalRef& v)
      : accel(a), force(f), reaction(r), position(x), rate(v) {}
  template <class Take>
  DualPort<1> part(Take take) const {
    return {take(accel), take(force), take(reaction), take(position), take(rate)};
  }
};

/// The channels that have names; also the only one, if there is just one.
template <int N>
class Children : public DualPort<N> {
 public:
  Children() = default;
  Children(Graph* graph, int node);
  /// The child channel of this name; an unknown name is reported with the valid ones.
  DualPort<N> operator()(std::string_view name,
                         SourceLine at = std::source_location::current()) const;

 private:
  Graph* graph_ = nullptr;
  int node_ = -1;
};

namespace detail {
/// Channel of a node by its position among the block's channels.
template <int N>
DualPort<N> channel(Graph* graph, int node, int spec) {
  const auto& n = graph->nodes[static_cast<std::size_t>(node)];
  const auto& c = graph->channels[static_cast<std::size_t>(n.first_channel + spec)];
  return {graph, c.accel, c.force};
}
/// Signal index of a block's one-way port.
int port_signal(const Graph& graph, int node, std::string_view name);
/// Index of the block's channel `name`, -1 if there is none.
int find_channel(const Graph& graph, int node, std::string_view name);
/// The same among its child channels of this size only: the shapes of a body's lines are scalar
/// ones.
int find_child(const Graph& graph, int node, std::string_view name, int size);
/// True for a parameter (not a number) that this graph has.
bool belongs_to(const Value& parameter, const Graph& graph);
/// Notes the mistake "parameter of another diagram" for every such parameter in these terms.
void note_foreign_parameters(Graph& graph, const std::vector<Term>& terms, const SourceLine& at);
/// Notes the mistake "not exactly one child" for every such port in these terms.
void note_missing(Graph& graph, const std::vector<Term>& terms, const SourceLine& at);
/// Notes the mistake "no channel of this name", with the names of this size that exist; once per
/// line.
void note_unknown_channel(Graph& graph, int node, std::string_view name, int size, SourceLine at);
/// Index of the only channel of this size that is not "parent", -1 if there are several or none.
int only_child(const Graph& graph, int node, int size);
}  // namespace detail

template <int N>
Children<N>::Children(Graph* graph, int node)
    : DualPort<N>(detail::only_child(*graph, node, N) < 0
                      ? DualPort<N>(graph, -2 - node, -2 - node)
                      : detail::channel<N>(graph, node, detail::only_child(*graph, node, N))),
      graph_(graph),
      node_(node) {}

template <int N>
DualPort<N> Children<N>::operator()(std::string_view name, SourceLine at) const {
  const int spec = detail::find_child(*graph_, node_, name, N);
  if (spec >= 0) return detail::channel<N>(graph_, node_, spec);
  detail::note_unknown_channel(*graph_, node_, name, N, at);
  return {graph_, -1, -1};
}

}  // namespace titop
