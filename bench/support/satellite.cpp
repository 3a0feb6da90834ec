#include "satellite.hpp"

#include <numbers>

namespace titop_bench {

using namespace titop;

FlexibleBody calculix_beam(const fe::ModeOptions& modes) {
  const fe::Mesh mesh =
      fe::read_calculix(fe::calculix_files(TITOP_DATA_DIR "/calculix_beam/beam_free_mat"),
                        {{"P", 900001}, {"C", 900003}});
  return fe::modal_data(mesh, "P", {"C"}, modes);
}

Diagram satellite(const FlexibleBody& boom, double damper) {
  Diagram d{"satellite"};
  auto W = d.input("W", 6);
  auto tau_m = d.input("tau_m");
  auto hub =
      d.add("hub", RigidBody{.mass = 85,
                             .inertia = Vector3d(9, 11, 13).asDiagonal(),
                             .PA = {0.02, -0.01, 0.05},
                             .children = {{"C1", {0.35, 0, 0.1}}, {"C2", {-0.35, 0.05, 0.1}}}});
  auto boom1 = d.add("boom1", boom), boom2 = d.add("boom2", boom);
  hub.parent.force = -W;
  mount(boom1, hub.child("C1"), Rotation::about({0, 0, 1}, std::numbers::pi / 12));
  auto drive =
      hinge(d, "drive", boom2, hub.child("C2"), Rotation::about({1, 2, 9}, 2.9), {0, 1, 0});
  drive.torque = 60 * drive.angle + damper * drive.rate - tau_m;
  d.output("hub", 6) = hub.parent.accel;
  d.output("tip1", 6) = boom1.child("C").accel;
  d.output("tip2", 6) = boom2.child("C").accel;
  d.output("theta") = drive.angle;
  return d;
}

}  // namespace titop_bench
