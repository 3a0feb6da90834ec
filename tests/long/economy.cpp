#include <doctest/doctest.h>

#include <Eigen/Eigenvalues>
#include <cmath>

#include "economy/scenes.hpp"
#include "support/rng.hpp"

/// Random scenes through the whole of economy; see tests/economy.
using namespace titop;
using namespace titop_test;

namespace {

struct Random {
  Diagram diagram{"random"};
  titop::Scene scene;
  bool undamped = true, collocated = true;
};

FlexibleBody random_beam(Rng& rng, bool undamped) {
  const double width = rng.between(0.03, 0.08), height = rng.between(0.02, 0.06);
  Beam beam{.length = rng.between(0.5, 3),
            .section = rectangle(width, height),
            .material = {.E = 70e9, .nu = 0.33, .rho = rng.between(1500, 8000)},
            .elements = 3 + rng.below(3)};
  if (!undamped) beam.modes.xi = {rng.between(0.001, 0.01)};
  return beam;
}

/// One to four beams in a tree, clamped or free, a tip body now and then; wrench and acceleration
/// at one tip, not always the same.
Random random_structure(std::uint64_t seed) {
  Rng rng(seed);
  Random r;
  r.undamped = rng.chance(0.7);
  const int count = 1 + rng.below(4);
  const bool clamped = rng.chance(0.6);
  auto U = r.diagram.input("U", 6);
  std::vector<BodyHandle> bodies;
  for (int i = 0; i < count; ++i) {
    const std::string name = "b" + std::to_string(i);
    bodies.push_back(r.diagram.add(name, random_beam(rng, r.undamped)));
    const Rotation turn = Rotation::about(
        {rng.between(-1, 1), rng.between(-1, 1), rng.between(0.1, 1)}, rng.between(-3, 3));
    if (i == 0 && clamped) bodies[0].parent.accel = 0;
    if (i == 0 && !clamped) bodies[0].parent.force = 0;
    if (i > 0) {
      BodyHandle& parent = bodies[static_cast<std::size_t>(rng.below(i))];
      mount(bodies.back(), parent.child("C"), turn);
    }
  }
  if (rng.chance(0.4)) {
    const double m = std::pow(10, rng.between(-1, 3));
    auto tip =
        r.diagram.add("tip", RigidBody{.mass = m, .inertia = Matrix3d::Identity() * m * 0.01});
    mount(tip, bodies.back().child("C"), Rotation{});
  }
  bodies.back().child("C").force += U;
  auto& read = rng.chance(0.6) ? bodies.back() : bodies.front();
  r.collocated = &read == &bodies.back();
  r.diagram.output("a", 6) = read.child("C").accel;
  r.scene.band_hz = {0, std::pow(10, rng.between(0.5, 2.5))};
  r.scene.accuracy = std::pow(10, -rng.between(1, 6));
  return r;
}

/// Force to rate at one point dissipates: the Hermitian part of a(s) / s is positive semidefinite
/// right of the axis, in the band, below and far beyond it.
bool is_passive(const ReducedSystem& r, double high) {
  for (const double w : {0.01 * high, 0.3 * high, high, 10 * high, 1e3 * high})
    for (const double zeta : {1e-3, 0.3}) {
      const std::complex<double> s{zeta * w, w};
      const Eigen::MatrixXcd Y = r.transfer(s) / s, twice = Y + Y.adjoint();
      const double least =
          Eigen::SelfAdjointEigenSolver<Eigen::MatrixXcd>(twice, Eigen::EigenvaluesOnly)
              .eigenvalues()(0);
      if (!(least >= -1e-9 * Y.norm())) return false;
    }
  return true;
}

/// The largest error of any pair over what its bound allows, on a grid of the band that knows
/// nothing of the bound's: equal steps, and 41 points across every pole of the full system.
struct Against {
  double bound = 0;  ///< largest |error| / (bound of the pair * its peak): 1 or less
  double error = 0;  ///< largest |error| / peak
};
Against on_fine_grid(const ReducedSystem& r, const titop::Scene& scene, int steps = 1500) {
  const double low = 2 * std::numbers::pi * scene.band_hz[0];
  const double high = 2 * std::numbers::pi * scene.band_hz[1], zeta = scene.damping_floor;
  std::vector<double> omega;
  for (int i = 1; i <= steps; ++i) omega.push_back(low + (high - low) * i / steps);
  for (int i = 1; i <= 30; ++i)  // from the lower end on by factors, from 0 on over nine decades
    omega.push_back(low > 0 ? low * std::pow(high / low, i / 31.0) : high * std::pow(10, -0.3 * i));
  for (const titop::Pole& p : r.full().poles())
    for (int i = -20; i <= 20; ++i)
      if (const double w = p.omega * (1 + 0.2 * zeta * i); w > low && w < high) omega.push_back(w);
  Against worst;
  for (const double w : omega) {
    const std::complex<double> s{zeta * w, std::sqrt(1 - zeta * zeta) * w};
    const Eigen::MatrixXd error = (r.full().transfer(s) - r.transfer(s)).cwiseAbs();
    const titop::ErrorBound& b = r.bound();
    const Eigen::MatrixXd relative = error.cwiseQuotient(b.peak);
    worst.error = std::max(worst.error, relative.maxCoeff());
    worst.bound = std::max(worst.bound, relative.cwiseQuotient(b.pairs).maxCoeff());
  }
  return worst;
}

}  // namespace

TEST_CASE("500 random scenes: error below the bound, undamped poles on the axis, passive") {
  int met = 0;
  for (std::uint64_t seed = 1; seed <= 500; ++seed) {
    CAPTURE(seed);
    const Random r = random_structure(seed);
    try {
      const ReducedSystem reduced = compile(r.diagram, r.scene);
      ++met;
      CHECK(reduced.bound().worst <= r.scene.accuracy);
      CHECK(on_fine_grid(reduced, r.scene, 600).bound <= 1);
      CHECK(reduced.order() <= reduced.full().order());
      for (const Pole& p : poles(reduced.state_space()))
        CHECK((r.undamped ? p.s.real() == 0 : p.s.real() < 0));
      if (r.collocated) CHECK(is_passive(reduced, 2 * std::numbers::pi * r.scene.band_hz[1]));
    } catch (const Error& error) {
      // Refused where rounding in the modes of the whole ends first: said, and rare.
      CHECK(error.has(Code::bad_value));
    }
  }
  CHECK(met >= 490);
}
