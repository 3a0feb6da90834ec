#include "support/planted.hpp"

#include <string>
#include <titop/blocks/spring_mass.hpp>
#include <titop/graph/mount.hpp>
#include <titop/graph/nodes/lti.hpp>

#include "support/rng.hpp"

namespace titop_test {

using namespace titop;

namespace {

enum class Damped { none, proportional, some };

struct Builder {
  Rng rng;
  Planted p;
  Damped damped;
  int count = 0;

  explicit Builder(std::uint64_t seed)
      : rng(seed), p{Diagram{"planted"}}, damped(static_cast<Damped>(rng.below(3))) {}

  /// Between low and high in steps of 2^-6.
  double number(int low, int high) { return low + rng.below((high - low) * 64 + 1) / 64.0; }

  SpringMass spring() {
    SpringMass z{.mass = number(1, 4), .stiffness = number(16, 128)};
    if (damped == Damped::proportional) z.damping = z.stiffness.nominal() / 1024;
    if (damped == Damped::some && rng.chance(0.5)) z.damping = number(0, 1);
    return z;
  }
  SpringMass::Handle add(const SpringMass& z) {
    return p.diagram.add("z" + std::to_string(count++), z);
  }

  /// A string of masses, in equal copies, at one place.
  void twins(const SpringMass::Handle& at) {
    const int length = 1 + rng.below(2), copies = 2 + rng.below(2);
    std::vector<SpringMass> shape;
    for (int i = 0; i < length; ++i) shape.push_back(spring());
    for (int copy = 0; copy < copies; ++copy) {
      SpringMass::Handle on = at;
      for (const SpringMass& z : shape) {
        auto next = add(z);
        mount(next, on.child);
        on = next;
      }
    }
    p.order += 2 * length;
    p.planted += 2 * length * (copies - 1);
  }

  Lti lag(double pole, double zero, bool direct) {
    return {.A = Eigen::MatrixXd{{-pole}},
            .B = Eigen::MatrixXd{{1}},
            .C = Eigen::MatrixXd{{direct ? zero - pole : 1}},
            .D = Eigen::MatrixXd{{direct ? 1. : 0.}}};
  }

  /// The sum of equal filters of u.
  template <class Signal>
  void copies(const Signal& u) {
    const Lti filter = lag(number(1, 8), 0, false);
    auto a = p.diagram.add("a" + std::to_string(count), filter);
    auto b = p.diagram.add("b" + std::to_string(count), filter);
    a.in = u;
    b.in = u;
    p.diagram.output("y" + std::to_string(count++)) = a.out + b.out;
    p.order += 1;
    p.planted += 1;
  }

  /// 1 / (s + a), then (s + a) / (s + b).
  template <class Signal>
  void cancelled(const Signal& u) {
    const double pole = number(1, 4), other = number(5, 8);
    auto a = p.diagram.add("a" + std::to_string(count), lag(pole, 0, false));
    auto b = p.diagram.add("b" + std::to_string(count), lag(other, pole, true));
    a.in = u;
    b.in = a.out;
    p.diagram.output("y" + std::to_string(count++)) = b.out;
    p.order += 1;
    p.planted += 1;
  }
};

}  // namespace

Planted planted(std::uint64_t seed) {
  Builder b(seed);
  auto u = b.p.diagram.input("u");
  std::vector<SpringMass::Handle> chain;
  const int n = 2 + b.rng.below(3);
  for (int i = 0; i < n; ++i) {
    chain.push_back(b.add(b.spring()));
    i == 0 ? ground(chain[0]) : mount(chain.back(), chain[static_cast<std::size_t>(i) - 1].child);
  }
  b.p.order = 2 * n;
  chain.back().child.force += u;
  b.p.diagram.output("x") = chain.front().stretch;
  const int kind = b.rng.below(4);
  if (kind != 1) b.twins(chain[static_cast<std::size_t>(b.rng.below(n))]);
  if (kind == 1 || kind == 2) b.copies(u);
  if (kind == 3) b.cancelled(u);
  return std::move(b.p);
}

}  // namespace titop_test
