#include "support/five_masses.hpp"

#include <titop/graph/linalg/eigen.hpp>

namespace titop_test {

using namespace titop;

Eigen::Matrix<std::complex<double>, 5, 1> positions(const Five& m, const Five& k,
                                                    std::complex<double> s) {
  Eigen::Matrix<std::complex<double>, 5, 1> f;
  f << -1, 1, 0, 0, 0;
  return impedance(m, k, s).fullPivLu().solve(f);
}

Diagram five_masses_scene(const Five& m, const Five& k) {
  Diagram d{"five masses"};
  auto u = d.input("u");
  auto z1 = d.add("z1", SpringMass{.mass = m[0], .stiffness = k[0]});
  auto z2 = d.add("z2", SpringMass{.mass = m[1], .stiffness = k[1]});
  auto z3 = d.add("z3", SpringMass{.mass = m[2], .stiffness = k[2]});
  auto z4 = d.add("z4", SpringMass{.mass = m[3], .stiffness = k[3]});
  auto z5 = d.add("z5", SpringMass{.mass = m[4], .stiffness = k[4]});
  z1.parent.accel = 0;
  z2.parent.accel = z1.child.accel;
  z3.parent.accel = z1.child.accel;
  z4.parent.accel = z2.child.accel;
  z5.parent.accel = z2.child.accel;
  z1.child.force = z2.parent.force + z3.parent.force - u;
  z2.child.force = z4.parent.force + z5.parent.force + u;
  d.output("x1") = z1.position;
  d.output("x2") = z2.position;
  d.output("x3") = z3.position;
  d.output("x4") = z4.position;
  d.output("x5") = z5.position;
  d.output("a3") = z3.child.accel;
  return d;
}

Diagram third_of_five(const Five& m, const Five& k) {
  Diagram d{"five masses"};
  auto u = d.input("u");
  std::vector<SpringMass::Handle> z;
  for (std::size_t i = 0; i < 5; ++i)
    z.push_back(d.add("z" + std::to_string(i + 1), SpringMass{.mass = m[i], .stiffness = k[i]}));
  ground(z[0]);
  mount(z[1], z[0].child);
  mount(z[2], z[0].child);
  mount(z[3], z[1].child);
  mount(z[4], z[1].child);
  z[0].child.force += -u;
  z[1].child.force += u;
  d.output("x3") = z[2].position;
  return d;
}

}  // namespace titop_test
