#pragma once

#include <algorithm>
#include <cmath>
#include <numbers>
#include <titop/analysis/distributed/reduce_beams.hpp>
#include <titop/blocks/exact_beam.hpp>
#include <titop/titop.hpp>

#include "reduction/tree.hpp"
#include "support/order_search.hpp"
#include "support/rng.hpp"

/// Random scenes of distributed beams and rigid bodies, and what is measured on them.
namespace titop_test {

/// Points of the ray up to the band's end: equal steps.
inline std::vector<std::complex<double>> steps_of(const titop::Scene& scene, int steps) {
  const double zeta = scene.damping_floor, high = 2 * std::numbers::pi * scene.band_hz[1];
  std::vector<std::complex<double>> s;
  for (int k = 1; k <= steps; ++k)
    s.push_back(high * k / steps * std::complex<double>(zeta, std::sqrt(1 - zeta * zeta)));
  return s;
}

/// Largest error of a pair over this peak, at these s.
template <class Model>
double error_at(const Model& model, const titop::System& exact,
                const std::vector<std::complex<double>>& s, const Eigen::MatrixXd& peak) {
  double worst = 0;
  for (const std::complex<double> at : s) {
    const Eigen::MatrixXd off = (model.transfer(at) - exact.transfer(at)).cwiseAbs();
    worst = std::max(worst, off.cwiseQuotient(peak).maxCoeff());
  }
  return worst;
}

/// A tree of one to three beams, clamped or on a free hub, and a body at its tip now and then;
/// wrench at the tip, accelerations there or at the hub. Undamped, or all beams with one Kelvin-
/// Voigt coefficient, so that damping does not couple the modes.
struct RandomBeams {
  titop::Diagram diagram{"random beams"};
  titop::Scene scene;
  double damping = 0;  ///< [s]
  std::vector<titop::ExactBeam> beams;
  std::vector<int> on;                  ///< of which beam each is mounted; -1: the first
  std::vector<titop::Rotation> turns;   ///< of each
  std::optional<titop::RigidBody> hub;  ///< none: clamped
  std::optional<titop::RigidBody> tip;  ///< on the last beam
  bool read_hub = false;                ///< else the tip

  explicit RandomBeams(std::uint64_t seed);

  /// The same structure by hand, each beam of `finer` times the elements and modes of this list.
  InModes by_hand(const std::vector<titop::FiniteBeam>& chosen, double finer) const;

 private:
  void draw(Rng& rng);
  void add_to_diagram();
};

inline titop::RigidBody random_body(Rng& rng, double mass) {
  const double side = rng.between(0.05, 0.3);
  return {.mass = mass,
          .inertia = mass * side * side * titop::Vector3d(1, 1.3, 1.7).asDiagonal(),
          .PA = {rng.between(0, 0.1), 0, 0}};
}

inline RandomBeams::RandomBeams(std::uint64_t seed) {
  Rng rng(seed);
  draw(rng);
  add_to_diagram();
}

inline void RandomBeams::draw(Rng& rng) {
  if (rng.chance(0.5)) damping = std::pow(10, -rng.between(4, 6));
  const int count = 1 + rng.below(3);
  double slow = HUGE_VAL;  // [rad/s], of k L = 1
  for (int i = 0; i < count; ++i) {
    const double length = rng.between(0.6, 2), width = rng.between(0.02, 0.06),
                 height = rng.between(0.02, 0.06);
    const titop::Material material{.E = 70e9, .nu = 0.33, .rho = rng.between(1500, 6000)};
    beams.push_back({.length = length,
                     .section = titop::rectangle(width, height),
                     .material = material,
                     .damping = {.stiffness = damping}});
    slow = std::min(slow, std::sqrt(material.E / (12 * material.rho)) * std::min(width, height) /
                              (length * length));
    on.push_back(i > 0 ? rng.below(i) : -1);
    const double angle = rng.between(-3, 3), x = rng.between(-1, 1), y = rng.between(-1, 1);
    turns.push_back(titop::Rotation::about({x, y, 0.5}, angle));
  }
  const double mass = beams[0].material.rho * beams[0].section.area * beams[0].length;
  if (rng.chance(0.6)) {
    hub = random_body(rng, mass * std::pow(10, rng.between(-0.5, 2)));
    hub->children = {{"C", {0.2, 0.1, 0}}};
    read_hub = rng.chance(0.4);
  }
  if (rng.chance(0.6)) tip = random_body(rng, mass * std::pow(10, rng.between(-2, 1)));
  scene.band_hz = {0, slow * std::pow(rng.between(2, 6.5), 2) / (2 * std::numbers::pi)};
  scene.accuracy = std::pow(10, -rng.between(1, 3));
}

inline void RandomBeams::add_to_diagram() {
  const auto U = diagram.input("U", 6);
  std::vector<titop::BodyHandle> bodies;
  std::optional<titop::RigidBody::Handle> root;
  if (hub) {
    root = diagram.add("hub", *hub);
    root->parent.force = 0;
  }
  for (std::size_t i = 0; i < beams.size(); ++i) {
    bodies.push_back(diagram.add("b" + std::to_string(i + 1), beams[i]));
    if (i > 0)
      titop::mount(bodies[i], bodies[static_cast<std::size_t>(on[i])].child("C"), turns[i]);
    else if (root)
      titop::mount(bodies[i], root->child("C"), turns[i]);
    else
      bodies[i].parent.accel = 0;
  }
  if (tip) titop::mount(diagram.add("tip", *tip), bodies.back().child("C"), titop::Rotation{});
  bodies.back().child("C").force += U;
  if (read_hub)
    diagram.output("a", 6) = root->parent.accel;
  else
    diagram.output("a", 6) = bodies.back().child("C").accel;
}

inline InModes RandomBeams::by_hand(const std::vector<titop::FiniteBeam>& chosen,
                                    double finer) const {
  Tree tree(hub.has_value());
  if (hub) tree.add(*hub);
  const int first = hub ? 1 : 0;
  for (std::size_t i = 0; i < beams.size(); ++i) {
    const auto more = [&](int n) { return static_cast<int>(std::ceil(finer * n)); };
    const int elements = more(chosen[i].elements), kept = more(chosen[i].modes + 12);
    titop::fe::ModeOptions modes;
    if (kept + 12 < 6 * elements) modes = {.kept = kept, .residual = {"C", "P"}};
    const titop::Matrix3d T = i > 0 || hub ? turns[i].nominal() : titop::Matrix3d::Identity();
    tree.add(titop::modal_data(titop::with_elements(beams[i], elements, modes)),
             i > 0 ? first + on[i] : first - 1, 0, T);
  }
  const int last = first + static_cast<int>(beams.size()) - 1;
  if (tip) tree.add(*tip, last);
  const MatrixXl end = tree.motion(last, 0);
  return in_modes<double>(tree.structure(end, read_hub ? tree.motion(0) : end), hub.has_value());
}

/// The chosen model, and the least that a search finds in finer beams. The search's errors are
/// samples; it has to leave the reserve that `compare` adds between samples, a factor of
/// 1 / cos(1 / 2).
struct OrderBesideLeast {
  titop::ReducedBeams reduced;
  double error = 0;  ///< of `reduced` at the search's points
  int least = 0;     ///< states; negative: not found
};

inline OrderBesideLeast order_beside_least(const RandomBeams& r) {
  OrderBesideLeast result{reduce_beams(r.diagram, r.scene)};
  const titop::System exact = compile(r.diagram);
  Searched searched{r.by_hand(result.reduced.beams, 1.3), r.damping,
                    2 * std::numbers::pi * r.scene.band_hz[1], result.reduced.error.peak};
  searched.s = steps_of(r.scene, 60);
  const double zeta = r.scene.damping_floor;
  for (const double mu : searched.modes.mu)
    if (mu * searched.end * searched.end >= 0.98)
      for (int k = -2; k <= 2; ++k)
        searched.s.push_back((1 + k * zeta) / std::sqrt(mu) *
                             std::complex<double>(zeta, std::sqrt(1 - zeta * zeta)));
  std::erase_if(searched.s, [&](auto s) { return std::abs(s) > searched.end; });
  for (const std::complex<double> s : searched.s) searched.H.push_back(exact.transfer(s));
  result.error = error_at(result.reduced.system, exact, searched.s, searched.peak);
  result.least = 2 * least_coordinates(searched, r.scene.accuracy * std::cos(0.5));
  return result;
}

inline bool within(int order, int least) { return least >= 0 && order <= 1.3 * least; }

}  // namespace titop_test
