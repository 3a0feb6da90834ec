#pragma once

#include <fmt/format.h>

#include <optional>

#include "generate/diagrams/units.hpp"
#include "scenes/by_hand.hpp"
#include "support/rng.hpp"

/// Random networks of spring-masses with points that have no mass, and the same as M, D, K.
namespace index_reduction_test {

using namespace scenes_test;
using titop::generate::Units;
using titop_test::Rng;

/// Springs between masses, some through points without mass from which several springs fan out.
struct Network {
  titop::Diagram diagram;
  by_hand::Structure a;
  int order = 0;  ///< 2 per mass, 1 per point without mass on which a damper acts
  std::vector<int> outputs_dims;
};

class RandomNetwork {
 public:
  RandomNetwork(std::uint64_t seed, const Units& units) : rng_(seed), u_(units) {}

  Network make() {
    const int masses = 2 + rng_.below(5);
    titop::Diagram d{"network"};
    auto force = d.input("u");
    const titop::generate::Dim stiffness{0, 1, -2}, damping{0, 1, -1};
    std::vector<titop::SpringMass::Handle> z;
    const auto spring = [&](double mass) {
      const double k = rng_.octaves(3, 8), c = rng_.chance(0.4) ? rng_.octaves(-2, 2) : 0;
      springs_.push_back({k, c});
      return titop::SpringMass{.mass = mass * u_.mass,
                               .stiffness = k * stiffness.factor(u_),
                               .damping = c * damping.factor(u_)};
    };
    const auto own_mass = [&] { return rng_.octaves(-1, 3); };
    // The first mass, on the ground or free.
    mass_.push_back(own_mass());
    z.push_back(d.add("z0", spring(mass_[0])));
    if (rng_.chance(0.5)) {
      titop::ground(z[0]);
      tie(0, -1, springs_[0]);
    } else {
      titop::release(z[0]);  // its spring has a free end and does not change length
      if (springs_[0].c > 0) ++loose_;
    }
    while (static_cast<int>(mass_.size()) < masses) {
      const int at = rng_.below(static_cast<int>(mass_.size()));
      const int fan = 1 + rng_.below(3);
      if (rng_.chance(0.5)) {
        grow(d, z, at, spring, own_mass);
      } else {
        star(d, z, at, fan, spring, own_mass);
      }
    }
    const auto loaded = static_cast<std::size_t>(rng_.below(static_cast<int>(z.size())));
    z[loaded].child.force += force;
    for (std::size_t i = 0; i < z.size(); ++i) d.output(fmt::format("a{}", i)) = z[i].child.accel;
    return finish(std::move(d), static_cast<Index>(loaded));
  }

 private:
  struct Spring {
    double k, c;
  };
  struct Tie {
    int a, b;  ///< masses from 0 on, points from 1000 on, -1 the ground
    Spring spring;
  };
  void tie(int a, int b, Spring s) { ties_.push_back({a, b, s}); }

  template <class Make, class Mass>
  void grow(titop::Diagram& d, std::vector<titop::SpringMass::Handle>& z, int at, Make spring,
            Mass own_mass) {
    const double m = own_mass();
    const int i = static_cast<int>(mass_.size());
    z.push_back(d.add(fmt::format("z{}", i), spring(m)));
    mass_.push_back(m);
    titop::mount(z.back(), z[static_cast<std::size_t>(at)].child);
    tie(i, at, springs_.back());
  }

  /// mass `at` - spring - point without mass - springs - new masses
  template <class Make, class Mass>
  void star(titop::Diagram& d, std::vector<titop::SpringMass::Handle>& z, int at, int fan,
            Make spring, Mass own_mass) {
    const int point = 1000 + points_++;
    const double extra = own_mass();  // the link's own end, on the mass
    auto link = d.add(fmt::format("link{}", points_), spring(extra));
    mass_[static_cast<std::size_t>(at)] += extra;
    titop::weld(link.child, z[static_cast<std::size_t>(at)].child);
    tie(point, at, springs_.back());
    bool damped = springs_.back().c > 0;
    for (int f = 0; f < fan; ++f) {
      const double m = own_mass();
      const int i = static_cast<int>(mass_.size());
      z.push_back(d.add(fmt::format("z{}", i), spring(m)));
      mass_.push_back(m);
      z.back().parent.accel = link.parent.accel;
      link.parent.force += -z.back().parent.force;
      tie(i, point, springs_.back());
      damped = damped || springs_.back().c > 0;
    }
    if (damped) ++damped_;
  }

  Network finish(titop::Diagram d, Index loaded) {
    const auto masses = static_cast<Index>(mass_.size());
    by_hand::Structure a = by_hand::empty(masses + points_, 1, masses);
    const auto place = [&](int i) { return i < 1000 ? Index{i} : masses + i - 1000; };
    for (Index i = 0; i < masses; ++i) a.M(i, i) = mass_[static_cast<std::size_t>(i)];
    for (const Tie& t : ties_) {
      const Index i = place(t.a);
      a.K(i, i) += t.spring.k, a.D(i, i) += t.spring.c;
      if (t.b < 0) continue;
      const Index j = place(t.b);
      a.K(j, j) += t.spring.k, a.D(j, j) += t.spring.c;
      a.K(i, j) -= t.spring.k, a.K(j, i) -= t.spring.k;
      a.D(i, j) -= t.spring.c, a.D(j, i) -= t.spring.c;
    }
    a.B(loaded, 0) = 1;
    a.C.leftCols(masses).setIdentity();
    bool grounded = false;
    for (const Tie& t : ties_) grounded = grounded || t.b < 0;
    // Free: the states contain no common position and rate.
    const int order = 2 * static_cast<int>(masses) + damped_ + (grounded ? 0 : -2 + loose_);
    return {std::move(d), std::move(a), order, {}};
  }

  Rng rng_;
  Units u_;
  std::vector<Spring> springs_;
  std::vector<double> mass_;
  std::vector<Tie> ties_;
  int points_ = 0, damped_ = 0, loose_ = 0;
};

inline Network random_network(std::uint64_t seed, const Units& units = {}) {
  return RandomNetwork(seed, units).make();
}

}  // namespace index_reduction_test
