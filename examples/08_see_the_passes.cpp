// How to inspect the compiler: one Graphviz file for the diagram as written and one after each of
// the seven graph passes, and the log of all passes.
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <set>
#include <sstream>
#include <titop/titop.hpp>

#include "by_hand/by_hand.hpp"

using namespace titop;

namespace {

/// Something for every pass: a gain to lower, a part that nothing sees, a channel to invert, a loop
/// between two bodies, a filter that drives nothing.
Diagram scene() {
  Diagram d{"passes"};
  auto u = d.input("u");
  auto cart = d.add("cart", SpringMass{.mass = 2, .stiffness = 80, .parent_mass = 3});
  auto load =
      d.add("load", SpringMass{.mass = 1, .stiffness = 40, .damping = 0.2, .parent_mass = 0.5});
  auto amplifier = d.add("amplifier", Gain{.gain = 12});
  auto filter = d.add("filter", Lti{.A = -Eigen::MatrixXd::Identity(1, 1),
                                    .B = Eigen::MatrixXd::Identity(1, 1),
                                    .C = Eigen::MatrixXd::Identity(1, 1)});
  auto bell = d.add("bell", SpringMass{.mass = 0.1, .stiffness = 900});
  amplifier.in = u;
  cart.parent.force = -amplifier.out;  // imposed where the block expects a motion: inverted
  mount(load, cart.child);             // two masses at one point: an algebraic loop
  filter.in = load.stretch;            // not read: removed
  ground(bell);                        // no input, no output: set aside
  d.output("x") = load.stretch;
  d.output("xdd") = cart.parent.accel;
  return d;
}

}  // namespace

int main() {
  const System system = compile(scene(), {.dump_to = "passes"});
  std::printf("%s\n", system.log().c_str());
  std::set<std::string> files;
  for (const auto& entry : std::filesystem::directory_iterator("passes")) {
    std::ifstream file(entry.path());
    std::ostringstream text;
    text << file.rdbuf();
    if (text.str().rfind("digraph", 0) == 0) files.insert(entry.path().filename().string());
  }
  for (const std::string& name : files) std::printf("passes/%s\n", name.c_str());

  // By hand: x0 (cart's parent, 3 kg), x1 (2 + 0.5 kg), x2 (1 kg).
  by_hand::Structure a = by_hand::empty(3, 1, 2);
  a.M.diagonal() << 3, 2.5, 1;
  a.K << 80, -80, 0, -80, 120, -40, 0, -40, 40;
  a.D.bottomRightCorner<2, 2>() << 0.2, -0.2, -0.2, 0.2;
  a.B << 12, 0, 0;
  a.C << 0, -1, 1, 1, 0, 0;
  std::vector<by_hand::MatrixXcd> passes, hand;
  for (const double w : {0.5, 3.0, 5.0, 12.0, 40.0}) {
    const by_hand::Complex s{0.1 * w, w};
    passes.push_back(system.transfer(s));
    by_hand::MatrixXcd G = by_hand::position_transfer(a, s);
    G.row(1) *= s * s;
    hand.push_back(G);
  }
  std::printf("\norder %d\n", system.state_space().order());
  const bool ok =
      by_hand::agrees("transfer against M and K", by_hand::transfer_error(passes, hand), 1e-13);
  return ok && system.state_space().order() == 4 ? 0 : 1;
}
