#include <fmt/format.h>

#include <cmath>
#include <titop/blocks/rotor.hpp>
#include <titop/blocks/specified.hpp>
#include <titop/graph/linalg/index.hpp>
#include <titop/graph/linalg/rounding.hpp>
#include <titop/graph/opened.hpp>

namespace titop {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;

constexpr Index kSpin = 6;  ///< input: nud; output: C_m; the readings follow

void check_rotor(double mass, double axial, double transverse) {
  const std::string given =
      fmt::format("Rotor{{mass {:.6g}, axial {:.6g}, transverse {:.6g}}}", mass, axial, transverse);
  if (!std::isfinite(mass) || !std::isfinite(axial) || !std::isfinite(transverse))
    throw Error(Code::not_finite, given, "give finite numbers");
  if (mass < 0 || axial < 0 || transverse < 0)
    throw Error(Code::bad_inertia, given, "give a mass [kg] and inertias [kg m^2] of 0 or more");
  if (axial > 2 * transverse * (1 + linalg::kMatrixDigits))
    throw Error(
        Code::bad_inertia,
        fmt::format("{}: no body has an axial inertia above twice the transverse one", given),
        "give both about the centre of mass, transverse across the spin axis");
}

class RotorBlock : public Block, public Specified<Rotor> {
 public:
  explicit RotorBlock(const Rotor& spec) : spec_(spec), a_(unit_direction(about(spec.axis))) {
    face_.channels = {{"parent", 6, Takes::accel}, {"", 1, Takes::accel, "accel", "torque"}};
    face_.outputs = {{"angle", 1, Quantity::position}, {"speed", 1, Quantity::velocity}};
    face_.states = {"angle", "speed"};
    face_.rates = rates_follow(1);
  }
  const Rotor& spec() const override { return spec_; }
  std::string_view type() const override { return "Rotor"; }
  const Interface& interface() const override { return face_; }

  std::shared_ptr<const Dynamics> dynamics(ParameterValues values) const override {
    const double m = spec_.mass.at(values), I_a = spec_.axial.at(values),
                 I_t = spec_.transverse.at(values);
    check_rotor(m, I_a, I_t);
    const Matrix3d I_A = I_t * Matrix3d::Identity() + (I_a - I_t) * a_ * a_.transpose();
    auto d = std::make_shared<Dynamics>();
    d->A = MatrixXd{{0, 1}, {0, 0}};
    d->B = MatrixXd::Zero(2, 7);
    d->B(1, kSpin) = 1;
    d->C = MatrixXd::Zero(9, 2);
    d->C.bottomRows<2>().setIdentity();
    d->D = MatrixXd::Zero(9, 7);
    d->D.topLeftCorner<6, 6>() = -rigid_mass(m, I_A, -spec_.PA);
    d->D.block<3, 1>(3, kSpin) = -I_a * a_;
    d->D.block<1, 3>(kSpin, 3) = -I_a * a_.transpose();
    d->D(kSpin, kSpin) = -I_a;
    return d;
  }
  Pattern feedthrough() const override {
    Pattern p = Pattern::Constant(9, 7, true);
    p.bottomRows<2>().setConstant(false);
    p.block<3, 1>(0, kSpin).setConstant(false);  // it spins about its centre of mass
    p.block<1, 3>(kSpin, 0).setConstant(false);
    return p;
  }
  Pattern moved_by() const override {
    Pattern p = Pattern::Constant(1, 7, false);
    p(0, kSpin) = true;
    return p;
  }
  Pattern seen_by() const override {
    Pattern p = Pattern::Constant(9, 1, false);
    p.bottomRows<2>().setConstant(true);
    return p;
  }
  std::optional<Kinematics> kinematics(ParameterValues) const override {
    Kinematics k{.reference = 0, .tau = {}, .Phi = {}};
    k.tau = {MatrixXd::Identity(6, 6), MatrixXd::Zero(1, 6)};
    k.Phi = {MatrixXd::Zero(6, 2), MatrixXd{{1, 0}}};
    return k;
  }
  std::vector<Value> values() const override { return {spec_.mass, spec_.axial, spec_.transverse}; }
  /// mass: z = acceleration of A; axial: z = its whole angular acceleration about a; transverse:
  /// z = the two across it.
  std::optional<Opened> opened(ParameterValues values,
                               std::span<const int> parameters) const override {
    const Matrix6 tau_AP = tau(-spec_.PA);
    std::vector<OpenedPair> pairs;
    const auto add = [&](const Value& value, const Vector6& along, double spin) {
      Eigen::RowVectorXd z(7);
      z << along.transpose() * tau_AP, spin;
      Eigen::VectorXd w = Eigen::VectorXd::Zero(9);
      w.head<7>() = -z.transpose();
      pairs.push_back({value, {}, w, {}, z});
    };
    for (Index i = 0; i < 3; ++i) add(spec_.mass, Vector6::Unit(i), 0);
    const auto [b, c] = across(a_);
    const auto turning = [](const Vector3d& v) {
      Vector6 x = Vector6::Zero();
      x.tail<3>() = v;
      return x;
    };
    add(spec_.axial, turning(a_), 1);
    add(spec_.transverse, turning(b), 0);
    add(spec_.transverse, turning(c), 0);
    return with_pairs(*dynamics(values), pairs, parameters);
  }
  std::optional<Cause> why_singular(int channel, ParameterValues values) const override {
    if (channel == 1)
      return Cause{"has no axial inertia",
                   "give Rotor{.axial = ...}, or hold its speed: accel = 0"};
    if (spec_.mass.at(values) == 0)
      return Cause{"has mass 0", "give Rotor{.mass = ...}, or impose parent.accel instead"};
    return Cause{"has a singular inertia",
                 "give Rotor{.axial = ..., .transverse = ...}, or impose the motion about it"};
  }

 private:
  Rotor spec_;
  Vector3d a_;
  Interface face_;
};

}  // namespace

Rotor::Handle::Handle(Graph* graph, int node)
    : parent(detail::channel<6>(graph, node, 0)),
      accel(detail::channel<1>(graph, node, 1).accel),
      torque(detail::channel<1>(graph, node, 1).force),
      angle(graph, detail::port_signal(*graph, node, "angle")),
      speed(graph, detail::port_signal(*graph, node, "speed")) {}

void Rotor::connect(const Handle& rotor, SourceLine at) const {
  if (!momentum.is_parameter() && momentum.nominal() == 0) return;
  Graph& g = *rotor.parent.accel.graph();
  const std::size_t first = g.equations.size();
  titop::momentum(rotor.parent, momentum, axis, at);
  for (std::size_t i = first; i < g.equations.size(); ++i) g.equations[i].of_spec = true;
}

BlockPtr as_block(const Rotor& spec) {
  check_rotor(spec.mass.nominal(), spec.axial.nominal(), spec.transverse.nominal());
  if (!std::isfinite(spec.momentum.nominal()) || !spec.PA.allFinite())
    throw Error(Code::not_finite, "the momentum or the position of a Rotor is not finite",
                "check momentum and PA");
  return std::make_shared<RotorBlock>(spec);
}

void unbalance(Diagram& d, const Rotor::Handle& rotor, std::string name, const Imbalance& imbalance,
               double speed, SourceLine at) {
  const Graph& g = d.graph();
  if (rotor.speed.graph() != &g)
    throw Error(Code::unknown_name,
                fmt::format("{} has no such rotor: it is of another diagram", g.name),
                "pass the rotor that `add` of this diagram has returned");
  const Node& node = g.nodes[linalg::at(g.signals[linalg::at(rotor.speed.signal())].node)];
  const Rotor& spec = dynamic_cast<const Specified<Rotor>&>(*node.block).spec();
  const double square = speed * speed, force = imbalance.static_kgm * square,
               torque = imbalance.dynamic_kgm2 * square;
  if (!std::isfinite(force) || !std::isfinite(torque))
    throw Error(Code::not_finite, fmt::format("the imbalance of {} is not finite", node.name),
                "give finite numbers");
  const auto [b, c] = across(unit_direction(about(spec.axis)));
  MatrixXd turning(3, 2), ahead(3, 2);  // u and a x u, per cos and sin
  turning << b, c;
  ahead << c, -b;
  const MatrixXd moment = force * cross(spec.PA) * turning + torque * ahead;  // about P
  const InputRef wave = d.input(std::move(name), 2, at);
  // From outside on the body: with the sign - at a parent point.
  rotor.parent.force.linear += Rhs(MatrixXd(-force * turning) * wave, at);
  rotor.parent.force.angular += Rhs(MatrixXd(-moment) * wave, at);
}

}  // namespace titop
