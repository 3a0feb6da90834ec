#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <titop/titop.hpp>
#include <utility>
#include <vector>

#include "support/rng.hpp"

/// A smaller model may be right in exact arithmetic, and cancel more in double.

using namespace titop;

namespace {

/// Free masses of 1 and `mass`, joined by dampers, and a grounded one that hears of them by `gain`.
Diagram nearly_equal_poles(double mass, double gain) {
  Diagram d{"nearly_equal_poles"};
  auto u = d.input("u");
  auto a = d.add("a", SpringMass{.mass = 1, .stiffness = 0, .damping = 1, .parent_mass = 1});
  auto b = d.add("b", SpringMass{.mass = 1, .stiffness = 0, .damping = 1, .parent_mass = mass});
  auto c = d.add("c", SpringMass{.mass = 1, .stiffness = 1});
  a.parent.force = -u;
  mount(b, a.child);
  ground(c);
  c.child.force = gain * b.child.rate;
  a.child.force += 1.0 * c.stretch;
  d.output("x") = a.child.position;
  return d;
}

/// Against 32 digits, at each of these points by itself.
double worst_error(const System& system, const StateSpace& model) {
  double worst = 0;
  for (const std::complex<double> s :
       {std::complex<double>(0.01, 0.02), {0.1, 0.2}, {0.3, 0.7}, {0.05, 1}, {0.5, 3}, {1, 10}}) {
    const std::complex<double> exact = system.transfer(s, Precision::twofold)(0, 0);
    worst = std::max(worst, std::abs(model.transfer(s)(0, 0) - exact) / std::abs(exact));
  }
  return worst;
}

}  // namespace

TEST_CASE("a smaller model keeps the digits that it promises, or all states stay") {
  // By exact arithmetic (Options::exact_up_to = 20) the order is 5 for all of these.
  int put_back = 0;
  for (const double mass : {26000.0, 1024.0, 1000.0})
    for (const double gain : {1e-5, 1e-4, 1e-3}) {
      const System system = compile(nearly_equal_poles(mass, gain));
      const OrderVerdict verdict = system.order_verdict();
      CAPTURE(mass);
      CAPTURE(gain);
      CAPTURE(to_string(verdict));
      CHECK(worst_error(system, system.state_space()) <= 1e-8);
      CHECK(verdict.lowest <= 5);
      CHECK(verdict.order >= 5);
      if (verdict.removed.empty()) {
        ++put_back;
        CHECK(system.state_space().order() == 8);
        CHECK_FALSE(verdict.decided());
      }
      CHECK(certify(system).holds());
    }
  CHECK(put_back < 9);
}

namespace {

/// Four integrators that leak at rates near 1e-9 rad/s, in series, beside a mode that no output
/// sees.
struct SlowSeries {
  bool filtered;  ///< behind 1 / (s^2 + 2 s + 5)

  static double rate(int k) { return 1e-9 * (1 + k / 7.0); }
  System system() const {
    Diagram d{"slow"};
    const auto u = d.input("u");
    const auto lag = [](double p) {
      return Lti{.A = Eigen::MatrixXd::Constant(1, 1, -p),
                 .B = Eigen::MatrixXd::Ones(1, 1),
                 .C = Eigen::MatrixXd::Ones(1, 1)};
    };
    auto before = d.add("p1", lag(rate(1)));
    if (filtered) {
      Eigen::Matrix2d A{{0, 1}, {-5, -2}};
      auto f = d.add("f", Lti{.A = A, .B = Eigen::Vector2d(0, 1), .C = Eigen::RowVector2d(1, 0)});
      f.in = u;
      before.in = f.out;
    } else {
      before.in = u;
    }
    for (int k = 2; k <= 4; ++k) {
      auto next = d.add("p" + std::to_string(k), lag(rate(k)));
      next.in = before.out;
      before = next;
    }
    auto unseen = d.add("unseen", lag(3));
    unseen.in = before.out;
    d.output("y") = before.out;
    d.output("none") = unseen.out - unseen.out;
    return compile(d);
  }
  std::complex<double> exact(std::complex<double> s) const {
    std::complex<double> G = filtered ? 1.0 / (s * (s + 2.0) + 5.0) : 1.0;
    for (int k = 1; k <= 4; ++k) G /= s + rate(k);
    return G;
  }
};

}  // namespace

TEST_CASE("slow integrators in series keep their digits above and at their rates") {
  for (const bool filtered : {false, true}) {
    const SlowSeries series{filtered};
    const System system = series.system();
    StateSpace written;
    system.write(written);
    const StateSpace& model = system.state_space();
    CHECK(model.order() == (filtered ? 6 : 4));
    for (const std::complex<double> s :
         {std::complex<double>(0, 3.7), {0, 30}, {0, 1e-9}, {1e-4, 1e-3}}) {
      CAPTURE(s);
      const std::complex<double> exact = series.exact(s);
      const auto error = [&](const StateSpace& m) {
        return std::abs(m.transfer(s)(0, 0) - exact) / std::abs(exact);
      };
      CHECK(error(written) <= 1e-13);
      CHECK(error(model) <= 1e-9);
    }
  }
}

namespace {

/// Lags and oscillators in a row, with poles from 1e-12 to 1e3 rad/s in any order, and two equal
/// lags beside them of which only the difference is seen. Outputs: that, and the end of the row.
struct RandomSeries {
  explicit RandomSeries(std::uint64_t seed) : rng(seed) {
    const auto u = d.input("u");
    auto last = add(u);
    const int more = 1 + rng.below(4), side = rng.below(more);
    for (int i = 0; i < more; ++i) {
      if (i == side) add_unseen(last.out);
      last = add(last.out);
    }
    d.output("y") = last.out;
  }
  std::complex<double> exact(std::complex<double> s) const {
    std::complex<double> G = 1;
    for (const auto& [w, xi] : parts)
      G *= xi < 0 ? w / (s + w) : w * w / (s * (s + 2 * xi * w) + w * w);
    return G;
  }
  std::vector<double> frequencies() const {  // rad/s, of each pole or pair
    std::vector<double> result{unseen, unseen};
    for (const auto& [w, xi] : parts) result.push_back(w);
    std::sort(result.begin(), result.end());
    return result;
  }
  double fastest() const {  // rad/s
    double most = 0;
    for (const auto& [w, xi] : parts) most = std::max(most, w);
    return most;
  }

  titop_test::Rng rng;
  Diagram d{"series"};
  std::vector<std::pair<double, double>> parts;  ///< rad/s and damping ratio, or -1 for a lag
  double unseen = 0;                             ///< rad/s, of the two equal lags

 private:
  template <class Signal>
  Lti::Handle add(const Signal& from) {
    const double w = std::pow(10, rng.between(-12, 3)), xi = rng.chance(0.3) ? 0.3 : -1;
    parts.emplace_back(w, xi);
    return add(from, w, xi);
  }
  template <class Signal>
  Lti::Handle add(const Signal& from, double w, double xi) {
    const auto one = [](double x) { return Eigen::MatrixXd::Constant(1, 1, x); };
    auto part = d.add("p" + std::to_string(count_++),
                      xi < 0 ? Lti{.A = one(-w), .B = one(w), .C = one(1)}
                             : Lti{.A = Eigen::Matrix2d{{0, w}, {-w, -2 * xi * w}},
                                   .B = Eigen::Vector2d(0, w),
                                   .C = Eigen::RowVector2d(1, 0)});
    part.in = from;
    return part;
  }
  template <class Signal>
  void add_unseen(const Signal& from) {
    unseen = std::pow(10, rng.between(-12, 3));
    const auto one = add(from, unseen, -1), other = add(from, unseen, -1);
    d.output("none") = one.out - other.out;
  }
  int count_ = 0;
};

}  // namespace

TEST_CASE("minimal models of 100 series are as accurate as before, to a decade above all poles") {
  int smaller = 0;
  for (std::uint64_t seed = 1; seed <= 100; ++seed) {
    CAPTURE(seed);
    const RandomSeries series(seed);
    const System system = compile(series.d);
    StateSpace written;
    system.write(written);
    const StateSpace& model = system.state_space();
    smaller += model.order() < written.order();
    for (int decade = -12; decade <= 3; ++decade) {
      const std::complex<double> s(0, 3.7 * std::pow(10, decade)), exact = series.exact(s);
      if (s.imag() > 10 * series.fastest()) continue;
      CAPTURE(decade);
      const auto error = [&](const StateSpace& m) {
        return std::abs(m.transfer(s)(1, 0) - exact) / std::abs(exact);
      };
      CHECK(error(model) <= std::max(10 * error(written), 1e-9));
    }
  }
  CHECK(smaller >= 90);
}

TEST_CASE("poles of 100 series are those of their parts") {
  for (std::uint64_t seed = 1; seed <= 100; ++seed) {
    CAPTURE(seed);
    const RandomSeries series(seed);
    StateSpace written;
    compile(series.d).write(written);
    const std::vector<double> expected = series.frequencies();
    const std::vector<Pole> found = poles(written);
    REQUIRE(found.size() == expected.size());
    for (std::size_t k = 0; k < found.size(); ++k)
      CHECK(std::abs(found[k].omega - expected[k]) <= 1e-13 * expected[k]);
  }
}

TEST_CASE("states leave where that costs no digits") {
  const System system = compile(nearly_equal_poles(2, 0.1));
  StateSpace written;
  system.write(written);
  CHECK(system.state_space().order() < written.order());
  CHECK(worst_error(system, system.state_space()) <= 1e-9);
}
