#pragma once

#include <fmt/format.h>

#include <Eigen/Core>
#include <titop/titop.hpp>
#include <vector>

/// Scenes whose motion can be written down.
namespace simulation_test {

/// A mass on a spring on the ground; states: stretch and its rate. Output: its position.
inline titop::Diagram mass_on_spring(double m, double k, double c) {
  titop::Diagram d{"mass on a spring"};
  auto u = d.input("u");
  auto z = d.add("z", titop::SpringMass{.mass = m, .stiffness = k, .damping = c});
  z.parent.accel = 0;
  z.child.force = u;
  d.output("x") = z.stretch;
  return d;
}

/// n masses in a row on the ground, a force on the last; outputs: all stretches.
inline titop::Diagram row_of_masses(const std::vector<double>& m, const std::vector<double>& k,
                                    double c = 0) {
  titop::Diagram d{"row of masses"};
  auto u = d.input("u");
  std::vector<titop::SpringMass::Handle> z;
  for (std::size_t i = 0; i < m.size(); ++i) {
    z.push_back(d.add(fmt::format("z{}", i + 1),
                      titop::SpringMass{.mass = m[i], .stiffness = k[i], .damping = c}));
    if (i == 0)
      ground(z[0]);
    else
      mount(z[i], z[i - 1].child);
  }
  z.back().child.force = u;
  for (std::size_t i = 0; i < m.size(); ++i) d.output(fmt::format("s{}", i + 1)) = z[i].stretch;
  return d;
}

/// Kinetic and potential energy of row_of_masses from its states (stretch, rate, body by body): the
/// mass i moves with the sum of all rates up to it.
inline double energy(const std::vector<double>& m, const std::vector<double>& k,
                     const Eigen::VectorXd& x) {
  double sum = 0, velocity = 0;
  for (std::size_t i = 0; i < m.size(); ++i) {
    const double s = x(2 * static_cast<Eigen::Index>(i));
    velocity += x(2 * static_cast<Eigen::Index>(i) + 1);
    sum += 0.5 * m[i] * velocity * velocity + 0.5 * k[i] * s * s;
  }
  return sum;
}

}  // namespace simulation_test
