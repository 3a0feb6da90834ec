#include "generate/diagrams/timed.hpp"

#include <fmt/format.h>

#include <array>
#include <cmath>
#include <numbers>
#include <optional>
#include <stdexcept>
#include <titop/blocks/fe/beam.hpp>
#include <titop/blocks/flexible_body.hpp>
#include <titop/blocks/hinge.hpp>
#include <titop/blocks/rigid_body.hpp>
#include <titop/blocks/spring_mass.hpp>
#include <titop/graph/linalg/index.hpp>
#include <titop/graph/mount.hpp>
#include <titop/graph/nodes/lti.hpp>
#include <vector>

#include "generate/shape.hpp"

namespace titop::generate {

namespace {

constexpr std::array kNames{"A", "BL", "C", "D", "F", "K", "T", "CB", "R", "G", "SG", "SL"};

using titop::linalg::at;

/// Of each diagram.
constexpr std::uint64_t kSeed = 20150401;

/// The diagram's parameter, and which bodies have it.
class Variation {
 public:
  Variation(Diagram& d, const CaseOptions& options, int n) : varies_(options.varies), one_(n / 2) {
    if (varies_ != Varies::nothing) p_ = d.param("p", options.p);
  }
  Value operator()(double number, int body) const {
    return p_ && (varies_ == Varies::all || body == one_) ? number * *p_ : Value(number);
  }

 private:
  Varies varies_;
  int one_;
  std::optional<Param> p_;
};

/// BL is the same structure as A: half of every mass but the last is the parent mass of the next.
Diagram scalar(Case c, int n, const CaseOptions& options) {
  Diagram d{"case " + name_of(c)};
  Mersenne draws(kSeed);
  const Variation varied(d, options, n);
  const Shape shape = c == Case::C ? Shape::tree : Shape::chain;
  auto u = d.input("u");
  std::vector<SpringMass::Handle> z;
  z.reserve(at(n));
  double half = 0;
  for (int i = 0; i < n; ++i) {
    const double m = draws.between(0.5, 2) * (i % 2 ? options.ratio : 1 / options.ratio);
    const double own = c == Case::BL && i + 1 < n ? m / 2 : m;
    const double stiffness = draws.between(50, 200);
    z.push_back(d.add(fmt::format("z{}", i + 1), SpringMass{.mass = varied(own, i),
                                                            .stiffness = stiffness,
                                                            .damping = 0.1,
                                                            .parent_mass = varied(half, i)}));
    half = m - own;
    if (i == 0)
      ground(z[0]);
    else
      mount(z.back(), z[at(parent_of(shape, i, draws))].child);
  }
  z.back().child.force = u;
  d.output("a") = z.back().child.accel;
  return d;
}

/// 2 m of aluminium, its lowest six modes clamped at P. E and rho together: the frequencies stay.
FlexibleBody beam(double scale) {
  return Beam{.length = 2.0,
              .section = rectangle(0.06, 0.04),
              .material = {.E = 70e9 * scale, .nu = 0.33, .rho = 2700 * scale},
              .elements = 4,
              .modes = {.kept = 6, .xi = {0.005}}};
}

/// 40 N m/rad and a lag of 0.2 s.
Lti controller() {
  const auto scalar = [](double x) { return Eigen::MatrixXd::Constant(1, 1, x); };
  return {.A = scalar(-5), .B = scalar(1), .C = scalar(3), .D = scalar(40)};
}

void controlled_hinge(Diagram& d, int i, const FlexibleBody::Handle& body, const DualPort<6>& site,
                      const Rotation& T) {
  auto h = hinge(d, fmt::format("J{}", i + 1), body, site, T, {0, 0, 1});
  auto K = d.add(fmt::format("K{}", i + 1), controller());
  K.in = h.angle;
  h.torque = K.out + 8.0 * h.rate;
}

Diagram flexible(Case c, int n, const CaseOptions& options) {
  Diagram d{"case " + name_of(c)};
  Mersenne draws(kSeed);
  const Variation varied(d, options, n);
  const Shape shape = c == Case::T ? Shape::binary : c == Case::CB ? Shape::comb : Shape::chain;
  const FlexibleBody light = beam(1 / options.ratio);
  const FlexibleBody heavy = options.ratio == 1 ? light : beam(options.ratio);
  auto U = d.input("U", 6);
  std::vector<FlexibleBody::Handle> b;
  b.reserve(at(n));
  b.push_back(d.add("B1", light));
  b[0].parent.force = -U;
  for (int i = 1; i < n; ++i) {
    b.push_back(d.add(fmt::format("B{}", i + 1), i % 2 ? heavy : light));
    const auto& site = b[at(parent_of(shape, i, draws))].child;
    const Eigen::Vector3d axis = draws.matrix(3, 1);
    const Rotation T = Rotation::about(axis, varied(draws.between(0.1, 3), i));
    if (c == Case::K)
      controlled_hinge(d, i, b.back(), site, T);
    else
      mount(b.back(), site, T);
  }
  d.output("a", 6) = b.back().child.accel;
  return d;
}

Diagram fan(int n, const CaseOptions& options) {
  Diagram d{"case F"};
  Mersenne draws(kSeed);
  const Variation varied(d, options, n);
  RigidBody hub{.mass = 1000, .inertia = Eigen::Vector3d(400, 500, 600).asDiagonal()};
  for (int i = 0; i < n; ++i)
    hub.children.push_back({fmt::format("C{}", i + 1), draws.matrix(3, 1)});
  const FlexibleBody wing = beam(1);
  auto U = d.input("U", 6);
  auto B = d.add("B", hub);
  B.parent.force = -U;
  for (int i = 0; i < n; ++i) {
    auto A = d.add(fmt::format("A{}", i + 1), wing);
    const Eigen::Vector3d axis = draws.matrix(3, 1);
    const Rotation T = Rotation::about(axis, varied(draws.between(0.1, 3), i));
    mount(A, B.child(fmt::format("C{}", i + 1)), T);
    if (i + 1 == n) d.output("a", 6) = A.child.accel;
  }
  return d;
}

Diagram ring(int n) {
  Diagram d{"case R"};
  const FlexibleBody body = beam(1);
  std::vector<FlexibleBody::Handle> b;
  b.reserve(at(n));
  for (int i = 0; i < n; ++i) b.push_back(d.add(fmt::format("B{}", i + 1), body));
  const Rotation T = Rotation::about({0, 0, 1}, 2 * std::numbers::pi / n);
  for (int i = 0; i < n; ++i) mount(b[at((i + 1) % n)], b[at(i)].child, T);
  b[0].child.force += d.input("U", 6);
  d.output("a", 6) = b[at(n / 2)].parent.accel;
  return d;
}

/// Node i, j is mounted on the end of the beam from its left neighbour; in the first column, of the
/// beam from below; if it has both, the beam from below is welded to it.
Diagram grid(int n) {
  Diagram d{"case G"};
  const int m = static_cast<int>(std::lround(std::sqrt(n)));
  const FlexibleBody body = beam(1);
  const RigidBody node{
      .mass = 5, .inertia = 0.1 * Eigen::Matrix3d::Identity(), .children = {{"E"}, {"N"}, {"S"}}};
  const Rotation up = Rotation::about({0, 0, 1}, std::numbers::pi / 2);
  std::vector<BodyHandle> nodes;
  nodes.reserve(at(m * m));
  for (int j = 0; j < m; ++j)
    for (int i = 0; i < m; ++i) {
      const auto name = [&](const char* subject) {
        return fmt::format("{}{}_{}", subject, i + 1, j + 1);
      };
      nodes.push_back(d.add(name("N"), node));
      if (i > 0) {
        auto beam = d.add(name("H"), body);
        mount(beam, nodes[at(m * j + i - 1)].child("E"));
        mount(nodes.back(), beam.child);
      }
      if (j > 0) {
        auto beam = d.add(name("V"), body);
        mount(beam, nodes[at(m * (j - 1) + i)].child("N"), up);
        if (i == 0)
          mount(nodes.back(), beam.child, up.inverse());
        else
          weld(beam.child, nodes.back().child("S"), up);
      }
    }
  nodes.front().parent.force = -d.input("U", 6);
  d.output("a", 6) = nodes.back().parent.accel;
  return d;
}

/// A spring and a damper between two masses, as equations of their positions and rates.
void couple(const SpringMass::Handle& a, const SpringMass::Handle& b) {
  const auto force =
      30.0 * (b.child.position - a.child.position) + 0.1 * (b.child.rate - a.child.rate);
  a.child.force += force;
  b.child.force += -force;
}

SpringMass coupled_mass(Value mass) {
  return {.mass = std::move(mass), .stiffness = 100, .damping = 0.1};
}

Diagram spring_grid(int n, const CaseOptions& options) {
  Diagram d{"case SG"};
  const int m = static_cast<int>(std::lround(std::sqrt(n)));
  const Variation varied(d, options, m * m);
  auto u = d.input("u");
  std::vector<SpringMass::Handle> z;
  z.reserve(at(m * m));
  for (int j = 0; j < m; ++j)
    for (int i = 0; i < m; ++i) {
      z.push_back(d.add(fmt::format("z{}_{}", i + 1, j + 1), coupled_mass(varied(1, m * j + i))));
      ground(z.back());
      if (i > 0) couple(z[at(m * j + i - 1)], z.back());
      if (j > 0) couple(z[at(m * (j - 1) + i)], z.back());
    }
  z.front().child.force += u;
  d.output("a") = z.back().child.accel;
  return d;
}

Diagram coupled_rows(int n, const CaseOptions& options) {
  Diagram d{"case SL"};
  const Variation varied(d, options, n);
  auto u = d.input("u");
  std::vector<SpringMass::Handle> z;
  z.reserve(at(n));
  for (int i = 0; i < n / 2; ++i)
    for (const int row : {0, 1}) {
      const char* const name = row ? "b" : "a";
      z.push_back(d.add(fmt::format("{}{}", name, i + 1), coupled_mass(varied(1, 2 * i + row))));
      if (i == 0)
        ground(z.back());
      else
        mount(z.back(), z[z.size() - 3].child);
      if (row) couple(z[z.size() - 2], z.back());
    }
  z.back().child.force += u;
  d.output("a") = z.back().child.accel;
  return d;
}

}  // namespace

std::string name_of(Case c) { return kNames[static_cast<std::size_t>(c)]; }

Case case_of(const std::string& name) {
  for (std::size_t i = 0; i < kNames.size(); ++i)
    if (kNames[i] == name) return static_cast<Case>(i);
  throw std::invalid_argument("no case " + name);
}

Diagram case_diagram(Case c, int n, const CaseOptions& options) {
  switch (c) {
    case Case::A:
    case Case::BL:
    case Case::C: return scalar(c, n, options);
    case Case::D:
    case Case::K:
    case Case::T:
    case Case::CB: return flexible(c, n, options);
    case Case::F: return fan(n, options);
    case Case::R: return ring(n);
    case Case::G: return grid(n);
    case Case::SG: return spring_grid(n, options);
    case Case::SL: return coupled_rows(n, options);
  }
  throw std::invalid_argument("no such case");
}

}  // namespace titop::generate
