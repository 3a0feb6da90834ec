// A block of your own is a struct with a Handle, and as_block() that gives its ports and matrices.
// Here a proof-mass damper: a mass that slides on a body, held by a spring, a damper and a coil.
#include <cstdio>
#include <numbers>
#include <titop/titop.hpp>

#include "by_hand/by_hand.hpp"

using Eigen::MatrixXd;
using titop::Block;
using titop::BlockPtr;
using titop::Dynamics;
using titop::Interface;
using titop::Kinematics;
using titop::Vector3d;

// --- the block -----------------------------------------------------------------------------------

/// A point mass that slides along r, at the point P of the body on which it is mounted.
///
///     m (deltadd + r' a_P) = -k delta - c deltad + f          f: coil, pushes the mass along r
///     F_P = -m (a_P + r deltadd),   no torque                 a_P: linear part of xdd_P
///
/// In the direction of r the mass is felt through spring, damper and coil only: with deltadd put in
/// the direct term is -m (I - r r').
struct ProofMass {
  double mass = 1, stiffness = 1, damping = 0;  ///< [kg], [N/m], [N s/m]
  Vector3d axis = Vector3d::UnitZ();            ///< r, unit vector in the frame of the block

  struct Handle {
    Handle(titop::Graph* graph, int node)
        : parent(titop::detail::channel<6>(graph, node, 0)),
          coil(titop::detail::SignalRef(graph, titop::detail::port_signal(*graph, node, "coil"))),
          stroke(graph, titop::detail::port_signal(*graph, node, "stroke")) {}
    titop::DualPort<6> parent;                ///< mount(damper, body.child("C"))
    titop::Port<0, titop::Kind::plain> coil;  ///< f [N]
    titop::Reading stroke;                    ///< delta [m]
  };
};

class ProofMassBlock : public Block {
 public:
  explicit ProofMassBlock(const ProofMass& p) {
    face_.channels = {{.name = "parent", .size = 6, .takes = titop::Takes::accel}};
    face_.inputs = {{"coil", 1}};
    face_.outputs = {{"stroke", 1, titop::Quantity::position}};
    face_.states = {"delta", "deltad"};
    face_.rates = {1, -1};  // deltad is the rate of delta
    const double m = p.mass, k = p.stiffness, c = p.damping;
    const Vector3d& r = p.axis;
    matrices_->A = (MatrixXd(2, 2) << 0, 1, -k / m, -c / m).finished();
    matrices_->B = MatrixXd::Zero(2, 7);  // inputs: xdd_P (6), coil
    matrices_->B.block<1, 3>(1, 0) = -r.transpose();
    matrices_->B(1, 6) = 1 / m;
    matrices_->C = MatrixXd::Zero(7, 2);  // outputs: F_P (6), stroke
    matrices_->C.topLeftCorner<3, 1>() = k * r;
    matrices_->C.topRightCorner<3, 1>() = c * r;
    matrices_->C(6, 0) = 1;
    matrices_->D = MatrixXd::Zero(7, 7);
    matrices_->D.topLeftCorner<3, 3>() = -m * (titop::Matrix3d::Identity() - r * r.transpose());
    matrices_->D.block<3, 1>(0, 6) = -r;
  }
  std::string_view type() const override { return "ProofMass"; }
  const Interface& interface() const override { return face_; }
  std::shared_ptr<const Dynamics> dynamics(titop::ParameterValues) const override {
    return matrices_;
  }
  /// Kinematics of the ports: P, the only one, is the reference.
  std::optional<Kinematics> kinematics(titop::ParameterValues) const override {
    return Kinematics{
        .reference = 0, .tau = {MatrixXd::Identity(6, 6)}, .Phi = {MatrixXd::Zero(6, 2)}};
  }

 private:
  Interface face_;
  std::shared_ptr<Dynamics> matrices_ = std::make_shared<Dynamics>();
};

BlockPtr as_block(const ProofMass& spec) { return std::make_shared<ProofMassBlock>(spec); }

// --- a scene with it -----------------------------------------------------------------------------

namespace {

using namespace titop;
using std::numbers::pi;

const Beam mast{.length = 4,
                .section = tube(0.06, 0.05),
                .material = {.E = 70e9, .nu = 0.25, .rho = 2700},
                .elements = 3};
const ProofMass tuned{
    .mass = 0.5, .stiffness = 0.5 * 19.0 * 19.0, .damping = 3.5, .axis = Vector3d::UnitZ()};

enum class Damper { none, mounted };

Diagram scene(Damper damper) {
  Diagram d{"mast"};
  auto F = d.input("F");  // gust at the tip along z [N]
  auto beam = d.add("mast", FlexibleBody{mast});
  ground(beam);
  beam.child.force += MatrixXd(Vector6::Unit(2)) * F;
  if (damper == Damper::mounted) {
    auto p = d.add("damper", tuned);
    mount(p, beam.child);
    p.coil = d.input("f");
    d.output("stroke") = p.stroke;
  }
  d.output("xdd") = beam.child.accel.along({0, 0, 1});
  return d;
}

/// By hand: the mast's nodes 1 to 3, then the stroke.
by_hand::Structure by_hand_mast() {
  const by_hand::FreeBeam fe = by_hand::free_beam(by_hand::tube(4, 0.06, 0.05, 70e9, 2700, 3));
  by_hand::Structure a = by_hand::empty(19, 2, 2);
  a.M.topLeftCorner<18, 18>() = fe.M.bottomRightCorner<18, 18>();
  a.K.topLeftCorner<18, 18>() = fe.K.bottomRightCorner<18, 18>();
  by_hand::MatrixXd mass = by_hand::MatrixXd::Zero(3, 19);  // where the proof mass goes
  mass.block<3, 3>(0, 12).setIdentity();
  mass(2, 18) = 1;
  a.M += 0.5 * mass.transpose() * mass;
  a.K(18, 18) = tuned.stiffness;
  a.D(18, 18) = tuned.damping;
  a.B(14, 0) = 1;  // gust on the tip
  a.B(18, 1) = 1;  // the coil acts along the stroke
  a.C(0, 18) = 1;
  a.C(1, 14) = 1;
  return a;
}

}  // namespace

int main() {
  const System bare = compile(scene(Damper::none));
  const System damped = compile(scene(Damper::mounted));
  std::printf("without: first mode %.5f Hz, damping %.4f\n", bare.poles()[0].hertz,
              bare.poles()[0].damping);
  for (const std::size_t i : {0u, 1u})
    std::printf("with:    mode %zu     %.5f Hz, damping %.4f\n", i + 1, damped.poles()[i].hertz,
                damped.poles()[i].damping);
  const by_hand::Structure a = by_hand_mast();
  std::vector<by_hand::MatrixXcd> mine, dense, hand;
  for (const double w : {1.0, 10.0, 25.0, 60.0, 200.0, 3000.0}) {
    const by_hand::Complex s{0.1 * w, w};
    mine.push_back(damped.transfer(s));
    dense.push_back(damped.state_space().transfer(s));
    by_hand::MatrixXcd G = by_hand::position_transfer(a, s);
    G.row(1) *= s * s;
    hand.push_back(G);
  }
  bool ok = by_hand::agrees("transfer against M and K", by_hand::transfer_error(mine, hand), 1e-11);
  ok &= by_hand::agrees("dense model against M and K", by_hand::transfer_error(dense, hand), 1e-9);
  std::printf("order %d of %d: bending across and axial and torsional motion are not reached\n",
              damped.state_space().order(), damped.order());
  return ok ? 0 : 1;
}
