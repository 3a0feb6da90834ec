#include "telecom.hpp"

#include <numbers>

using namespace titop;
using Eigen::Matrix3d;
using Eigen::MatrixXd;

namespace scenes::telecom {
namespace {

/// Yoke on a drive, and three panels hinged one to the other, outward along the yoke's x.
void add_wing(Diagram& d, const std::string& side, const DualPort<6>& site, double turn,
              const FlexibleBody& yoke_body, const FlexibleBody& panel_body) {
  auto yoke = d.add(side + " yoke", yoke_body);
  auto drive = hinge(d, side + " drive", yoke, site, Rotation::about({0, 0, 1}, turn), {1, 0, 0});
  drive.torque = drive_k * drive.angle + drive_c * drive.rate;
  auto inner = d.add(side + " panel 1", panel_body);
  mount(inner, yoke.child("C"));
  for (const int i : {2, 3}) {
    auto outer = d.add(side + " panel " + std::to_string(i), panel_body);
    auto h = hinge(d, side + " hinge " + std::to_string(i), outer, inner.child("outer"), Rotation(),
                   {0, 1, 0});
    h.torque = hinge_k * h.angle + hinge_c * h.rate;
    inner = outer;
  }
}

}  // namespace

Lti law_block() {
  const Matrix3d P = kp.asDiagonal(), D = lag * kd.asDiagonal().toDenseMatrix(),
                 I = lag * Matrix3d::Identity();
  Lti law{.A = MatrixXd::Zero(6, 6), .B = MatrixXd::Zero(6, 3), .C = MatrixXd::Zero(3, 6)};
  law.A << -I, Matrix3d::Zero(), I, -I;  // angles filtered once, and twice
  law.B.topRows(3) = I;
  law.C << D, P - D;
  return law;
}

FlexibleBody read_yoke() {
  const fe::Mesh mesh =
      fe::read_calculix(fe::calculix_files(TITOP_DATA_DIR "/calculix_beam/beam_free_mat"),
                        {{"P", 900001}, {"C", 900003}});
  return fe::modal_data(mesh, "P", {"C"}, {.kept = 2, .residual = {"C"}, .xi = {0.01}});
}

FlexibleBody sandwich_panel() {
  fe::Mesh mesh = plate_mesh(panel);
  mesh = fe::with_interface(mesh, "inner", fe::rigid(fe::edge(mesh, "x0")));
  mesh = fe::with_interface(mesh, "outer", fe::rigid(fe::edge(mesh, "x1")));
  return fe::modal_data(mesh, "inner", {"outer"}, {.kept = 3, .xi = {0.003}});
}

Diagram satellite(const FlexibleBody& yoke, double factor) {
  Diagram d{"telecom satellite"};
  auto T = d.input("T", 3);
  auto command = d.input("command", 3);
  auto gain = d.param("gain", factor);
  auto hub = d.add("hub", hub_spec);
  const FlexibleBody panel_body = sandwich_panel();
  add_wing(d, "north", hub.child("north"), std::numbers::pi / 2, yoke, panel_body);
  add_wing(d, "south", hub.child("south"), -std::numbers::pi / 2, yoke, panel_body);
  slosh(d, "liquid", hub.child("tank"), liquid);
  auto law = d.add("law", law_block());
  law.in = hub.parent.position.angular();
  const auto torque = d.loop_point("torque", law.out);
  for (int i = 0; i < 3; ++i) {
    const Vector3d axis = Vector3d::Unit(i);
    auto wheel = d.add(
        std::string("wheel ") + "xyz" [i], Rotor {
          .mass = wheel_mass, .axial = wheel_axial, .transverse = wheel_transverse, .axis = axis,
          .momentum = i == 1 ? wheel_momentum : 0
        });
    mount(wheel, hub.child("wheels"));
    const MatrixXd row = axis.transpose();
    wheel.torque = row * command - gain * (row * torque);
  }
  hub.parent.force.linear = 0;
  hub.parent.force.angular = -T;
  d.output("attitude", 3) = hub.parent.position.angular();
  return d;
}

}  // namespace scenes::telecom

Diagram telecom_attitude_law() {
  Diagram d{"law"};
  auto attitude = d.input("attitude", 3);  // [rad]
  auto law = d.add("law", scenes::telecom::law_block());
  law.in = attitude;
  d.output("command", 3) = -law.out;  // [N m]
  return d;
}
