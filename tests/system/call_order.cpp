// Results of System's functions do not depend on the functions that were called before.
#include <doctest/doctest.h>
#include <fmt/format.h>

#include <algorithm>
#include <functional>
#include <numeric>
#include <string>
#include <titop/titop.hpp>
#include <vector>

#include "support/five_masses.hpp"
#include "support/refused.hpp"

using namespace titop;
using titop_test::message_of;

namespace {

/// All bits of the entries.
template <class Derived>
std::string bits(const Eigen::DenseBase<Derived>& m) {
  std::string text = fmt::format("{}x{}", m.rows(), m.cols());
  for (Eigen::Index j = 0; j < m.cols(); ++j)
    for (Eigen::Index i = 0; i < m.rows(); ++i)
      if constexpr (Eigen::NumTraits<typename Derived::Scalar>::IsComplex)
        text += fmt::format(" {:a}{:+a}j", m(i, j).real(), m(i, j).imag());
      else
        text += fmt::format(" {:a}", m(i, j));
  return text;
}

std::string bits(const StateSpace& m) {
  return fmt::format("{}; {}; {}; {}; {}; {}; {}; {}", fmt::join(m.states, ","),
                     fmt::join(m.inputs, ","), fmt::join(m.outputs, ","), fmt::join(m.rates, ","),
                     bits(m.A), bits(m.B), bits(m.C), bits(m.D));
}

std::string bits(const Certificate& c) {
  return to_string(c) + fmt::format("{:a} {:a} {:a} {:a} {:a} {:a} {:a} {:a} {:a} {} {} {} {}",
                                    c.residual, c.apply_against_transfer, c.dense_against_factors,
                                    c.dense_error, c.dense_error_where_small, c.weakest_pivot,
                                    c.pivot_growth, c.margin, c.s, c.fronts, c.fronts_made,
                                    c.plans_renewed, c.margin_is_exact);
}

std::string bits(const std::vector<Note>& notes) {
  std::string text;
  for (const Note& n : notes)
    text += fmt::format("{}, {}: {}\n", n.pass, to_string(n.kind), n.text);
  return text;
}

std::string names(const std::vector<std::pair<std::string, double>>& seconds) {
  std::string text;
  for (const auto& [name, s] : seconds) text += name + " ";
  return text;
}

constexpr std::complex<double> kPoint{0.2, 1.3};

using Call = std::function<std::string(const System&)>;

std::string of_written(const System& s) {
  StateSpace model;
  s.write(model, 1);
  return bits(model) + bits(s.certificate(model));
}

std::string of_apply(const System& s) {
  const auto rates = s.apply(Eigen::VectorXd::LinSpaced(s.order(), -1, 2),
                             Eigen::VectorXd::LinSpaced(std::ssize(s.inputs()), 1, 3));
  return bits(rates.xdot) + bits(rates.y);
}

/// Every value of a parameter times 1.25.
std::string of_update(const System& s) {
  ParameterList list = s.parameters();
  for (auto& [name, value] : list) value *= 1.25;
  const System now = s.update(list);
  return bits(now.state_space()) + now.log() + bits(now.certificate());
}

const std::vector<Call>& calls() {
  static const std::vector<Call> all{
      [](const System& s) { return bits(s.certificate()); },
      [](const System& s) { return s.log(); },
      [](const System& s) { return bits(s.notes()); },
      [](const System& s) { return to_string(s.order_verdict()); },
      [](const System& s) { return bits(s.state_space()); },
      [](const System& s) { return bits(s.dense_certificate()); },
      [](const System& s) { return bits(s.dense_notes()); },
      [](const System& s) { return s.dense_log(); },
      [](const System& s) { return names(s.seconds()); },
      [](const System& s) { return names(s.dense_seconds()); },
      [](const System& s) { return to_string(s.poles()); },
      [](const System& s) { return bits(s.static_gain()); },
      [](const System& s) { return bits(s.transfer(kPoint)); },
      [](const System& s) { return bits(s.transfer(kPoint, Precision::twofold)); },
      [](const System& s) {
        return bits(s.frequency_response(std::vector{0.3, 4.0}, 1)[1]);
      },
      [](const System& s) { return bits(Eigen::MatrixXd(s.descriptor().A)); },
      of_written,
      of_apply,
      of_update,
      [](const System& s) { return to_dot(s.stage()); },
      [](const System& s) { return to_string(certify(s, {.points = 5})); },
      [](const System& s) { return to_string(certify(s, {.points = 5, .dense_up_to = 0})); },
  };
  return all;
}

/// An error is a result, too.
std::string result(const Call& call, const System& s) {
  std::string text;
  const std::string error = message_of([&] { text = call(s); });
  return text.empty() ? error : text;
}

/// Each of them on a system of its own, and on one for all of them in these orders.
void check_orders(const std::function<System()>& make) {
  std::vector<std::string> alone;
  for (const Call& call : calls()) alone.push_back(result(call, make()));
  std::vector<std::size_t> order(calls().size());
  std::iota(order.begin(), order.end(), 0);
  const auto check = [&] {
    const System together = make();
    for (const std::size_t i : order) {
      CAPTURE(i);
      CHECK(result(calls()[i], together) == alone[i]);
    }
  };
  check();
  std::reverse(order.begin(), order.end());
  check();
  std::rotate(order.begin(), order.begin() + std::ssize(order) / 2, order.end());
  check();
}

/// Two equal oscillators on a third: no input moves their difference, and no output sees it.
Diagram two_on_one() {
  Diagram d{"two on one"};
  auto a = d.add("a", SpringMass{.mass = 1, .stiffness = d.param("k", 3)});
  auto b = d.add("b", SpringMass{.mass = 2, .stiffness = 5, .damping = 0.1});
  auto c = d.add("c", SpringMass{.mass = 2, .stiffness = 5, .damping = 0.1});
  ground(a);
  mount(b, a.child);
  mount(c, a.child);
  a.child.force += d.input("u");
  d.output("y") = a.stretch;
  return d;
}

/// The wall, a spring, a point without mass, another spring, a mass.
Diagram without_mass() {
  Diagram d{"without mass"};
  auto a = d.add("a", SpringMass{.mass = 7, .stiffness = d.param("k", 3)});
  auto b = d.add("b", SpringMass{.mass = 2, .stiffness = 5});
  a.child.accel = 0;
  b.parent.accel = a.parent.accel;
  a.parent.force = -b.parent.force;
  b.child.force = d.input("u");
  d.output("x") = b.stretch;
  return d;
}

/// Bodies of masses that differ by 1e9: the dense model loses digits.
Diagram heavy_and_light() {
  Diagram d{"heavy and light"};
  std::vector<SpringMass::Handle> z;
  for (int i = 0; i < 6; ++i) {
    z.push_back(
        d.add(fmt::format("z{}", i), SpringMass{.mass = i % 2 ? 1e9 : 1.0, .stiffness = 4}));
    if (i > 0) mount(z[static_cast<std::size_t>(i)], z[static_cast<std::size_t>(i - 1)].child);
  }
  z[0].parent.force = -d.input("u");
  d.output("a") = z[5].child.accel;
  return d;
}

}  // namespace

TEST_CASE("results do not depend on the order of calls") {
  SUBCASE("five masses") {
    check_orders([] {
      return compile(titop_test::five_masses_scene(titop_test::kMasses, titop_test::kStiffnesses));
    });
  }
  SUBCASE("a mode that no output sees") {
    check_orders([] { return compile(two_on_one()); });
  }
  SUBCASE("a point without mass") {
    check_orders([] { return compile(without_mass()); });
  }
  SUBCASE("updated") {
    check_orders([] { return compile(two_on_one()).update({{"k", 4.0}}); });
  }
  SUBCASE("not minimized") {
    check_orders([] { return compile(two_on_one(), {.minimize_up_to = 3}); });
  }
  SUBCASE("digits are lost") {
    check_orders([] { return compile(heavy_and_light()); });
  }
}

TEST_CASE("systems of one plan do not depend on each other's calls") {
  const auto both = [](bool base_first) {
    const System base = compile(two_on_one());
    const System now = base.update({{"k", 5.0}});
    std::vector<std::string> of_base, of_now;
    for (const Call& call : calls()) {
      if (base_first) of_base.push_back(result(call, base));
      of_now.push_back(result(call, now));
      if (!base_first) of_base.push_back(result(call, base));
    }
    of_base.insert(of_base.end(), of_now.begin(), of_now.end());
    return of_base;
  };
  CHECK(both(true) == both(false));
}
