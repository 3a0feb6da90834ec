#include "satellite.hpp"

using namespace titop;

namespace scenes {

FlexibleBody read_boom(const fe::ModeOptions& modes) {
  const fe::Mesh mesh =
      fe::read_calculix(fe::calculix_files(TITOP_DATA_DIR "/calculix_beam/beam_free_mat"),
                        {{"P", 900001}, {"C", 900003}});
  return fe::modal_data(mesh, "P", {"C"}, modes);
}

Diagram satellite(const FlexibleBody& boom, const AttitudeLaw* law, double damper) {
  Diagram d{"satellite"};
  auto W = d.input("W", 6);       // wrench on the hub at P [N; N m]
  auto tau_m = d.input("tau_m");  // torque of the motor on boom 2 [N m]
  auto hub = d.add("hub", hub_spec);
  auto boom1 = d.add("boom1", boom);
  auto boom2 = d.add("boom2", boom);
  hub.parent.force = -W;
  mount(boom1, hub.child("C1"), Rotation::about(turn1, angle1));
  auto drive =
      hinge(d, "drive", boom2, hub.child("C2"), Rotation::about(turn2, angle2), hinge_axis);
  drive.torque = kappa * drive.angle + damper * drive.rate - tau_m;
  if (law)
    hub.parent.force.angular +=
        law->kp * hub.parent.position.angular() + law->kd * hub.parent.rate.angular();

  d.output("hub", 6) = hub.parent.accel;  // [m/s^2; rad/s^2]
  d.output("tip1", 6) = boom1.child("C").accel;
  d.output("tip2", 6) = boom2.child("C").accel;
  d.output("theta") = drive.angle;  // [rad]
  return d;
}

}  // namespace scenes

Diagram demo_satellite() { return scenes::satellite(scenes::read_boom()); }
