// Verdict on poles in the report's head: stable, unstable, or undecided.
#include <doctest/doctest.h>

#include <string>
#include <titop/titop.hpp>

#include "markup.hpp"
#include "support/names.hpp"

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
Verdict stability(const System& system, int full_up_to = 100) {
  return verdicts(report_html(system, {.diagrams = false, .full_up_to = full_up_to})).at(0);
}

/// Its class, and the numbers in it.
bool judges(const Verdict& line, const char* cls, std::initializer_list<std::string_view> numbers) {
  return line.cls == cls && has_names(line.html, numbers);
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
    CHECK(stability(s).cls != "bad");
    CHECK_THROWS_AS(s.static_gain(), Error);
  }
}

TEST_CASE("slow beside fast is no rounding: a pole that the certificate counts is unstable") {
  const System slow = beside_fast(Eigen::VectorXd::Constant(1, 1e-3));  // the mass: 1e5 rad/s
  CHECK(certify(slow).poles.right == 1);
  CHECK(judges(stability(slow), "bad", {"1"}));
  // Without the certificate it may be either, and is called neither.
  CHECK(judges(stability(slow, 0), "open", {"1"}));
  const Verdict stable = stability(beside_fast(Eigen::VectorXd::Constant(1, -1e-3)));
  CHECK(stable.cls == "good");
  CHECK(!has_name(stable.html, "0"));  // none at 0
  // An integrator whose 0 came out as rounding of the rest.
  const System rounded = beside_fast(Eigen::VectorXd::Constant(1, 1e-11));
  CHECK(judges(stability(rounded), "good", {"1", "0"}));
}

TEST_CASE("an unstable mode that no transfer shows is unstable, and it is said that none does") {
  const System hidden = beside_fast(Eigen::Vector2d(-1, 2));
  REQUIRE(hidden.state_space().order() == 3);
  CHECK(certify(hidden).poles.hidden == 1);
  CHECK(judges(stability(hidden), "bad", {"1"}));
  const Verdict shown = stability(beside_fast(Eigen::VectorXd::Constant(1, 2)));
  CHECK(judges(shown, "bad", {"1"}));
  CHECK(stability(hidden).html != shown.html);
  // Without the certificate: no pole of the minimal model, and the others were not looked at.
  CHECK(stability(hidden, 0).cls == "open");
  CHECK(!has_name(stability(hidden, 0).html, "1"));
  CHECK(has_name(section(report_html(hidden, {.diagrams = false}), "poles"), "1 state"));
  CHECK(judges(stability(beside_fast(Eigen::Vector2d(3, 2))), "bad", {"2", "1"}));
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
  CHECK(judges(stability(compile(d)), "good", {"2 states"}));
}
