// Parts of a report: plots, programs without a shell, units of inputs and outputs.
#include <doctest/doctest.h>

#include <array>
#include <cmath>
#include <numbers>
#include <titop/emit/report/figures.hpp>
#include <titop/emit/report/html.hpp>
#include <titop/emit/report/plot.hpp>
#include <titop/emit/report/program.hpp>
#include <titop/emit/report/sweep.hpp>
#include <titop/emit/report/units.hpp>
#include <titop/titop.hpp>

#include "markup.hpp"
#include "support/five_masses.hpp"

using namespace titop;
using namespace titop_test;
namespace report = titop::report;

namespace {

report::Plot one_curve(std::vector<double> x, std::vector<double> y) {
  return {.title = "t",
          .caption = {},
          .x = {.label = "x", .unit = "s"},
          .labels = {"c"},
          .x_data = {std::move(x)},
          .frames = {{.y = {.label = "y", .unit = "m"}, .curves = {std::move(y)}, .height = 100}}};
}

std::string path_of(const std::string& figure) {
  const auto inner = between(figure, "<svg x=", "</svg>");
  REQUIRE(inner.size() == 1);
  const auto paths = between(inner.front(), " d=\"", "\"");
  REQUIRE(paths.size() == 1);
  return paths.front();
}

std::vector<std::string> units(const std::vector<report::ScalarSignal>& list) {
  std::vector<std::string> result;
  for (const report::ScalarSignal& s : list) result.push_back(s.unit);
  return result;
}

using Names = std::vector<std::string>;

RigidBody box() { return {.mass = 10, .children = {{"C", {1, 0, 0}}, {"D", {0, 1, 0}}}}; }

}  // namespace

TEST_CASE("ticks are round numbers inside the range, three to seven") {
  CHECK(report::linear_ticks(0, 1).step == 0.2);
  CHECK(report::linear_ticks(-3, 47).step == 10);
  CHECK(report::linear_ticks(-180, 90, true).step == 45);
  CHECK(report::linear_ticks(-720, 0, true).step == 180);
  for (const double span : {1e-7, 0.013, 1.0, 3.7, 9.99, 250.0, 8e9}) {
    const report::Ticks t = report::linear_ticks(-0.3 * span, 0.7 * span);
    CHECK(t.at.size() >= 3);
    CHECK(t.at.size() <= 7);
    CHECK(t.at.front() >= -0.3 * span * (1 + 1e-9));
    CHECK(t.at.back() <= 0.7 * span * (1 + 1e-9));
  }
}

TEST_CASE("a curve runs from corner to corner of its frame, whatever the axes' kind") {
  report::Plot plot = one_curve({0, 1}, {0, 2});
  plot.x.high = 1, plot.frames[0].y.high = 2;
  CHECK(path_of(report::figure(plot)) == "M0.0 100.0L440.0 0.0");
  plot = one_curve({1, 10, 100}, {1, 10, 100});
  plot.x.log = plot.frames[0].y.log = true;
  plot.x.low = plot.frames[0].y.low = 1, plot.x.high = plot.frames[0].y.high = 100;
  CHECK(path_of(report::figure(plot)) == "M0.0 100.0L220.0 50.0L440.0 0.0");
}

TEST_CASE("no peak is lost among many points, and a gap is a gap") {
  std::vector<double> x, y;
  for (int i = 0; i <= 100000; ++i) x.push_back(i), y.push_back(i == 33333 ? 1 : 0);
  report::Plot plot = one_curve(x, y);
  plot.x.high = 100000, plot.frames[0].y.high = 1;
  const std::string path = path_of(report::figure(plot));
  CHECK(count(path, " 0.0") == 1);
  CHECK(path.size() < 40000);
  y[50000] = std::nan("");
  plot.frames[0].curves = {y};
  CHECK(count(path_of(report::figure(plot)), "M") == 2);
}

TEST_CASE("axes carry units, and a power of ten where numbers are small") {
  report::Plot plot = one_curve({0, 1}, {0, 2e-5});
  std::string figure = report::figure(plot);
  CHECK(has(figure, ">x [s]<"));
  CHECK(has(figure, ">y [10⁻⁶ m]<"));
  CHECK(has(figure, ">20<"));
  plot.labels = {"<a> & \"b\""};
  figure = report::figure(plot);
  CHECK(has(figure, "&lt;a&gt; &amp; &quot;b&quot;"));
}

TEST_CASE("numbers: powers of ten only where they are small or large, never C's notation") {
  CHECK(report::number(8000, 2) == "8000");
  CHECK(report::number(1234.5, 3) == "1234");  // half to even
  CHECK(report::number(-800, 2) == "-800");
  CHECK(report::number(99.7, 2) == "100");
  CHECK(report::number(123.456) == "123.5");
  CHECK(report::number(12345.67) == "12345.7");
  CHECK(report::number(999999.7) == "1000000");
  CHECK(report::number(1.25e-5, 3) == "1.25·10⁻⁵");
  CHECK(report::number(-3e16, 2) == "-3·10¹⁶");
  CHECK(report::number(0) == "0");
}

TEST_CASE("the end of a step response: that of its own modes, without slow ones of little effect") {
  // y = 1 / (s + 1) + share / (5000 s + 1) to a step of u; and the slow part alone.
  const auto ends = [](double share) {
    Diagram d{"two lags"};
    auto u = d.input("u");
    const auto lag = [&](const char* name, double rate) {
      return d.add(name, Lti{.A = Eigen::MatrixXd::Constant(1, 1, -rate),
                             .B = Eigen::MatrixXd::Constant(1, 1, rate),
                             .C = Eigen::MatrixXd::Constant(1, 1, 1)});
    };
    auto fast = lag("fast", 1), slow = lag("slow", 1.0 / 5000);
    fast.in = u, slow.in = u;
    d.output("y") = fast.out + share * slow.out;
    d.output("z") = slow.out;
    const System system = compile(d);
    const ReportOptions options{};
    const report::Subject s = report::subject(system, options);
    const auto end = [&](int output) { return report::step_plot(s, {{output, 0, 0, 0}}).x.high; };
    return std::pair(end(0), end(1));
  };
  // Six time constants, rounded up to 1, 2 or 5 times a power of ten.
  CHECK(ends(0.05) == std::pair(10.0, 5e4));
  CHECK(ends(0.5) == std::pair(5e4, 5e4));
}

TEST_CASE("a long label of the y axis is smaller, as long as the frame") {
  report::Plot plot = one_curve({0, 1}, {0, 1});
  CHECK(figure(plot).find("font-size") == std::string::npos);
  plot.frames.front().y.unit = "a unit of forty letters, each of them one";
  CHECK(between(figure(plot), "class=\"y-label\" style=\"font-size:", "px\"").size() == 1);
}

TEST_CASE("a number that is too long for the left of the frame is narrowed") {
  CHECK(between(figure(one_curve({0, 1}, {-1, 1})), "textLength=\"", "\"").empty());
  for (const double low : {0.0085, 0.99985, -0.01}) {
    const std::string text = figure(one_curve({0, 1}, {low, low + 0.0015}));
    std::size_t longer = 0;
    for (const std::string& tick : between(text, "class=\"tick\"", "</text>"))
      if (tick.size() - tick.find('>') - 1 > 6) ++longer;
    CHECK(longer > 0);
    CHECK(between(text, "textLength=\"", "\"") == std::vector<std::string>(longer, "42"));
  }
}

TEST_CASE("frequencies stay in the band, and are closer at the poles in it") {
  for (const double damping : {0.0, 0.05, 0.095, 0.1}) {
    CAPTURE(damping);
    Diagram d{"one"};
    auto z = d.add("z", SpringMass{.mass = 1, .stiffness = 100, .damping = 20 * damping});
    ground(z);
    z.child.force = d.input("u");
    d.output("x") = z.stretch;
    const System system = compile(d);
    const double hertz = 10 / (2 * std::numbers::pi);  // of the mode
    for (const auto& [low, high] :
         {std::pair(0.0, 0.0), {1.0, 2.0}, {1.59, 1.6}, {1e-150, 1e150}}) {
      CAPTURE(high);
      const ReportOptions options{.band_hz = {low, high}};
      const report::Sweep sweep = report::sweep(report::subject(system, options));
      const double lowest = low > 0 ? low : hertz / 10, highest = high > 0 ? high : 4 * hertz;
      REQUIRE(sweep.hertz.size() >= 500);
      CHECK(std::abs(sweep.hertz.front() / lowest - 1) <= 1e-14);
      CHECK(std::abs(sweep.hertz.back() / highest - 1) <= 1e-14);
      CHECK(sweep.hertz.size() > 500);
      for (std::size_t i = 1; i < sweep.hertz.size(); ++i)
        CHECK(sweep.hertz[i] > sweep.hertz[i - 1]);
    }
  }
}

TEST_CASE("programs get their words and their input as they are") {
  const std::string odd = "$(touch x); a 'b' \"c\" \\ *";
  report::Finished r = report::run({"printf", "%s|%s", odd, "-- \n"}, "");
  CHECK(r.found);
  CHECK(r.code == 0);
  CHECK(r.out == odd + "|-- \n");
  const std::string much(3'000'000, 'x');
  CHECK(report::run({"cat"}, much).out == much);
  CHECK(report::run({"sh", "-c", "echo no >&2; exit 3"}, "").code == 3);
  CHECK(report::run({"sh", "-c", "echo no >&2; exit 3"}, "").err == "no\n");
  CHECK(report::run({"sh", "-c", "kill -9 $$"}, "").code == 128 + 9);
  CHECK_FALSE(report::run({"titop-no-such-program"}, "").found);
}

TEST_CASE("units follow from the ports that are driven and read") {
  const Stage masses = compile(five_masses_scene(kMasses, kStiffnesses)).stage();
  CHECK(units(report::scalar_inputs(masses)) == Names{"N"});
  CHECK(units(report::scalar_outputs(masses)) == Names{"m", "m", "m", "m", "m", "m/s²"});

  Diagram d{"units"};
  auto W = d.input("W", 6);
  auto a = d.input("a", 6), t = d.input("t", 3);
  auto m = d.input("m"), f = d.input("f"), scaled = d.input("scaled"), both = d.input("both");
  auto B = d.add("B", box());
  auto A = d.add("A", box());
  auto C = d.add("C", box());
  auto E = d.add("E", box());
  auto z = d.add("z", SpringMass{});
  E.parent.accel = a;
  B.parent.force = -(Rotation::about({0, 0, 1}, 0.3) * W);
  auto h = hinge(d, "h", A, B.child("C"), Rotation::about({0, 0, 1}, 0.5), {0, 0, 1});
  h.torque = 30.0 * h.angle - m - 2.0 * scaled + both;
  auto s = slide(d, "s", C, B.child("D"), Rotation(), {1, 0, 0});
  s.force = 3.0 * s.travel - f - both;
  A.child("C").force.angular = t;
  z.parent.accel = A.child("D").accel.about({0, 1, 0});  // a torsion spring
  A.child("D").force.about({0, 1, 0}) += z.parent.force;
  d.output("accel", 6) = B.parent.accel;
  d.output("rate", 6) = B.parent.rate;
  d.output("position", 6) = B.parent.position;
  d.output("reaction", 6) = E.parent.force;
  d.output("turn", 3) = B.parent.accel.angular;
  d.output("angle") = h.angle;
  d.output("angle_rate") = h.rate;
  d.output("travel") = s.travel;
  d.output("travel_rate") = s.rate;
  d.output("twist") = z.stretch;
  d.output("mixed") = h.angle + s.travel;
  d.output("doubled") = 2.0 * h.angle;
  const Stage stage = compile(d).stage();
  const Names in = units(report::scalar_inputs(stage)), out = units(report::scalar_outputs(stage));
  CHECK(in == Names{"N", "N", "N", "N m", "N m", "N m", "m/s²", "m/s²", "m/s²", "rad/s²", "rad/s²",
                    "rad/s²", "N m", "N m", "N m", "N m", "N", "", ""});
  CHECK(out == Names{"m/s²",  "m/s²", "m/s²",  "rad/s²", "rad/s²", "rad/s²", "m/s",
                     "m/s",   "m/s",  "rad/s", "rad/s",  "rad/s",  "m",      "m",
                     "m",     "rad",  "rad",   "rad",    "N",      "N",      "N",
                     "N m",   "N m",  "N m",   "rad/s²", "rad/s²", "rad/s²", "rad",
                     "rad/s", "m",    "m/s",   "rad",    "",       ""});
}

TEST_CASE("a curve that varies in its last digits is a constant") {
  const double one = std::nextafter(1.0, 2.0);
  const std::string text = report::figure(one_curve({0, 1, 2}, {1, one, one}));
  CHECK(text.find("NaN") == std::string::npos);
  CHECK(between(text, "class=\"tick\"", "</text>").size() < 40);
  const report::Ticks far = report::linear_ticks(1 - 1e-11, 1 + 1e-11);
  CHECK(far.at.size() >= 3);
  CHECK(far.at.size() <= 7);
}
