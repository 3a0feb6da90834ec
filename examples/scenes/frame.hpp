#pragma once

#include <titop/titop.hpp>
#include <vector>

/// Common to tests and benchmarks of model reduction.
namespace scenes {

/// Three beams in a skew chain, clamped; wrench at the tip to acceleration there.
inline titop::Diagram frame(const titop::FlexibleBody& beam) {
  using titop::Rotation;
  titop::Diagram d{"frame"};
  auto U = d.input("U", 6);
  auto b1 = d.add("b1", beam), b2 = d.add("b2", beam), b3 = d.add("b3", beam);
  b1.parent.accel = 0;
  mount(b2, b1.child("C"), Rotation::about({1, 2, 3}, 0.7));
  mount(b3, b2.child("C"), Rotation::about({3, -1, 1}, -1.1));
  b3.child("C").force = U;
  d.output("a", 6) = b3.child("C").accel;
  return d;
}

/// A body's data truncated at this frequency [Hz]: the rule of thumb with which reduction is
/// compared.
inline titop::ModalData up_to(titop::ModalData m, double hertz) {
  constexpr double two_pi = 6.283185307179586;
  std::vector<Eigen::Index> kept;
  for (Eigen::Index j = 0; j < m.omega.size(); ++j)
    if (m.omega(j) <= two_pi * hertz) kept.push_back(j);
  m.omega = m.omega(kept).eval();
  if (m.xi.size() > 0) m.xi = m.xi(kept).eval();
  m.L_P = m.L_P(kept, Eigen::all).eval();
  for (titop::ModalChild& child : m.children) child.Phi_C = child.Phi_C(Eigen::all, kept).eval();
  return m;
}

}  // namespace scenes
