#include <doctest/doctest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <functional>
#include <thread>
#include <titop/graph/support/parallel.hpp>
#include <titop/titop.hpp>

#include "support/close.hpp"
#include "support/mistakes.hpp"

/// Sweeps, and concurrent use of one System: the same to the last bit for any number of threads.

using namespace titop;

namespace {

Diagram one_mass() {
  Diagram d{"one"};
  auto u = d.input("u");
  auto z = d.add("z", SpringMass{.mass = d.param("m", 1.0), .stiffness = 100.0});
  ground(z);
  z.child.force = u;
  d.output("x") = z.stretch;
  return d;
}

}  // namespace

TEST_CASE("sweep: the frequency of one mass is sqrt(k/m), with any number of threads") {
  const System system = compile(one_mass());
  std::vector<ParameterList> points;
  for (int i = 1; i <= 50; ++i) points.push_back({{"m", 0.1 * i}});
  const auto run = [&](int threads, std::size_t& reports) {
    std::vector<double> omega(points.size());
    sweep(system, points,
          [&](std::size_t i, const System& at) { omega[i] = at.poles().front().omega; },
          {.threads = threads, .progress = [&](std::size_t, std::size_t all) {
             ++reports;
             CHECK(all == 50);
           }});
    return omega;
  };
  std::size_t first = 0, second = 0;
  const auto one = run(1, first), four = run(4, second);
  CHECK(first == points.size());
  CHECK(second == points.size());
  CHECK(one == four);
  for (std::size_t i = 0; i < one.size(); ++i)
    CHECK(titop_test::relative(one[i], std::sqrt(100.0 / (0.1 * double(i + 1)))) <= 1e-14);
}

TEST_CASE("sweep: the first point that makes no model is named") {
  const System system = compile(one_mass());
  const std::vector<ParameterList> points{{{"m", 1.0}}, {{"m", -1.0}}, {{"m", -2.0}}};
  const titop::Error error = titop_test::error_of(
      [&] { sweep(system, points, [](std::size_t, const System&) {}, {.threads = 3}); });
  CHECK(titop_test::says(error, titop::Code::bad_inertia, {"z", "mass -1", "point 1"}));
}

TEST_CASE("threads: every task is done once, on as many threads as there are tasks at most") {
  for (const int threads : {1, 3, 64})
    for (const std::size_t count : {0u, 1u, 2u, 40u}) {
      CAPTURE(threads);
      CAPTURE(count);
      std::vector<std::atomic<int>> done(count);
      std::atomic<int> made = 0;
      detail::parallel(count, threads, [&] {
        ++made;
        return [&](std::size_t i) { ++done[i]; };
      });
      CHECK(std::all_of(done.begin(), done.end(), [](const auto& times) { return times == 1; }));
      CHECK(made <= std::min<int>(threads, static_cast<int>(count)));
    }
}

TEST_CASE("threads: errors of a task, or of its construction, are thrown after all have stopped") {
  for (const int threads : {1, 3, 64}) {
    CAPTURE(threads);
    const auto make = []() -> std::function<void(std::size_t)> {
      throw std::runtime_error("no room");
    };
    CHECK_THROWS_WITH(detail::parallel(40, threads, make), "no room");
    const auto task = [] {
      return [](std::size_t i) {
        if (i >= 20) throw std::runtime_error(std::to_string(i));
      };
    };
    CHECK_THROWS_WITH(detail::parallel(40, threads, task), "20");
  }
}

TEST_CASE("threads: tasks may have tasks of their own, on many threads of the caller's") {
  std::array<std::atomic<int>, 3> done{};
  std::vector<std::jthread> callers;
  for (std::atomic<int>& count : done)
    callers.emplace_back([&count] {
      detail::parallel(5, 3, [&] {
        return [&](std::size_t) {
          detail::parallel(7, 2, [&] { return [&](std::size_t) { ++count; }; });
        };
      });
    });
  callers.clear();
  for (const std::atomic<int>& count : done) CHECK(count == 35);
}

TEST_CASE("threads: a child process starts threads of its own") {
  std::atomic<int> done = 0;
  const auto run = [&] {
    done = 0;
    detail::parallel(40, 3, [&] { return [&](std::size_t) { ++done; }; });
  };
  run();
  const pid_t child = fork();
  REQUIRE(child >= 0);
  if (child == 0) {
    alarm(30);  // it must not wait for ever
    run();
    _exit(done == 40 ? 0 : 1);
  }
  int status = -1;
  CHECK(waitpid(child, &status, 0) == child);
  CHECK(status == 0);
}

namespace {

/// A hub with two hinged booms of six modes: three-dimensional, 6 inputs, an angle as a parameter.
Diagram spacecraft() {
  Diagram d{"spacecraft"};
  auto U = d.input("U", 6);
  auto hub = d.add("hub", RigidBody{.mass = 85,
                                    .inertia = Vector3d(9, 11, 13).asDiagonal(),
                                    .children = {{"C1", {0.3, 0, 0.1}}, {"C2", {-0.3, 0, 0.2}}}});
  const FlexibleBody boom = Beam{.length = 2.0,
                                 .section = rectangle(0.06, 0.04),
                                 .material = {.E = 70e9, .nu = 0.33, .rho = 2700},
                                 .elements = 4,
                                 .modes = {.kept = 6, .xi = {0.005}}};
  auto left = d.add("left", boom), right = d.add("right", boom);
  hub.parent.force = -U;
  const Rotation T = Rotation::about({1, 2, 9}, Value(d.param("angle", 0.4)));
  auto drive = hinge(d, "drive", left, hub.child("C1"), T, {0, 1, 0});
  drive.torque = 120 * drive.angle + 3.0 * drive.rate;
  mount(right, hub.child("C2"), Rotation::about({0, 0, 1}, 3.0));
  d.output("a", 6) = right.child.accel;
  d.output("angle") = drive.angle;
  return d;
}

bool same(const StateSpace& a, const StateSpace& b) {
  return a.A == b.A && a.B == b.B && a.C == b.C && a.D == b.D;
}

}  // namespace

TEST_CASE("threads: frequency responses and dense models have the same bits") {
  const System system = compile(spacecraft());
  std::vector<double> omega;
  for (int i = 0; i < 40; ++i) omega.push_back(0.3 * std::pow(1.2, i));
  const auto one = system.frequency_response(omega, 1);
  REQUIRE(one.size() == omega.size());
  StateSpace alone;
  system.write(alone, 1);
  for (const int threads : {2, 3, 7}) {
    CAPTURE(threads);
    const auto many = system.frequency_response(omega, threads);
    for (std::size_t i = 0; i < one.size(); ++i) CHECK(one[i] == many[i]);
    StateSpace model;
    system.write(model, threads);
    CHECK(same(alone, model));
  }
}

TEST_CASE("threads: a frequency response in the precision that is asked for") {
  const System system = compile(spacecraft());
  const std::array omega{1.0, 30.0};
  for (const Precision p :
       {Precision::standard, Precision::refined, Precision::twofold, Precision::digits50}) {
    const auto found = system.frequency_response(omega, 2, p);
    for (std::size_t i = 0; i < omega.size(); ++i)
      CHECK(found[i] == system.transfer({0, omega[i]}, p));
  }
}

TEST_CASE("threads: sweeps over parameters have the same bits") {
  const System system = compile(spacecraft());
  std::vector<ParameterList> points;
  for (int i = 0; i < 20; ++i) points.push_back({{"angle", 0.1 * i}});
  const auto run = [&](int threads) {
    std::vector<std::pair<StateSpace, Eigen::MatrixXcd>> found(points.size());
    sweep(system, points,
          [&](std::size_t i, const System& at) {
            at.write(found[i].first, 1);
            found[i].second = at.transfer({0, 7});
          },
          {.threads = threads});
    return found;
  };
  const auto one = run(1), many = run(5);
  for (std::size_t i = 0; i < points.size(); ++i) {
    CHECK(same(one[i].first, many[i].first));
    CHECK(one[i].second == many[i].second);
  }
  CHECK(!same(one[1].first, one[2].first));
}

TEST_CASE("threads: values computed at the first call may be requested by all at once") {
  const auto there_and_back = [] {
    return compile(spacecraft()).update({{"angle", 1.0}}).update({{"angle", 0.4}});
  };
  const System fresh = compile(spacecraft()), alone = there_and_back();
  CHECK(same(fresh.state_space(), alone.state_space()));
  const std::string log = alone.log() + alone.dense_log();
  for (int round = 0; round < 10; ++round) {
    const System system = there_and_back();
    std::atomic<int> waiting{6};
    std::array<StateSpace, 6> models = {};
    std::array<double, 6> residuals{};
    std::array<std::string, 6> logs;
    std::vector<std::thread> threads;
    for (std::size_t i = 0; i < models.size(); ++i)
      threads.emplace_back([&, i] {
        --waiting;
        while (waiting > 0) std::this_thread::yield();
        residuals[i] = system.certificate().residual;
        models[i] = system.state_space();
        logs[i] = system.log() + system.dense_log();
      });
    for (std::thread& t : threads) t.join();
    for (std::size_t i = 0; i < models.size(); ++i) {
      CHECK(same(models[i], alone.state_space()));
      CHECK(residuals[i] == alone.certificate().residual);
      CHECK(logs[i] == log);
    }
  }
  CHECK(log.find("minimize") != std::string::npos);
}
