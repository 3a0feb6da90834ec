// Verdict on poles in the report's head: stable, unstable, or undecided.
#include <doctest/doctest.h>

#include <string>
#include <titop/titop.hpp>

#include "markup.hpp"

using namespace titop;
using namespace titop_test;

namespace {

/// A mass on a stiff spring, and states of rates `diagonal`; u drives the first of them.
System beside_fast(const Eigen::VectorXd& diagonal) {
  Diagram d{"beside"};
  auto u = d.input("u");
  auto z = d.add("z", SpringMass{.mass = 1, .stiffness = 1e10, .damping = 2e4});
  ground(z);
  z.child.force = -u;
  auto K = d.add("K", Lti{.A = diagonal.asDiagonal(),
                          .B = Eigen::MatrixXd::Identity(diagonal.size(), 1),
                          .C = Eigen::MatrixXd::Ones(1, diagonal.size())});
  K.in = u;
  d.output("x") = z.stretch;
  d.output("y") = K.out;
  return compile(d);
}

/// The head's line on stability.
std::string stability(const System& system, int full_up_to = 100) {
  const std::string page = report_html(system, {.diagrams = false, .full_up_to = full_up_to});
  const auto lines = between(page, "<ul class=\"verdicts\">\n", "</li>");
  REQUIRE(lines.size() == 1);
  return lines.front();
}

}  // namespace

TEST_CASE("a free chain of hinges is not called unstable where rounding moves its poles at 0") {
  // Three discs on one axis, springs between them; a damper between the first two spreads the
  // common motion over states that do not come apart.
  for (int k = 1; k <= 12; ++k) {
    CAPTURE(k);
    Diagram d{"discs"};
    auto u = d.input("u");
    std::vector<Lti::Handle> disc;
    const double inertia[] = {1, 4.9 * k, 0.7 + k / 7.0};
    for (int i = 0; i < 3; ++i)
      disc.push_back(
          d.add("disc" + std::to_string(i), Lti{.A = (Eigen::Matrix2d() << 0, 1, 0, 0).finished(),
                                                .B = Eigen::Vector2d(0, 1 / inertia[i]),
                                                .C = Eigen::Matrix2d::Identity(),
                                                .D = Eigen::MatrixXd::Zero(2, 1)}));
    const Eigen::RowVector2d spring(49, 0), damped(49, 0.3 * k);
    disc[0].in = damped * disc[1].out - damped * disc[0].out + u;
    disc[1].in =
        damped * disc[0].out - damped * disc[1].out + spring * disc[2].out - spring * disc[1].out;
    disc[2].in = spring * disc[1].out - spring * disc[2].out;
    d.output("angle") = Eigen::RowVector2d(1, 0) * disc[2].out;
    const System s = compile(d);
    const std::string page = report_html(s, {.diagrams = false});
    CHECK(page.find("<b>Unstable</b>") == std::string::npos);
    CHECK_THROWS_AS(s.static_gain(), Error);
  }
}

TEST_CASE("slow beside fast is no rounding: a pole that the certificate counts is unstable") {
  const System slow = beside_fast(Eigen::VectorXd::Constant(1, 1e-3));  // the mass: 1e5 rad/s
  CHECK(certify(slow).poles.right == 1);
  CHECK(has(stability(slow), "\"bad\"><b>Unstable</b>: 1 pole right of the imaginary axis."));
  // Without the certificate it may be either, and is called neither.
  CHECK(has(stability(slow, 0), "\"open\"><b>Undecided</b>: 1 pole right"));
  CHECK(has(stability(beside_fast(Eigen::VectorXd::Constant(1, -1e-3))), "\"good\"><b>Stable</b>"));
  // An integrator whose 0 came out as rounding of the rest.
  const System rounded = beside_fast(Eigen::VectorXd::Constant(1, 1e-11));
  CHECK(
      has(stability(rounded), "\"good\"><b>No pole</b> lies right of the imaginary axis; 1 at 0"));
}

TEST_CASE("an unstable mode that no transfer shows is unstable, and it is said that none does") {
  const System hidden = beside_fast(Eigen::Vector2d(-1, 2));
  REQUIRE(hidden.state_space().order() == 3);
  CHECK(has(stability(hidden),
            "\"bad\"><b>Unstable</b>: 1 pole right of the imaginary axis; this "
            "one no input moves or no output sees"));
  CHECK(has(stability(hidden, 0), "\"open\"><b>No pole</b> of the minimal model"));
  CHECK(has(section(report_html(hidden, {.diagrams = false}), "poles"),
            "without 1 state that no transfer"));
  CHECK(has(stability(beside_fast(Eigen::Vector2d(3, 2))),
            "<b>Unstable</b>: 2 poles right of the imaginary axis; 1 of them no input moves"));
  // Parts that the structure sets aside are not checked, and the report states it.
  Diagram d{"unseen"};
  auto u = d.input("u");
  auto z = d.add("z", SpringMass{.mass = 1, .stiffness = 4, .damping = 1});
  auto K = d.add("K", Lti{.A = Eigen::MatrixXd::Identity(2, 2),
                          .B = Eigen::MatrixXd::Ones(2, 1),
                          .C = Eigen::MatrixXd::Ones(1, 2)});
  ground(z);
  z.child.force = u;
  K.in = z.stretch;
  d.output("x") = z.stretch;
  CHECK(has(stability(compile(d)),
            "<b>Stable</b>: all poles lie left of the imaginary axis; not "
            "looked at: 2 states that the structure left out"));
}
