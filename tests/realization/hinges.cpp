#include <doctest/doctest.h>
#include <fmt/format.h>

#include <cmath>
#include <titop/titop.hpp>

/// Two booms of many modes on a hub, one by a hinge: the effect of one boom on the other equals
/// that of the other on it, independent of names. A body's name determines the place of its
/// equations.

using namespace titop;
using Eigen::Index;

namespace {

Diagram scene(const FlexibleBody& boom, const std::string& hub_name) {
  Diagram d{"two booms"};
  auto W = d.input("W", 6);
  auto hub =
      d.add(hub_name, RigidBody{.mass = 85,
                                .inertia = Eigen::Vector3d(9, 11, 13).asDiagonal(),
                                .children = {{"C1", {0.35, 0, 0.1}}, {"C2", {-0.35, 0, 0.1}}}});
  auto boom1 = d.add("m1", boom), boom2 = d.add("m2", boom);
  hub.parent.force = -W;
  mount(boom1, hub.child("C1"), Rotation::about({0, 0, 1}, 0.26));
  auto drive = hinge(d, "n", boom2, hub.child("C2"), Rotation::about({1, 2, 9}, 2.9), {0, 1, 0});
  drive.torque = 120 * drive.angle;
  d.output("a", 6) = hub.parent.accel;
  return d;
}

/// Modes' accelerations follow their coordinates by A = -G K, G symmetric, K of the modes alone:
/// how far G is from that, of its diagonal.
double asymmetry(const StateSpace& m, const ModalData& data) {
  std::vector<Index> q, v;
  Eigen::VectorXd k(2 * data.omega.size());
  for (const char* boom : {"m1", "m2"})
    for (Index i = 0; i < data.omega.size(); ++i) {
      k(static_cast<Index>(q.size())) = data.omega(i) * data.omega(i);
      q.push_back(m.state(fmt::format("{}.eta{}", boom, i + 1)));
      v.push_back(m.state(fmt::format("{}.eta{}_rate", boom, i + 1)));
    }
  const Eigen::MatrixXd G = -m.A(v, q) * k.cwiseInverse().asDiagonal();
  const Eigen::VectorXd size = G.diagonal().cwiseSqrt();
  const Eigen::MatrixXd off = (G - G.transpose()).cwiseAbs();
  return (off.array() / (size * size.transpose()).array()).maxCoeff();
}

}  // namespace

TEST_CASE("hinged booms of all their modes: A is reciprocal, whatever the names") {
  const FlexibleBody boom = fe::modal_data(
      fe::read_calculix(fe::calculix_files(TITOP_DATA_DIR "/calculix_beam/beam_free_mat"),
                        {{"P", 900001}, {"C", 900003}}),
      "P", {"C"}, {});
  for (const std::string hub : {"a", "m0", "m1b", "z"}) {
    CAPTURE(hub);
    const System system = compile(scene(boom, hub), {.minimize_up_to = 0});
    CHECK(asymmetry(system.state_space(), boom.data()) < 1e-10);
  }
}
