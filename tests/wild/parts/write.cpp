#include "wild/parts/write.hpp"

#include <fmt/format.h>

#include <memory>
#include <titop/titop.hpp>

namespace wild {

using namespace titop;

namespace {

std::size_t at(int i) { return static_cast<std::size_t>(i); }

/// Handles of the nodes, by kind; entries of other kinds are empty.
class Writer {
 public:
  explicit Writer(const Scene& scene) : scene_(scene), d_("wild") {
    for (std::size_t i = 0; i < scene.inputs.size(); ++i)
      inputs_.push_back(d_.input(fmt::format("u{}", i + 1), scene.inputs[i]));
    for (const wild::Node& n : scene.nodes) add(n);
    for (const Tie& t : scene.ties)
      if (!between_two(t)) tie(t);
    for (std::size_t i = 0; i < scene.nodes.size(); ++i) rest(static_cast<int>(i));
    for (const Load& l : scene.loads) load(l);
    for (std::size_t i = 0; i < scene.outputs.size(); ++i)
      d_.output(fmt::format("y{}", i + 1), size_of(scene, scene.outputs[i])) =
          read(scene.outputs[i]);
  }
  Diagram take() { return std::move(d_); }

 private:
  void add(const wild::Node& n) {
    masses_.emplace_back();
    bodies_.emplace_back();
    joints_.emplace_back();
    ltis_.emplace_back();
    bushings_.emplace_back();
    sums_.emplace_back();
    switch (n.kind) {
      case wild::Node::Kind::mass:
        masses_.back() = d_.add(
            n.name, SpringMass{.mass = n.m, .stiffness = n.k, .damping = n.c, .parent_mass = n.m0});
        break;
      case wild::Node::Kind::body: bodies_.back() = body(n); break;
      case wild::Node::Kind::joint: joints_.back() = d_.add(n.name, joint_of(n)); break;
      case wild::Node::Kind::bushing: bushings_.back() = bushing(n); break;
      case wild::Node::Kind::lti:
        if (n.written == wild::Node::Written::sum)
          sums_.back() = d_.add(n.name, sum_of(n));
        else
          ltis_.back() = std::make_shared<const InOut>(lti(n));
        break;
    }
  }

  /// Ports of an Lti, a Gain or a MatrixGain.
  struct InOut {
    Port<0, Kind::plain> in;
    titop::Reading out;
  };

  InOut lti(const wild::Node& n) {
    const auto ports = [](const auto& handle) { return InOut{handle.in, handle.out}; };
    if (n.written == wild::Node::Written::lti)
      return ports(d_.add(n.name, Lti{.A = n.A, .B = n.B, .C = n.C, .D = n.D}));
    if (n.written == wild::Node::Written::matrix) return ports(d_.add(n.name, MatrixGain{n.D}));
    return ports(d_.add(n.name, Gain{.gain = n.D(0, 0), .size = static_cast<int>(n.D.rows())}));
  }

  /// D is [I or -I, ...].
  static titop::Sum sum_of(const wild::Node& n) {
    titop::Sum spec{.signs = "", .size = static_cast<int>(n.D.rows())};
    for (Eigen::Index j = 0; j < n.D.cols(); j += n.D.rows())
      spec.signs += n.D(0, j) > 0 ? '+' : '-';
    return spec;
  }
  void sum_inputs(const wild::Node& n, const titop::Sum::Handle& handle) const {
    const Eigen::Index size = n.D.rows();
    for (int i = 0; i < static_cast<int>(n.D.cols() / size); ++i) {
      wild::Sum part;
      for (const Share& share : n.in) {
        const MatrixXd rows = share.gain.middleRows(i * size, size);
        if (!rows.isZero(0)) part.push_back({share.of, rows});
      }
      if (part.empty())
        handle.in(i + 1) = 0;
      else
        handle.in(i + 1) = sum(part);
    }
  }

  /// The tie of a bushing's end to another body, if it has one.
  const Tie* tie_of(const Point& end) const {
    for (const Tie& t : scene_.ties)
      if (t.a == end && t.b.node >= 0) return &t;
    return nullptr;
  }
  /// True if the function `bushing` between two points writes this tie: both ends are tied to
  /// nodes before it, and its child's frame is that of the bushing.
  bool between_two(const Tie& t) const {
    const int i = t.a.node;
    if (scene_.nodes[at(i)].kind != wild::Node::Kind::bushing) return false;
    const Tie *child = tie_of({i, 0}), *parent = tie_of({i, -1});
    return child && parent && child->b.node < i && parent->b.node < i && child->T.isIdentity(0);
  }

  Bushing::Handle bushing(const wild::Node& n) {
    const Bushing spec{.stiffness = six(n.stiffness), .damping = six(n.damping)};
    const int i = static_cast<int>(bushings_.size()) - 1;
    const Tie *child = tie_of({i, 0}), *parent = tie_of({i, -1});
    if (child && between_two(*child))
      return titop::bushing(d_, n.name, point6(child->b), point6(parent->b),
                            Rotation::matrix(parent->T), spec);
    return d_.add(n.name, spec);
  }
  static SixAxes six(const Matrix6d& m) {
    if (m.isDiagonal(0)) return {m(0, 0), m(1, 1), m(2, 2), m(3, 3), m(4, 4), m(5, 5)};
    return m;
  }

  BodyHandle body(const wild::Node& n) {
    if (n.beam) return d_.add(n.name, beam(n));
    if (n.omega.size() == 0) {
      RigidBody spec{.mass = n.mass, .inertia = n.inertia, .PA = n.PA};
      for (std::size_t i = 0; i < n.sites.size(); ++i)
        spec.children.push_back({site_name(i), n.sites[i].PC});
      return d_.add(n.name, spec);
    }
    ModalData data{.omega = n.omega, .xi = n.xi, .L_P = n.L_P, .D_P = n.D_P, .children = {}};
    for (std::size_t i = 0; i < n.sites.size(); ++i)
      data.children.push_back({site_name(i), n.sites[i].PC, n.sites[i].Phi});
    return d_.add(n.name, FlexibleBody(data));
  }

  /// Its tip, clamped at the other end, is "C"; any other point has its number.
  static std::string site_name(const wild::Node& n, std::size_t i) {
    if (!n.beam) return site_name(i);
    return tip_only(*n.beam) ? "C" : std::to_string(n.beam->sites[i]);
  }
  static bool tip_only(const wild::Beam& b) {
    return b.parent == 0 && b.sites == std::vector{b.elements};
  }

  static FlexibleBody beam(const wild::Node& n) {
    const wild::Beam& b = *n.beam;
    titop::Beam spec{.length = b.length,
                     .section = {.area = b.area, .I_y = b.I_y, .I_z = b.I_z, .J = b.J},
                     .material = {.E = b.E, .rho = b.rho},
                     .elements = b.elements,
                     .modes = {.xi = b.xi}};
    if (b.I_x > 0) spec.section.I_x = b.I_x;
    (b.G > 0 ? spec.material.G : spec.material.nu) = b.G > 0 ? b.G : b.nu;
    if (b.kept >= 0) spec.modes.kept = b.kept;
    for (const int point : b.residual) spec.modes.residual.push_back(std::to_string(point));
    if (tip_only(b)) return FlexibleBody(spec);
    std::vector<std::string> names;
    for (std::size_t i = 0; i < b.sites.size(); ++i) names.push_back(site_name(n, i));
    return FlexibleBody(
        fe::modal_data(beam_mesh(spec), std::to_string(b.parent), names, spec.modes));
  }

  static std::string site_name(std::size_t i) { return fmt::format("C{}", i + 1); }
  static std::string axis_name(int i) { return fmt::format("q{}", i + 1); }

  static Joint joint_of(const wild::Node& n) {
    Joint spec;
    for (int i = 0; i < static_cast<int>(n.axes.size()); ++i)
      spec.axes.push_back(n.axes[at(i)].turns ? about(n.axes[at(i)].r, axis_name(i))
                                              : along(n.axes[at(i)].r, axis_name(i)));
    return spec;
  }

  DualPort<1> point1(const Point& p) const {
    return p.site < 0 ? masses_[at(p.node)]->parent : DualPort<1>(masses_[at(p.node)]->child);
  }
  DualPort<6> point6(const Point& p) const {
    if (joints_[at(p.node)])
      return p.site < 0 ? joints_[at(p.node)]->parent : DualPort<6>(joints_[at(p.node)]->child);
    if (bushings_[at(p.node)])
      return p.site < 0 ? bushings_[at(p.node)]->parent : bushings_[at(p.node)]->child;
    const BodyHandle& b = *bodies_[at(p.node)];
    return p.site < 0 ? b.parent : b.child(site_name(scene_.nodes[at(p.node)], at(p.site)));
  }

  void tie(const Tie& t) {
    if (one_axis(scene_, t.a)) {
      const DualPort<1> a = point1(t.a);
      if (t.input >= 0)
        a.accel = inputs_[at(t.input)];
      else if (t.b.node < 0)
        ground(a);
      else if (t.a.site < 0)
        mount(*masses_[at(t.a.node)], point1(t.b));
      else
        weld(a, point1(t.b));
      return;
    }
    const DualPort<6> a = point6(t.a);
    const Rotation T = Rotation::matrix(t.T);
    const double sign = t.a.site < 0 ? 1 : -1;
    if (t.b.node < 0) {
      hold(a, t);
      return;
    }
    const DualPort<6> b = point6(t.b);
    switch (t.of) {
      case Tie::Of::all:
        if (t.a.site >= 0)
          weld(a, b, T);
        else if (bodies_[at(t.a.node)])
          mount(*bodies_[at(t.a.node)], b, T);
        else if (bushings_[at(t.a.node)])
          mount(*bushings_[at(t.a.node)], b, T);
        else
          mount(*joints_[at(t.a.node)], b, T);
        break;
      case Tie::Of::linear:
        a.accel.linear = T.inverse() * b.accel.linear;
        if (sign > 0)
          b.force.linear += T * a.reaction.linear();
        else
          b.force.linear += -(T * a.reaction.linear());
        break;
      case Tie::Of::angular:
        a.accel.angular = T.inverse() * b.accel.angular;
        if (sign > 0)
          b.force.angular += T * a.reaction.angular();
        else
          b.force.angular += -(T * a.reaction.angular());
        break;
      case Tie::Of::axes:
        for (const wild::Axis& axis : t.axes) {
          const Vector3d there = t.T * axis.r;
          const DualPort<1> one = axis.turns ? a.about(axis.r) : a.along(axis.r);
          const DualPort<1> other = axis.turns ? b.about(there) : b.along(there);
          // By matrices: the two are in different frames.
          one.accel = MatrixXd::Constant(1, 1, 1.0) * other.accel;
          other.force += MatrixXd::Constant(1, 1, sign) * one.reaction;
        }
    }
  }

  /// To the ground, or by an input.
  void hold(const DualPort<6>& a, const Tie& t) {
    const auto set = [&](const auto& port) {
      if (t.input >= 0)
        port = inputs_[at(t.input)];
      else
        port = 0;
    };
    if (t.of == Tie::Of::all) set(a.accel);
    if (t.of == Tie::Of::linear) set(a.accel.linear);
    if (t.of == Tie::Of::angular) set(a.accel.angular);
    if (t.of != Tie::Of::axes) return;
    for (std::size_t i = 0; i < t.axes.size(); ++i) {
      const wild::Axis& axis = t.axes[i];
      const auto port = axis.turns ? a.accel.about(axis.r) : a.accel.along(axis.r);
      if (t.input < 0) {
        port = 0;
        continue;
      }
      MatrixXd entry = MatrixXd::Zero(1, static_cast<Eigen::Index>(t.axes.size()));
      entry(0, static_cast<Eigen::Index>(i)) = 1;
      port = entry * inputs_[at(t.input)];
    }
  }

  /// Equations of points without tie: released points, axes, inputs of controllers.
  void rest(int i) {
    const wild::Node& n = scene_.nodes[at(i)];
    const auto tied = [&](const Point& p) {
      int sum = 0;
      for (const Tie& t : scene_.ties)
        if (t.a == p) sum += size_of(scene_, t);
      return sum;
    };
    if (n.kind == wild::Node::Kind::mass && tied({i, -1}) == 0) release(masses_[at(i)]->parent);
    if (n.kind == wild::Node::Kind::joint || n.kind == wild::Node::Kind::body)
      for (int site = -1; site < static_cast<int>(n.sites.size()); ++site) {
        const int sum = tied({i, site});
        if (sum < 6 && (site < 0 || sum > 0)) release(point6({i, site}));
      }
    if (sums_[at(i)])
      sum_inputs(n, *sums_[at(i)]);
    else if (n.kind == wild::Node::Kind::lti)
      ltis_[at(i)]->in = sum(n.in);
    for (int axis = 0; axis < static_cast<int>(n.axes.size()); ++axis) mechanism(i, axis);
  }

  void mechanism(int i, int number) {
    const Joint::AxisPorts axis = joints_[at(i)]->axis(axis_name(number));
    for (const Mechanism& m : scene_.mechanisms) {
      if (m.node != i || m.axis != number) continue;
      if (m.moves && m.more.empty()) axis.accel = 0;
      if (m.moves && !m.more.empty()) axis.accel = sum(m.more);
      if (m.moves) return;
      if (m.more.empty())
        axis.force = m.k * axis.position + m.c * axis.rate;
      else
        axis.force = m.k * axis.position + m.c * axis.rate + sum(m.more);
      return;
    }
    axis.force = 0;
  }

  Expr read(const Reading& r) const {
    using Measured = Reading::Measured;
    if (r.measured == Measured::input) return inputs_[at(r.axis)].expr();
    if (r.measured == Measured::stretch) return masses_[at(r.at.node)]->stretch.expr();
    if (r.measured == Measured::displacement || r.measured == Measured::displacement_rate) {
      const Bushing::Handle& b = *bushings_[at(r.at.node)];
      const titop::Reading six = r.measured == Measured::displacement ? b.displacement : b.rate;
      return r.half == 0 ? six.expr() : r.half == 1 ? six.linear().expr() : six.angular().expr();
    }
    if (r.measured == Measured::out && sums_[at(r.at.node)])
      return sums_[at(r.at.node)]->out.expr();
    if (r.measured == Measured::out) return ltis_[at(r.at.node)]->out.expr();
    if (r.measured >= Measured::axis_accel) {
      const Joint::AxisPorts axis = joints_[at(r.at.node)]->axis(axis_name(r.axis));
      if (r.measured == Measured::axis_accel) return axis.accel.expr();
      if (r.measured == Measured::axis_rate) return axis.rate.expr();
      return r.measured == Measured::axis_position ? axis.position.expr() : axis.force.expr();
    }
    if (one_axis(scene_, r.at)) return signal(point1(r.at), r.measured).expr();
    const detail::SignalRef six = signal(point6(r.at), r.measured);
    return r.half == 0 ? six.expr() : r.half == 1 ? six.linear().expr() : six.angular().expr();
  }

  template <int N>
  static detail::SignalRef signal(const DualPort<N>& p, Reading::Measured measured) {
    if (measured == Reading::Measured::accel) return p.accel;
    if (measured == Reading::Measured::rate) return p.rate;
    return measured == Reading::Measured::position ? p.position : p.reaction;
  }

  Expr sum(const wild::Sum& shares) const {
    Expr total;
    for (std::size_t i = 0; i < shares.size(); ++i) {
      const Expr term = shares[i].gain * read(shares[i].of);
      total = i == 0 ? term : total + term;
    }
    return total;
  }

  void load(const Load& l) {
    const Expr w = sum(l.sum);
    const Rhs on_body = l.at.site < 0 ? Rhs(-w) : Rhs(w);
    if (one_axis(scene_, l.at)) {
      point1(l.at).force += on_body;
      return;
    }
    const DualPort<6> p = point6(l.at);
    if (l.half == 0) p.force += on_body;
    if (l.half == 1) p.force.linear += on_body;
    if (l.half == 2) p.force.angular += on_body;
  }

  const Scene& scene_;
  Diagram d_;
  std::vector<InputRef> inputs_;
  std::vector<std::optional<SpringMass::Handle>> masses_;
  std::vector<std::optional<BodyHandle>> bodies_;
  std::vector<std::optional<Joint::Handle>> joints_;
  std::vector<std::shared_ptr<const InOut>> ltis_;
  std::vector<std::optional<Bushing::Handle>> bushings_;
  std::vector<std::optional<titop::Sum::Handle>> sums_;
};

}  // namespace

Diagram diagram_of(const Scene& scene) { return Writer(scene).take(); }

}  // namespace wild
