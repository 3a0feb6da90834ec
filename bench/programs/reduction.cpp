/// bench_reduction [quick]: order and cost against accuracy, in CSV, a row per scene and accuracy:
/// the states that `what_if` keeps, its bound and the error, processor seconds of one transfer and
/// of a simulation and those of the full system, and the order of plain truncation by frequency
/// for the same accuracy. After each scene two rows for the rule that keeps all modes up to twice
/// the band. Returns 1 if an error is above its bound. bench_reduction large: scenes of thousands
/// of coordinates instead, step by step, and a block of 270 states. docs/reduction/README.md
/// explains the columns.
#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <numbers>
#include <optional>
#include <stdexcept>
#include <string_view>
#include <titop/graph/linalg/dense.hpp>
#include <titop/titop.hpp>

#include "generate/draws.hpp"
#include "scenes/satellite.hpp"
#include "support/fine_grid.hpp"
#include "support/in_time.hpp"
#include "support/processor_seconds.hpp"
#include "support/questions.hpp"
#include "support/quick.hpp"
#include "support/truncation.hpp"

using namespace titop;
using namespace titop_bench;

namespace {

/// Time [s] of one transfer near the band's end: the least of nine runs of fifty.
double seconds_of(const TransferOf& transfer, double omega) {
  double least = HUGE_VAL, sum = 0;
  for (int run = 0; run < 9; ++run) {
    const double start = processor_seconds();
    for (int k = 0; k < 50; ++k) sum += std::abs(transfer({0.01 * omega, omega + k})(0, 0));
    least = std::min(least, (processor_seconds() - start) / 50);
  }
  return std::isfinite(sum) ? least : 0;
}

/// Frequencies at which the full system can have peaks: its modes, or the poles of the dense model
/// [rad/s].
Eigen::VectorXd frequencies(const System& full, const std::optional<Truncation>& modes) {
  if (modes) return modes->omega();
  StateSpace dense;
  full.write(dense);
  return linalg::eigenvalues(dense.A).cwiseAbs();
}

/// Throws if none of the accuracies is reached.
std::vector<WhatIf> reached(const Question& q, std::vector<WhatIf> rows) {
  if (rows.empty()) throw std::runtime_error(q.name + " reaches none of the accuracies asked for");
  return rows;
}

/// All that is measured on one scene.
class Measured {
 public:
  Measured(const Question& q, const std::vector<double>& accuracies, bool quick)
      : q_(q),
        quick_(quick),
        diagram_(q.diagram()),
        omega_(2 * std::numbers::pi * q.scene.band_hz[1]),
        rows_(reached(q, what_if(diagram_, q.scene, accuracies))),
        full_(rows_.back().system.full()) {
    if (q.structure) modes_.emplace(diagram_, q.scene);
    int samples = 0;
    for (const WhatIf& r : rows_) samples = std::max(samples, r.system.bound().samples);
    grid_.emplace(full_, q.scene, 10 * samples, frequencies(full_, modes_),
                  rows_.back().system.bound().peak);
    full_seconds_ = seconds_of([&](auto s) { return full_.transfer(s); }, omega_);
    full_run_ = run(full_, q.scene.band_hz[1], quick);
    if (full_run_.trajectory.stepper == Stepper::midpoint) {
      full_midpoint_ = full_run_.trajectory.y;
    } else {
      StateSpace dense;
      full_.write(dense);
      full_midpoint_ = by_midpoint(dense, q.scene.band_hz[1], quick);
    }
  }

  /// True if every error is below its bound.
  bool print(double finest) {
    bool below = true;
    for (const WhatIf& r : rows_) below &= print(r);
    if (rows_.back().accuracy > finest) say_why(finest);
    rule_of_bodies();
    if (modes_) rule_of_the_whole();
    return below;
  }

 private:
  bool print(const WhatIf& r) {
    const double error = grid_->error([&](auto s) { return r.system.transfer(s); });
    fmt::print("{},{:.0e},{},{},{:.2e},{:.2e},{:.2e},{:.2e}", q_.name, r.accuracy, r.order,
               full_.order(), r.bound, error,
               seconds_of([&](auto s) { return r.system.transfer(s); }, omega_), full_seconds_);
    if (modes_) {
      const long count = modes_->needed(r.accuracy, *grid_);
      const detail::Small& plain = modes_->model(count);
      fmt::print(",{},{:.2e},{:.2e}", 2 * plain.order(), modes_->error(count, *grid_),
                 seconds_of([&](auto s) { return plain.transfer(s); }, omega_));
    } else {
      fmt::print(",,,");
    }
    const Run small = run(in_its_place(r.system, diagram_), q_.scene.band_hz[1], quick_);
    const Eigen::MatrixXd midpoint =
        by_midpoint(r.system.state_space(), q_.scene.band_hz[1], quick_);
    fmt::print(",{:.2e},{:.2e},{:.2e},{:.2e},{:.2e},{:.2e}\n", small.seconds, small.start,
               full_run_.seconds, full_run_.start,
               difference(small.trajectory.y, full_run_.trajectory.y),
               difference(midpoint, full_midpoint_));
    std::fflush(stdout);
    return error <= r.bound;
  }

  /// Logs the error that ends the range of attainable accuracies.
  void say_why(double finest) const {
    Scene scene = q_.scene;
    scene.accuracy = finest;
    try {
      (void)compile(diagram_, scene);
    } catch (const Error& error) {
      fmt::print(stderr, "{}: {}\n", q_.name, error.what());
    }
  }

  void print_rule(const char* name, long states, const TransferOf& transfer) {
    fmt::print("{},{},{},{},,{:.2e},{:.2e},{:.2e},,,,,,,,,\n", q_.name, name, states, full_.order(),
               grid_->error(transfer), seconds_of(transfer, omega_), full_seconds_);
    std::fflush(stdout);
  }

  void rule_of_bodies() {
    const System system = compile(q_.with_modes_up_to(2 * q_.scene.band_hz[1]));
    print_rule("bodies", system.order(), [&](auto s) { return system.transfer(s); });
  }

  void rule_of_the_whole() {
    const Eigen::VectorXd omega = modes_->omega();
    const detail::Small& m = modes_->model((omega.array() <= 2 * omega_).count());
    print_rule("whole", 2 * m.order(), [&](auto s) { return m.transfer(s); });
  }

  const Question& q_;
  bool quick_;
  Diagram diagram_;
  double omega_;  ///< upper end of the band [rad/s]
  std::vector<WhatIf> rows_;
  System full_;
  std::optional<Truncation> modes_;  ///< none if there is no structure
  std::optional<FineGrid> grid_;
  double full_seconds_ = 0;
  Run full_run_;
  Eigen::MatrixXd full_midpoint_;
};

/// None if the accuracy cannot be met: the log has the attained one.
std::optional<ReducedSystem> reduced(const Diagram& d, const Scene& scene) try {
  return compile(d, scene);
} catch (const Error& refusal) {
  if (!refusal.has(Code::bad_value)) throw;
  fmt::print(stderr, "{}\n", refusal.what());
  return std::nullopt;
}

/// A block of 270 states, two inputs and two outputs, without structure: poles in a circle of
/// radius 1 about -1.2.
Diagram dense_block() {
  constexpr Eigen::Index states = 270;
  generate::Rng rng(7);
  Lti block{.A = rng.matrix(states, states) * std::sqrt(3.0 / states),  // entries of variance 1/n
            .B = rng.matrix(states, 2),
            .C = rng.matrix(2, states),
            .D = Eigen::MatrixXd::Zero(2, 2)};
  block.A.diagonal().array() -= 1.2;
  Diagram d{"dense block"};
  auto K = d.add("K", block);
  K.in = d.input("u", 2);
  d.output("y", 2) = K.out;
  return d;
}

/// Reduction of a block without modes, which is a dense model from the beginning.
void dense() {
  const Diagram d = dense_block();
  for (const double accuracy : {1e-2, 1e-4, 1e-6}) {
    const auto start = std::chrono::steady_clock::now();
    const auto made = reduced(d, {.band_hz = {0, 10}, .accuracy = accuracy});
    if (!made) continue;
    const std::chrono::duration<double> seconds = std::chrono::steady_clock::now() - start;
    fmt::print("1,270,{:.0e},,,{},{:.2e},{:.1f}\n", accuracy, made->order(), made->bound().worst,
               seconds.count());
    std::fflush(stdout);
  }
}

/// Thousands of coordinates: order and error after each step, and the total seconds.
void large() {
  fmt::print("bodies,coordinates,accuracy,after_bodies,bodies_error,states,bound,seconds\n");
  const FlexibleBody beam = scenes::read_boom({});
  for (const int count : {8, 16})
    for (const double accuracy : {1e-2, 1e-4, 1e-6}) {
      const auto start = std::chrono::steady_clock::now();
      const auto made = reduced(zigzag(beam, count), {.band_hz = {0, 60}, .accuracy = accuracy});
      if (!made) continue;
      const ReducedSystem& r = *made;
      const std::chrono::duration<double> seconds = std::chrono::steady_clock::now() - start;
      const auto bodies = std::find_if(r.steps().begin(), r.steps().end(),
                                       [](const ReductionStep& s) { return s.name == "bodies"; });
      if (bodies == r.steps().end())
        throw std::runtime_error(fmt::format("{} beams have lost no modes", count));
      fmt::print("{},{},{:.0e},{},{:.1e},{},{:.2e},{:.1f}\n", count, bodies->before, accuracy,
                 bodies->after, bodies->error, r.order(), r.bound().worst, seconds.count());
      std::fflush(stdout);
    }
}

}  // namespace

int main(int argc, char** argv) {
  if (argc > 1 && std::string_view(argv[1]) == "large") {
    large();
    dense();
    return 0;
  }
  const bool quick = is_quick(argc, argv);
  std::vector<double> accuracies{1e-1, 1e-3};
  if (!quick)
    accuracies = {1e-1, 3e-2, 1e-2, 3e-3, 1e-3, 3e-4, 1e-4, 3e-5,
                  1e-5, 3e-6, 1e-6, 3e-7, 1e-7, 3e-8, 1e-8};
  fmt::print(
      "scene,asked,states,full,bound,error,transfer,full_transfer,plain,plain_error,plain_transfer,"
      "simulate,simulate_start,full_simulate,full_start,difference,same_rule\n");
  bool below = true;
  for (const Question& q : questions(quick))
    below &= Measured(q, accuracies, quick).print(accuracies.back());
  return below ? 0 : 1;
}
