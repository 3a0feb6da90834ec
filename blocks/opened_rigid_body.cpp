#include <array>
#include <titop/blocks/opened_rigid_body.hpp>
#include <titop/graph/linalg/index.hpp>
#include <titop/graph/opened.hpp>

namespace titop {
namespace {

using Eigen::Index;
using Eigen::RowVectorXd;
using Eigen::VectorXd;
using linalg::at;

/// A part of a position's motion by d along one axis: the linear acceleration `linear` has d times
/// sign times the angular acceleration `angular` more, and the moment `angular` d times sign times
/// the force `linear`.
struct Lever {
  Value value;
  Index linear, angular;
  double sign;
};

std::vector<Lever> levers(const Position& position) {
  std::vector<Lever> result;
  const std::vector<Value> components = position.values();
  for (Index a = 0; a < static_cast<Index>(components.size()); ++a) {  // omega x e_a
    const Index b = (a + 1) % 3, c = (a + 2) % 3;
    result.push_back({components[at(a)], b, c, 1});
    result.push_back({components[at(a)], c, b, -1});
  }
  return result;
}

/// The pairs, in an order in which each follows those that act on its z.
class RigidBodyPairs {
 public:
  RigidBodyPairs(const RigidBody& spec, ParameterValues values)
      : spec_(spec),
        tau_AP_(tau(-spec.PA.at(values))),
        mass_(spec.mass.at(values)),
        parent_(static_cast<Index>(6 * spec.children.size())) {
    const std::vector<Lever> centre = levers(spec.PA);
    for (const Lever& l : centre) accelerations_of_centre(l);
    for (int i = 0; i < 3; ++i) mass_along(i, centre);
    inertia();
    for (const Lever& l : centre) moment_of_centre(l, centre);
    for (std::size_t i = 0; i < spec.children.size(); ++i)
      for (const Lever& l : levers(spec.children[i].PC)) child(static_cast<Index>(i), l);
  }

  std::vector<OpenedPair> list;

 private:
  RowVectorXd of(Index input) const { return RowVectorXd::Unit(parent_ + 6, input); }
  VectorXd on(Index output) const { return VectorXd::Unit(parent_ + 6, output); }
  /// z = row of tau_AP xdd_P.
  RowVectorXd felt(Index row) const {
    RowVectorXd z = RowVectorXd::Zero(parent_ + 6);
    z.tail<6>() = tau_AP_.row(row);
    return z;
  }
  /// -F_P = tau_AP' of this component of the wrench at A.
  VectorXd acts(Index row) const { return -felt(row).transpose(); }

  void accelerations_of_centre(const Lever& l) {
    list.push_back({l.value, {}, mass_ * acts(l.linear), {}, l.sign * of(parent_ + 3 + l.angular)});
  }
  /// z = acceleration of A along i.
  void mass_along(Index i, const std::vector<Lever>& centre) {
    first_mass_ = i == 0 ? list.size() : first_mass_;
    list.push_back({spec_.mass, {}, acts(i), {}, felt(i)});
    add_centre(i, centre, 1);
  }
  /// z = force on A.
  void moment_of_centre(const Lever& l, const std::vector<Lever>& centre) {
    list.push_back(
        {l.value, {}, -l.sign * on(parent_ + 3 + l.angular), {}, mass_ * felt(l.linear)});
    add_centre(l.linear, centre, mass_);
    list.back().of_pairs.emplace_back(first_mass_ + at(l.linear), 1);
  }
  /// The accelerations that a moved centre adds along i, in the last pair.
  void add_centre(Index i, const std::vector<Lever>& centre, double factor) {
    for (std::size_t k = 0; k < centre.size(); ++k)
      if (centre[k].linear == i) list.back().of_pairs.emplace_back(k, factor);
  }
  void inertia() {
    const std::vector<Value> I = spec_.inertia.values();
    constexpr std::array<std::pair<int, int>, 6> kEntries = {
        {{3, 3}, {4, 4}, {5, 5}, {3, 4}, {3, 5}, {4, 5}}};
    for (std::size_t e = 0; e < I.size(); ++e) {
      const auto [i, j] = kEntries[e];
      list.push_back({I[e], {}, acts(j), {}, felt(i)});
      if (i != j) list.push_back({I[e], {}, acts(i), {}, felt(j)});
    }
  }
  void child(Index i, const Lever& l) {
    list.push_back({l.value, {}, on(6 * i + l.linear), {}, l.sign * of(parent_ + 3 + l.angular)});
    list.back().moves = static_cast<int>(i);
    list.back().moved_by = Vector6::Unit(l.linear);
    list.back().of_motion = l.sign * Vector6::Unit(3 + l.angular).transpose();
    list.push_back({l.value, {}, l.sign * on(parent_ + 3 + l.angular), {}, of(6 * i + l.linear)});
  }

  const RigidBody& spec_;
  Matrix6 tau_AP_;
  double mass_;
  Index parent_;
  std::size_t first_mass_ = 0;
};

}  // namespace

Opened opened_rigid_body(const RigidBody& spec, const Dynamics& dynamics, ParameterValues values,
                         std::span<const int> parameters) {
  return with_pairs(dynamics, RigidBodyPairs(spec, values).list, parameters);
}

}  // namespace titop
