#pragma once

#include <Eigen/Geometry>

#include "assembly.hpp"

/// Rings of beams, each turned about z against the one before, welded to themselves, free in space.
/// A wrench on one corner; accelerations there and at another.
namespace loops_test {

struct Ring {
  int beams;
  Tube tube;
  int far;  ///< the other corner

  Eigen::AngleAxisd turn() const { return {2 * pi / beams, Eigen::Vector3d::UnitZ()}; }

  by_hand::Structure by_hand() const {
    const Index inner = 6 * (tube.elements - 1), corners = 6 * beams;
    Assembly r(corners + beams * inner, 6, 12);
    const by_hand::Beam beam = tube.numbers();
    // Corner i is where beam i begins, in that beam's frame.
    const by_hand::Matrix6 T = by_hand::dual(turn().toRotationMatrix());
    for (Index i = 0; i < beams; ++i)
      r.beam(beam, r.unit(6 * i, 6), T * r.unit(6 * ((i + 1) % beams), 6), corners + i * inner);
    r.a.C.topRows(6) = r.unit(6 * far, 6);
    r.a.C.bottomRows(6) = r.unit(6 * 2, 6);
    r.a.B = (r.unit(6 * 2, 6)).transpose();
    return r.a;
  }

  /// The order of equations must not matter: `first` is the first one.
  titop::Diagram diagram(int first = 0) const {
    titop::Diagram d{"ring"};
    const titop::FlexibleBody body = tube.beam();
    std::vector<titop::BodyHandle> b;
    b.reserve(static_cast<std::size_t>(beams));
    for (int i = 0; i < beams; ++i) b.push_back(d.add("b" + std::to_string(i), body));
    const titop::Rotation T = titop::Rotation::about({0, 0, 1}, turn().angle());
    for (int i = 0; i < beams; ++i) {
      const int k = (i + first) % beams;
      mount(b[static_cast<std::size_t>((k + 1) % beams)], b[static_cast<std::size_t>(k)].child, T);
    }
    b[1].child.force += T * d.input("U", 6);
    d.output("far", 6) = b[static_cast<std::size_t>(far)].parent.accel;
    d.output("near", 6) = b[2].parent.accel;
    return d;
  }
};

}  // namespace loops_test
