#include <doctest/doctest.h>

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <utility>

#include "assembly.hpp"
#include "support/five_masses.hpp"

/// Five masses with every spring-mass hung either way round: the channels that this inverts, and
/// the loops that it closes, change nothing.

using namespace loops_test;
using namespace titop;
using titop_test::impedance;
using titop_test::kMasses;
using titop_test::kStiffnesses;

namespace {

constexpr std::size_t kWall = 5;
constexpr std::array<std::size_t, 5> kHangsOn{kWall, 0, 0, 1, 1};

/// An end of a spring-mass; at its child the wrench acts on it, at its parent it acts from it.
struct End {
  std::size_t spring;
  bool child;
};

enum class Read { position, integrated, stretches };

class Oriented {
 public:
  /// Bit i of `turned`: spring i is mounted the other way round. Every point's mass is distributed
  /// over its ends, or over the child ends alone if there are any.
  Oriented(int turned, bool with_children) : turned_(turned) {
    for (std::size_t i = 0; i < 5; ++i) {
      ends_[is_turned(i) ? kHangsOn[i] : i].push_back({i, true});
      ends_[is_turned(i) ? i : kHangsOn[i]].push_back({i, false});
    }
    std::array<double, 5> child{}, parent{};
    for (std::size_t p = 0; p <= kWall; ++p)
      for (const End& e : ends_[p])
        (e.child ? child : parent)[e.spring] = share(p, e, with_children);
    for (std::size_t i = 0; i < 5; ++i)
      z_.push_back(d_.add(
          "z" + std::to_string(i + 1),
          SpringMass{.mass = child[i], .stiffness = kStiffnesses[i], .parent_mass = parent[i]}));
  }

  /// The actuator u between masses 1 and 2.
  Diagram scene(Read read) {
    const auto u = d_.input("u");
    for (std::size_t p = 0; p < kWall; ++p) join(p, (p == 0 ? -1.0 : p == 1 ? 1.0 : 0.0) * u);
    for (const End& e : ends_[kWall]) with(e, [](auto& point) { point.accel = 0; });
    d_.output("x3") = third(read);
    return std::move(d_);
  }

 private:
  bool is_turned(std::size_t spring) const { return turned_ >> spring & 1; }

  double share(std::size_t point, const End& e, bool with_children) const {
    if (point == kWall) return 1;  // moves nothing: the wall is held
    const auto children = std::count_if(ends_[point].begin(), ends_[point].end(),
                                        [](const End& other) { return other.child; });
    if (!with_children || children == 0)
      return kMasses[point] / static_cast<double>(ends_[point].size());
    return e.child ? kMasses[point] / static_cast<double>(children) : 0;
  }

  template <class Use>
  void with(const End& e, Use use) {
    e.child ? use(z_[e.spring].child) : use(z_[e.spring].parent);
  }

  Expr accel(const End& e) {
    Expr result;
    with(e, [&](auto& point) { result = 1.0 * point.accel; });
    return result;
  }

  /// All ends move with the first one, which takes the remaining force.
  void join(std::size_t point, Expr left) {
    const End first = ends_[point].front();
    for (const End& e : ends_[point]) {
      if (e.spring == first.spring) continue;
      with(e, [&](auto& other) { other.accel = accel(first); });
      with(e, [&](auto& other) {
        left = e.child ? left - 1.0 * other.force : left + 1.0 * other.force;
      });
    }
    with(first, [&](auto& own) { own.force = first.child ? left : -1.0 * left; });
  }

  Expr third(Read read) {
    if (read == Read::stretches)
      return (is_turned(0) ? -1.0 : 1.0) * z_[0].stretch +
             (is_turned(2) ? -1.0 : 1.0) * z_[2].stretch;
    Expr position;
    if (read == Read::position) {
      with(ends_[2].front(), [&](auto& point) { position = 1.0 * point.position; });
      return position;
    }
    auto v = d_.add("v", Integrator{}), x = d_.add("x", Integrator{});
    v.in = accel(ends_[2].front());
    x.in = v.out;
    return 1.0 * x.out;
  }

  int turned_;
  Diagram d_{"oriented"};
  std::array<std::vector<End>, 6> ends_;
  std::vector<SpringMass::Handle> z_;
};

std::vector<Complex> poles_by_hand() {
  const MatrixXd K = impedance(kMasses, kStiffnesses, 0).real();
  MatrixXd M = MatrixXd::Zero(5, 5);
  for (Index i = 0; i < 5; ++i) M(i, i) = kMasses[static_cast<std::size_t>(i)];
  const Eigen::GeneralizedSelfAdjointEigenSolver<MatrixXd> modes(K, M, Eigen::EigenvaluesOnly);
  std::vector<Complex> poles;
  for (const double l : modes.eigenvalues()) poles.emplace_back(0, std::sqrt(l));
  return poles;
}

}  // namespace

TEST_CASE("five masses in every orientation: order 10, poles and transfer to 1e-13") {
  const std::vector<Complex> exact = poles_by_hand();
  for (int turned = 0; turned < 32; ++turned)
    for (const bool with_children : {false, true})
      for (const Read read : {Read::position, Read::integrated, Read::stretches}) {
        CAPTURE(turned);
        CAPTURE(with_children);
        CAPTURE(static_cast<int>(read));
        const System system =
            compile(Oriented(turned, with_children).scene(read), {.minimize_up_to = 0});
        const StateSpace& dense = system.state_space();
        CHECK(dense.order() == 10);
        CHECK(by_hand::pole_error(all_poles(system), exact) <= 1e-13);
        double worst = 0;
        for (const Complex s : {Complex(0.1, 1), Complex(0.9, 9), Complex(3, 30)}) {
          const Complex x3 = titop_test::positions(kMasses, kStiffnesses, s)(2);
          worst = std::max({worst, std::abs(system.transfer(s)(0, 0) / x3 - 1.0),
                            std::abs(dense.transfer(s)(0, 0) / x3 - 1.0)});
        }
        CHECK(worst <= 1e-13);
      }
}
