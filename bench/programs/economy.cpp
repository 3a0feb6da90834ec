/// bench_economy [quick]: what accuracy costs. Rows of CSV: for every scene and accuracy the states
/// that `what_if` keeps, its bound, seconds of one transfer and of one step of simulation beside
/// the full system's; and what plain truncation by frequency needs for the same error (0: all there
/// is; -1: there are no modes to truncate). bench_economy large: scenes of thousands of coordinates
/// instead, step by step.
#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <functional>
#include <map>
#include <numbers>
#include <optional>
#include <string_view>
#include <titop/compiler/compile_graph.hpp>
#include <titop/compiler/economy/ray.hpp>
#include <titop/compiler/economy/sharpen.hpp>
#include <titop/titop.hpp>

#include "scenes/satellite.hpp"
#include "support/quick.hpp"

using namespace titop;
using Eigen::MatrixXd;
using Eigen::VectorXd;

namespace {

double seconds_of(const std::function<void()>& f) {
  using clock = std::chrono::steady_clock;
  const auto start = clock::now();
  int count = 0;
  double passed = 0;
  for (; passed < 0.05; ++count) {
    f();
    passed = std::chrono::duration<double>(clock::now() - start).count();
  }
  return passed / count;
}

Diagram frame(const FlexibleBody& beam) {
  Diagram d{"frame"};
  auto U = d.input("U", 6);
  auto b1 = d.add("b1", beam), b2 = d.add("b2", beam), b3 = d.add("b3", beam);
  b1.parent.accel = 0;
  mount(b2, b1.child("C"), Rotation::about({1, 2, 3}, 0.7));
  mount(b3, b2.child("C"), Rotation::about({3, -1, 1}, -1.1));
  b3.child("C").force = U;
  d.output("a", 6) = b3.child("C").accel;
  return d;
}

/// The same beams in a zigzag, so many that bodies lose modes before the whole does.
Diagram zigzag(const FlexibleBody& beam, int count) {
  Diagram d{"zigzag"};
  auto U = d.input("U", 6);
  std::vector<BodyHandle> b;
  for (int i = 0; i < count; ++i) {
    b.push_back(d.add(fmt::format("b{}", i + 1), beam));
    const Rotation turn = Rotation::about({1, 2, 3}, i % 2 ? 0.7 : -0.9);
    if (i > 0) mount(b.back(), b[b.size() - 2].child("C"), turn);
  }
  b.front().parent.accel = 0;
  b.back().child("C").force = U;
  d.output("a", 6) = b.back().child("C").accel;
  return d;
}

/// Thousands of coordinates: what each step leaves, what that costs, and seconds of all of it.
void large() {
  fmt::print("bodies,coordinates,accuracy,after_bodies,bodies_error,states,bound,seconds\n");
  const FlexibleBody beam = scenes::read_boom({});
  for (const int count : {8, 16})
    for (const double accuracy : {1e-2, 1e-4, 1e-6}) {
      const auto start = std::chrono::steady_clock::now();
      const ReducedSystem r =
          compile(zigzag(beam, count), {.band_hz = {0, 60}, .accuracy = accuracy});
      const double seconds =
          std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
      const auto bodies = std::find_if(r.steps().begin(), r.steps().end(),
                                       [](const EconomyStep& s) { return s.name == "bodies"; });
      fmt::print("{},{},{:.0e},{},{:.1e},{},{:.2e},{:.1f}\n", count, bodies->before, accuracy,
                 bodies->after, bodies->error, r.order(), r.bound().worst, seconds);
      std::fflush(stdout);
    }
}

Diagram heavy(const FlexibleBody& beam) {
  Diagram d{"heavy"};
  const double m = 50 * beam.data().D_P(0, 0);
  auto U = d.input("U", 6);
  auto b = d.add("beam", beam);
  auto tip = d.add("tip", RigidBody{.mass = m, .inertia = Matrix3d::Identity() * 0.01 * m});
  b.parent.accel = 0;
  mount(tip, b.child("C"), Rotation{});
  b.child("C").force += U;
  d.output("a", 6) = tip.parent.accel;
  return d;
}

/// The hub of the satellite and two booms, its attitude held by a law with an actuator and a delay:
/// no structure, so states are balanced.
Diagram loop(const FlexibleBody& beam) {
  const MatrixXd I = MatrixXd::Identity(3, 3);
  Diagram d{"loop"};
  auto T = d.input("T", 3);
  auto hub = d.add("hub", RigidBody{.mass = 85,
                                    .inertia = Vector3d(9, 11, 13).asDiagonal(),
                                    .children = {{"C1", {0.35, 0, 0.1}}, {"C2", {-0.35, 0, 0.1}}}});
  auto boom1 = d.add("boom1", beam), boom2 = d.add("boom2", beam);
  auto law =
      d.add("law", Lti{.A = -40 * I, .B = I, .C = (30 - 45 * 40) * 40 * I, .D = 45 * 40 * I});
  auto late = d.add("late", Lti{.A = -100 * I, .B = I, .C = 200 * I, .D = -I});
  mount(boom1, hub.child("C1"), Rotation::about({0, 0, 1}, 0.26));
  mount(boom2, hub.child("C2"), Rotation::about({1, 2, 9}, 2.9));
  law.in = hub.parent.position.angular();
  late.in = law.out;
  hub.parent.force.linear = 0;
  hub.parent.force.angular = late.out - T;
  d.output("attitude", 3) = hub.parent.position.angular();
  d.output("tip", 3) = boom2.child("C").accel.linear;
  return d;
}

/// A generated structure: `modes` clamped modes in clusters of ten, damping 0.5 %, three points.
Diagram generated(int modes) {
  std::uint64_t state = 6;
  const auto random = [&] {  // splitmix64, in [-1, 1)
    std::uint64_t z = (state += 0x9E3779B97F4A7C15ull);
    z = (z ^ (z >> 30)) * 0xBF58476D1CE4E5B9ull;
    z = (z ^ (z >> 27)) * 0x94D049BB133111EBull;
    return static_cast<double>((z ^ (z >> 31)) >> 11) * 0x1p-52 - 1;
  };
  ModalData data;
  data.omega.resize(modes);
  data.xi = VectorXd::Constant(modes, 0.005);
  data.L_P = MatrixXd(modes, 6);
  data.D_P = Matrix6::Identity() * 1000;
  for (const char* name : {"C1", "C2", "C3"})
    data.children.push_back({name, Vector3d(1, 2, 3), MatrixXd(6, modes)});
  for (int j = 0; j < modes; ++j) {
    const int cluster = j / 10;
    data.omega(j) = 2 * std::numbers::pi * (1 + 0.8 * cluster) * (1 + 0.02 * random());
    for (int k = 0; k < 6; ++k) data.L_P(j, k) = random();
    for (auto& child : data.children)
      for (int k = 0; k < 6; ++k) child.Phi_C(k, j) = 0.1 * random();
  }
  Diagram d{"generated"};
  auto U = d.input("U", 3);
  auto body = d.add("body", FlexibleBody(data));
  body.parent.accel = 0;
  body.child("C1").force.linear = U;
  d.output("a1", 3) = body.child("C1").accel.linear;
  d.output("v2", 3) = body.child("C2").rate.linear();
  return d;
}

/// Modes that plain truncation by frequency needs for this error on the ray; 0 where none do.
class Plain {
 public:
  Plain(const Diagram& d, const Scene& scene) : system_(detail::compile_graph(d.graph(), {})) {
    const auto data = detail::compile_graph(detail::restricted(d.graph(), scene), {});
    system_ = System(data);
    whole_ = detail::whole(system_, detail::coordinates(system_, *data),
                           detail::positions_read(d.graph()));
    const detail::Band band = detail::band_of(system_, scene, whole_);
    detail::sharpen(whole_, system_, 1.2 * band.high);
    samples_ =
        detail::sample(system_, scene, whole_, detail::sample_points(scene, band, whole_, {}, 2));
  }
  /// By doubling and bisection to 5 %.
  long needed(double accuracy) {
    const long n = static_cast<long>(whole_.elastic());
    long few = 0, many = 1;
    while (many < n && error(many) > accuracy) few = many, many = 2 * many;
    if (many >= n) many = n;
    while (many - few > std::max(1L, many / 20)) {
      const long k = (few + many) / 2;
      (error(k) <= accuracy ? many : few) = k;
    }
    return many < n ? many : 0;
  }

 private:
  double error(long count) {
    const auto [found, fresh] = errors_.emplace(count, 0);
    if (!fresh) return found->second;
    std::vector<Eigen::Index> kept;
    for (long k = 0; k < count; ++k) kept.push_back(k);
    return found->second = detail::errors(samples_, detail::project(whole_, kept,
                                                                    MatrixXd(whole_.elastic(), 0)))
                               .maxCoeff();
  }
  System system_;
  detail::Whole whole_;
  detail::Samples samples_;
  std::map<long, double> errors_;
};

/// One step of x = A x + B u with the full matrix, and with 2 x 2 blocks.
double full_step(const StateSpace& m) {
  VectorXd x = VectorXd::Ones(m.order()), y = x;
  return seconds_of([&] { y.noalias() = m.A * x; });
}
double modal_step(const ModalModel& m) {
  VectorXd x = VectorXd::Ones(m.order()), y = x;
  return seconds_of([&] {
    for (std::size_t k = 0; k < m.A.size(); ++k)
      y.segment<2>(2 * static_cast<Eigen::Index>(k)).noalias() =
          m.A[k] * x.segment<2>(2 * static_cast<Eigen::Index>(k));
  });
}

void table(const char* name, const Diagram& d, const Scene& scene, bool quick,
           bool structure = true) {
  const std::vector<double> accuracies =
      quick ? std::vector<double>{1e-1, 1e-3}
            : std::vector<double>{1e-1, 3e-2, 1e-2, 1e-3, 1e-4, 1e-5, 1e-6, 1e-7, 3e-8, 1e-8};
  const std::vector<WhatIf> rows = what_if(d, scene, accuracies);
  if (rows.empty()) return;
  const System& full = rows.front().system.full();
  const double w = 2 * std::numbers::pi * scene.band_hz[1];
  const double full_transfer = seconds_of([&] { (void)full.transfer({0.01 * w, w}); });
  StateSpace dense;
  full.write(dense);
  const double step = full_step(dense);
  std::optional<Plain> plain;  // no modes to truncate where there is no structure: -1
  if (structure) plain.emplace(d, scene);
  for (const WhatIf& r : rows) {
    fmt::print("{},{:.0e},{},{},{:.2e},{},{:.2e},{:.2e},{:.2e},{:.2e}\n", name, r.accuracy, r.order,
               full.order(), r.bound, structure ? 2 * plain->needed(r.bound) : -1, r.seconds,
               full_transfer, modal_step(r.system.modal()), step);
    std::fflush(stdout);
  }
}

}  // namespace

int main(int argc, char** argv) {
  const bool quick = titop_bench::is_quick(argc, argv);
  if (argc > 1 && std::string_view(argv[1]) == "large") {
    large();
    return 0;
  }
  fmt::print("scene,accuracy,states,full,bound,plain,transfer,full_transfer,step,full_step\n");
  fe::ModeOptions modes;  // all 342
  if (quick) modes.kept = 20;
  const FlexibleBody beam = scenes::read_boom(modes);
  table("frame", frame(beam), {.band_hz = {0, 261}}, quick);
  table("heavy", heavy(beam), {.band_hz = {0, 261}}, quick);
  modes.xi = {0.005};
  table("satellite", scenes::satellite(scenes::read_boom(modes)), {.band_hz = {0, 300}}, quick);
  table("generated", generated(quick ? 60 : 500), {.band_hz = {0, 5}}, quick);
  table("loop", loop(scenes::read_boom(modes)), {.band_hz = {0, 100}}, quick, false);
}
