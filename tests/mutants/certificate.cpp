#include <cstdio>
#include <numbers>
#include <titop/titop.hpp>

#include "generate/diagrams/random_diagram.hpp"
#include "support/five_masses.hpp"
#include "support/half_ties.hpp"
#include "support/lossy_row.hpp"
#include "support/planted.hpp"
#include "support/rng.hpp"
#include "support/small_scenes.hpp"

/// Verdict of the certificate alone on some thirty fixed graphs: 0 if it finds no fault, 1 if it
/// finds one, if states that were taken out had to be put back, or if the compiler refuses, with
/// the first words about it. No expected numbers: tests/mutants/run counts how many mistakes
/// planted in compiler/ it finds.
namespace {

using namespace titop;

/// Masses in two rings that share some, closed by stiff springs: soft ones depend on the others,
/// with either sign. Outputs are a position and a rate, which are states already.
Diagram ring() {
  Diagram d{"ring"};
  auto u = d.input("u");
  std::vector<SpringMass::Handle> z;
  for (int i = 0; i < 5; ++i) {
    z.push_back(d.add("z" + std::to_string(i), SpringMass{.mass = 1.0 + i,
                                                          .stiffness = 40.0 + 7 * i,
                                                          .damping = i == 2 ? 0.5 : 0.0,
                                                          .parent_mass = 0.25}));
    i == 0 ? ground(z[0]) : mount(z.back(), z[static_cast<std::size_t>(i) - 1].child);
  }
  auto back = d.add("back", SpringMass{.mass = 2, .stiffness = 300});
  auto other = d.add("other", SpringMass{.mass = 1.5, .stiffness = 400});
  mount(back, z[1].child);
  weld(back.child, z[4].child);
  mount(other, z[0].child);
  weld(other.child, z[3].child);
  z[3].child.force += u;
  d.output("a") = 2.0 * z[3].child.accel + z[4].parent.accel;  // one motion, read twice
  d.output("x") = z[4].position;
  d.output("v") = back.child.rate;
  return d;
}

/// Two masses whose accelerations go round a loop with gain 0.999: three digits fewer, no fault.
Diagram near_singular() {
  Diagram d{"near singular"};
  auto u = d.input("u");
  auto a = d.add("a", SpringMass{.mass = 2, .stiffness = 30});
  auto b = d.add("b", SpringMass{.mass = 2, .stiffness = 50});
  ground(a);
  ground(b);
  a.child.force = 1.5 * b.child.accel + u + 0.498 * b.child.accel;  // one signal twice
  b.child.force = 2.0 * a.child.accel;
  d.output("a") = a.child.accel;
  return d;
}

/// A loop whose gain is 2^-40 from 1: of 16 digits four are left.
Diagram few_digits() {
  Diagram d{"few digits"};
  auto u = d.input("u");
  auto K = d.add("K", Lti{.D = Eigen::MatrixXd::Constant(1, 1, 1 + 0x1p-20)});
  auto L = d.add("L", Lti{.D = Eigen::MatrixXd::Constant(1, 1, (1 - 0x1p-20) / 3)});
  auto a = d.add("a", SpringMass{.mass = 2, .stiffness = 30, .damping = 0.1});
  ground(a);
  K.in = 3.0 * L.out + u;
  L.in = K.out;
  a.child.force = 0x1p-40 * K.out;
  d.output("x") = a.stretch;
  return d;
}

/// The five masses with springs 4 and 5 in tune, so that one mode of the two cannot be seen.
Diagram in_tune() {
  auto stiffness = titop_test::kStiffnesses;
  stiffness[4] = stiffness[3] * titop_test::kMasses[4] / titop_test::kMasses[3];
  return titop_test::five_masses_scene(titop_test::kMasses, stiffness);
}

/// Two hubs, each with a pair of masses nearly in tune: the mode of a pair is driven and seen by
/// some 1e-6, which would be missed, and their product below kNobody, which is not.
constexpr double kNobody = 1e-13;
Diagram nearly_in_tune() {
  Diagram d{"nearly in tune"};
  // The pair on the soft hub is less observable than controllable, on the hard one more.
  for (const bool soft : {true, false}) {
    const std::string name = soft ? "soft" : "hard";
    auto hub = d.add(name, SpringMass{.mass = 4, .stiffness = soft ? 64.0 : 900.0});
    ground(hub);
    const double off = soft ? 7e-7 : 3e-7;
    for (const double k : {25.0, 25 * (1 + off)}) {
      auto on =
          d.add(name + (k > 25 ? "_1" : "_0"), SpringMass{.mass = soft ? 1 : 1.1, .stiffness = k});
      mount(on, hub.child);
    }
    hub.child.force += d.input("f_" + name);
    d.output("x_" + name) = hub.stretch;
  }
  return d;
}

/// Points without mass that are pushed: one spring follows its force at once, a damper lags, and
/// two springs share a point.
Diagram no_mass() {
  Diagram d{"no mass"};
  auto u = d.input("u"), v = d.input("v");
  auto a = d.add("a", SpringMass{.mass = 2, .stiffness = 7});
  auto b = d.add("b", SpringMass{.mass = 3, .stiffness = 11, .damping = 0.3});
  auto c = d.add("c", SpringMass{.mass = 1.5, .stiffness = 20});
  auto e = d.add("e", SpringMass{.mass = 2.5, .stiffness = 30});
  a.parent.force = -u;
  b.parent.force = -v;
  c.parent.accel = e.parent.accel;
  e.parent.force = -u - c.parent.force;
  d.output("a") = a.child.accel;
  d.output("stretch") = a.stretch;
  d.output("x") = a.parent.position;
  d.output("b") = b.parent.rate;
  d.output("c") = c.child.accel;
  d.output("e") = e.stretch;
  return d;
}

/// Three beams welded to a triangle, free in space, one of them stiffer.
Diagram triangle() {
  Diagram d{"triangle"};
  const auto beam = [](double width) -> FlexibleBody {
    return Beam{.length = 1,
                .section = rectangle(width, 0.02),
                .material = {.E = 70e9, .nu = 0.33, .rho = 2700},
                .elements = 1};
  };
  std::vector<BodyHandle> b;
  for (int i = 0; i < 3; ++i) b.push_back(d.add("b" + std::to_string(i), beam(0.03 + 0.01 * i)));
  const Rotation turn = Rotation::about({0, 0, 1}, 2 * std::numbers::pi / 3);
  for (std::size_t i = 0; i < 3; ++i) mount(b[(i + 1) % 3], b[i].child, turn);
  b[1].child.force += d.input("U", 6);
  d.output("a0", 6) = b[0].parent.accel;
  d.output("x2", 6) = b[2].child.position;
  return d;
}

/// Two chains, free in space: of one a position that is a function of the states already is
/// integrated again, of the other only a difference of positions is read.
Diagram free_chains() {
  Diagram d{"free chains"};
  auto u = d.input("u"), v = d.input("v");
  auto a = d.add("a", SpringMass{.mass = 1, .stiffness = 10, .damping = 0.1, .parent_mass = 2});
  auto c = d.add("c", SpringMass{.mass = 4, .stiffness = 50, .damping = 0.2, .parent_mass = 3});
  auto f = d.add("f", Lti{.A = Eigen::MatrixXd{{0, 1}, {0, 0}},
                          .B = Eigen::MatrixXd{{0}, {1}},
                          .C = Eigen::MatrixXd::Identity(2, 2)});
  a.parent.force = u;
  a.child.force = -v;
  c.parent.force = v;
  f.in = a.child.accel;
  d.output("x", 2) = f.out;
  d.output("root") = a.parent.position;
  d.output("relative") = c.child.position - c.parent.position;
  return d;
}

/// Controllers without modal form whose states must change places to be eliminated, one after the
/// other and round a loop.
Diagram out_of_order() {
  Diagram d{"out of order"};
  auto u = d.input("u");
  auto a = d.add("a", Lti{.A = Eigen::MatrixXd{{-1, 0, 0}, {-1, 0, 0}, {0, -4, 0}},
                          .B = Eigen::MatrixXd{{1}, {0}, {0}},
                          .C = Eigen::MatrixXd{{0, 0, 1}}});
  auto b = d.add("b", Lti{.A = Eigen::MatrixXd{{-2, 30, -11, 52, 17},
                                               {-27, 1, 44, -8, 13},
                                               {73, 9, 2, 11, -31},
                                               {12, 55, 6, -9, 40},
                                               {5, -21, 64, 33, 3}},
                          .B = Eigen::MatrixXd{{0}, {1}, {0}, {2}, {-1}},
                          .C = Eigen::MatrixXd{{1, 0, 0, 0.3, 2}},
                          .D = Eigen::MatrixXd{{0.25}}});
  a.in = u - 0.5 * b.out;
  b.in = a.out + 0.5 * b.out;
  d.output("y") = b.out;
  d.output("z") = a.out;
  return d;
}

/// A flexible body whose tip is moved, and a rigid one on it that is carried by an end: positions
/// of their other ends.
Diagram from_the_tip() {
  Diagram d{"from the tip"};
  auto U = d.input("U", 6);
  const auto beam =
      d.add("beam", FlexibleBody(Beam{.length = 2,
                                      .section = rectangle(0.03, 0.02),
                                      .material = {.E = 70e9, .nu = 0.33, .rho = 2700},
                                      .elements = 2}));
  const auto arm = d.add("arm", RigidBody{.mass = 3,
                                          .inertia = Eigen::Vector3d(1, 2, 2.5).asDiagonal(),
                                          .PA = {0.1, 0.2, 0},
                                          .children = {{"e", {1, 0.5, 0}}, {"f", {0, -1, 0.3}}}});
  beam.child.accel = U;
  beam.parent.force = 0;
  weld(arm.child("e"), beam.parent, Rotation::about({0, 0, 1}, 0.7));
  arm.parent.force = 0;
  d.output("root", 6) = beam.parent.position;
  d.output("end", 6) = arm.child("f").position;
  d.output("rate", 6) = arm.parent.rate;
  return d;
}

int faults(const System& system, const std::string& name) {
  const FullCertificate c = certify(system, {.points = 12});
  const bool put_back = c.order.removed.empty() && c.order.change > 0;
  if (c.holds() && !put_back) return 0;
  std::printf("%s: %s\n", name.c_str(),
              put_back ? to_string(c.order).c_str() : c.faults.front().c_str());
  return 1;
}

int check(const Diagram& d, const std::string& name, const Options& options = {}) {
  const System system = compile(d, options);
  if (faults(system, name)) return 1;
  if (system.parameters().empty()) return 0;
  ParameterList other = system.parameters();
  for (auto& [parameter, value] : other) value *= 1.25;
  return faults(system.update(other), name + ", updated");
}

/// Bodies tied by some of the six directions of their points, in closed chains.
int check_half_ties() {
  if (check(half_ties::turned(), "turned")) return 1;
  for (const std::uint64_t seed : {2U, 5U, 6U}) {
    titop_test::Rng rng(seed);
    if (check(half_ties::diagram(half_ties::draw(rng, true)), "half ties " + std::to_string(seed)))
      return 1;
  }
  return 0;
}

/// Rows whose waves decay by many digits from the tip to the base.
int check_rows() {
  for (const titop_test::LossyRow& row : titop_test::lossy_rows(150, 20))
    if (check(row.diagram(), "row")) return 1;
  return 0;
}

int run() {
  for (const auto& scene : titop_test::scenes())
    if (check(scene.make(), scene.name)) return 1;
  if (check(ring(), "ring")) return 1;
  if (check(near_singular(), "near singular")) return 1;
  if (check(few_digits(), "few digits")) return 1;
  if (check(no_mass(), "no mass")) return 1;
  if (check(triangle(), "triangle")) return 1;
  if (check(free_chains(), "free chains")) return 1;
  if (check(out_of_order(), "out of order") || check(from_the_tip(), "from the tip")) return 1;
  if (check_half_ties() || check_rows()) return 1;
  if (check(in_tune(), "in tune")) return 1;
  if (check(nearly_in_tune(), "nearly in tune", {.resolution = kNobody})) return 1;
  for (const std::uint64_t seed : {3U, 15U, 27U})
    if (check(titop::generate::random_diagram(titop::generate::random_options(seed)).build(),
              "random " + std::to_string(seed)))
      return 1;
  for (const std::uint64_t seed : {1U, 2U, 3U})
    if (check(titop_test::planted(seed).diagram, "planted " + std::to_string(seed))) return 1;
  return 0;
}

}  // namespace

int main() {
  try {
    return run();
  } catch (const std::exception& e) {
    std::printf("refused: %s\n", e.what());
    return 1;
  }
}
