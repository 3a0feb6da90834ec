#include <doctest/doctest.h>

#include <array>

#include "assembly.hpp"

/// One beam, its ends clamped, pinned, guided or free in every combination: the same finite
/// elements with those supports.

using namespace loops_test;
using namespace titop;

namespace {

enum class Support { clamped, pinned, guided, free };
constexpr std::array<const char*, 4> kNames{"clamped", "pinned", "guided", "free"};

const Tube kTube{2, 0.05, 0.04, 6};

/// Pinned: no translation. Guided: nothing but translation along z. Returns the held directions.
std::vector<Index> held(Support s) {
  switch (s) {
    case Support::clamped: return {0, 1, 2, 3, 4, 5};
    case Support::pinned: return {0, 1, 2};
    case Support::guided: return {0, 1, 3, 4, 5};
    case Support::free: return {};
  }
  return {};
}

template <class Point>
void support(const Point& point, Support s) {
  switch (s) {
    case Support::clamped: ground(point); break;
    case Support::pinned:
      point.accel.linear = 0;
      release(point);
      break;
    case Support::guided:
      point.accel.along({1, 0, 0}) = 0;
      point.accel.along({0, 1, 0}) = 0;
      point.accel.angular = 0;
      release(point);
      break;
    case Support::free: release(point); break;
  }
}

/// Rigid motions that the supports allow: corank of the rigid motions in the held directions.
Index rigid_motions(const std::vector<Index>& held_of_12, const MatrixXd& rigid) {
  if (held_of_12.empty()) return 6;
  const Eigen::FullPivLU<MatrixXd> lu(rigid(held_of_12, Eigen::all));
  return 6 - lu.rank();
}

}  // namespace

TEST_CASE("a beam on every pair of supports: order and frequencies as its finite elements") {
  const FlexibleBody body = kTube.beam();
  const by_hand::FreeBeam fe = by_hand::free_beam(kTube.numbers());
  const Index n = fe.M.rows();
  const MatrixXd rigid_nodes = by_hand::rigid_motion(kTube.numbers());
  MatrixXd rigid(12, 6);
  rigid << rigid_nodes.topRows(6), rigid_nodes.bottomRows(6);
  for (int p = 0; p < 4; ++p)
    for (int c = 0; c < 4; ++c) {
      CAPTURE(kNames[static_cast<std::size_t>(p)]);
      CAPTURE(kNames[static_cast<std::size_t>(c)]);
      Diagram d{"beam"};
      auto b = d.add("beam", body);
      support(b.parent, static_cast<Support>(p));
      support(b.child, static_cast<Support>(c));
      const System system = compile(d);

      std::vector<Index> ends = held(static_cast<Support>(p)), free;
      std::vector<char> gone(static_cast<std::size_t>(n), 0);
      for (const Index i : held(static_cast<Support>(c))) ends.push_back(6 + i);
      for (const Index i : ends) gone[static_cast<std::size_t>(i < 6 ? i : n - 12 + i)] = 1;
      for (Index i = 0; i < n; ++i)
        if (!gone[static_cast<std::size_t>(i)]) free.push_back(i);
      by_hand::Structure a;
      a.M = fe.M(free, free), a.K = fe.K(free, free);
      const Index zeros = rigid_motions(ends, rigid);
      const auto exact = elastic_poles(a, zeros);
      CHECK(system.state_space().order() == 2 * static_cast<int>(exact.size()));
      CHECK(by_hand::pole_error(all_poles(system), exact) <= 1e-9);
    }
}
