#include <doctest/doctest.h>
#include <fmt/format.h>

#include <titop/titop.hpp>

/// Gradients by many parameters: against the stretches of the springs, and their cost in solves.

using namespace titop;
using Eigen::MatrixXcd;
using Eigen::VectorXcd;

namespace {

/// A row of masses on springs between two points: the force at the end acts, the stretch of a
/// spring in the middle is read. The stiffnesses are parameters k1, k2, ...
struct MassRow {
  int n;
  int read;  ///< this spring's stretch

  double stiffness(int i) const { return 10 + 3 * std::sin(i); }
  /// Springs from the wall to the end.
  System compiled(bool all_stretches = false, int pulled = -1) const {
    Diagram d{"row"};
    std::vector<decltype(d.add("", SpringMass{}))> z;
    for (int i = 0; i < n; ++i) {
      const Param k = d.param(fmt::format("k{}", i + 1), stiffness(i));
      z.push_back(d.add(fmt::format("z{}", i + 1),
                        SpringMass{.mass = 1 + 0.3 * std::cos(i), .stiffness = k, .damping = 0.2}));
      if (i == 0)
        ground(z[0]);
      else
        mount(z[static_cast<std::size_t>(i)], z[static_cast<std::size_t>(i) - 1].child);
    }
    const auto u = d.input("u");
    const auto at = [&](int i) { return z[static_cast<std::size_t>(i)]; };
    if (pulled < 0) {
      at(n - 1).child.force += u;
    } else {  // both ends of a spring, apart
      at(pulled).child.force += u;
      if (pulled > 0) at(pulled - 1).child.force += -1 * u;
    }
    if (!all_stretches) d.output("y") = at(read).stretch;
    for (int i = 0; all_stretches && i < n; ++i)
      d.output(fmt::format("stretch{}", i + 1)) = at(i).stretch;
    return compile(d);
  }
};

std::vector<std::string> names(int count) {
  std::vector<std::string> result;
  for (int i = 1; i <= count; ++i) result.push_back(fmt::format("k{}", i));
  return result;
}

}  // namespace

TEST_CASE("gradients by 1, 10 and 100 stiffnesses cost the same solves") {
  const MassRow row{.n = 100, .read = 40};
  const System system = row.compiled();
  const std::complex<double> s{0.1, 2.3};
  // dH/dk_i = -(stretch_i per force that is read) (stretch_i per u), the first by reciprocity.
  const VectorXcd by_u = row.compiled(true).transfer(s),
                  by_y = row.compiled(true, row.read).transfer(s);
  std::vector<int> cost;
  for (const int count : {1, 10, 100}) {
    CAPTURE(count);
    const Derivatives g = derivatives(system, names(count));
    TransferCost c;
    const std::vector<MatrixXcd> dH = g.transfers(s, &c);
    REQUIRE(dH.size() == static_cast<std::size_t>(count));
    for (int i = 0; i < count; ++i) {
      const std::complex<double> exact = -by_y(i) * by_u(i);
      CHECK(std::abs(dH[static_cast<std::size_t>(i)](0, 0) - exact) <= 1e-11 * std::abs(exact));
    }
    CHECK(c.factorisations == 1);
    cost.push_back(c.columns + c.rows);
  }
  CHECK(cost == std::vector<int>(3, cost[0]));
  CHECK(cost[0] <= 6 * 2);  // one input, one output; each with its refinements and estimate
}

TEST_CASE("the fewer solves are chosen: by inputs and outputs, or by occurrences") {
  // Six inputs and twelve outputs; one stiffness has one occurrence, all of them twenty.
  Diagram d{"plate"};
  std::vector<SpringMass::Handle> z;
  for (int i = 0; i < 20; ++i) {
    const Param k = d.param(fmt::format("k{}", i + 1), 4 + i);
    z.push_back(
        d.add(fmt::format("z{}", i + 1), SpringMass{.mass = 1, .stiffness = k, .damping = 0.1}));
    i == 0 ? ground(z[0])
           : mount(z[static_cast<std::size_t>(i)], z[static_cast<std::size_t>(i) / 2].child);
  }
  for (int i = 0; i < 6; ++i)
    z[static_cast<std::size_t>(3 * i + 1)].child.force += d.input(fmt::format("u{}", i + 1));
  for (int i = 0; i < 12; ++i)
    d.output(fmt::format("y{}", i + 1)) = z[static_cast<std::size_t>(i + 2)].stretch;
  const Derivatives g = derivatives(compile(d), names(20));
  const std::complex<double> s{0.2, 1.1};
  TransferCost one, all;
  const MatrixXcd by_one = g.transfer(s, "k7", &one);
  const std::vector<MatrixXcd> by_all = g.transfers(s, &all);
  CHECK((by_one - by_all[6]).norm() <= 1e-12 * by_one.norm());
  CHECK(one.columns == one.rows);  // a column of w and a row of z
  CHECK(all.columns == 6 * one.columns);
  CHECK(all.rows == 12 * one.rows);
}
