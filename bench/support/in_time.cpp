#include "support/in_time.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <numbers>

#include "support/processor_seconds.hpp"

namespace titop_bench {

using namespace titop;
using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

namespace {

/// A pulse at equal steps.
struct Record {
  Record(double band_hz, bool quick) : step(1 / (200 * band_hz)), steps(quick ? 400 : 4000) {}
  double step;
  int steps;

  /// exp(-(t - t0)^2 / (2 d^2)), whose spectrum at f is exp(-(2 pi f d)^2 / 2) times that at 0.
  double at(int k) const {
    const double width = std::sqrt(2 * std::log(1e12)) / (2 * std::numbers::pi) * 200;  // [steps]
    return std::exp(-std::pow(k / width - 8, 2) / 2);
  }
  Excitation on(Index inputs) const {
    std::vector<double> times;
    MatrixXd u(inputs, steps + 1);
    for (int k = 0; k <= steps; ++k) {
      times.push_back(k * step);
      u.col(k).setConstant(at(k));
    }
    return Excitation::recorded(std::move(times), std::move(u));
  }
};

}  // namespace

System in_its_place(const ReducedSystem& small, const Diagram& asked) {
  const StateSpace m = small.state_space();
  Diagram d{"small"};
  auto model = d.add("model", Lti{.A = m.A, .B = m.B, .C = m.C, .D = m.D});
  const MatrixXd in = MatrixXd::Identity(m.B.cols(), m.B.cols()),
                 out = MatrixXd::Identity(m.C.rows(), m.C.rows());
  Expr all;
  Index first = 0;
  for (const Input& i : asked.graph().inputs) {
    all = all + MatrixXd(in.middleCols(first, i.size)) * d.input(i.name, i.size);
    first += i.size;
  }
  model.in = all;
  first = 0;
  for (const Output& o : asked.graph().outputs) {
    d.output(o.name, o.size) = MatrixXd(out.middleRows(first, o.size)) * model.out;
    first += o.size;
  }
  return compile(d);
}

Run run(const System& system, double band_hz, bool quick) {
  const Record record(band_hz, quick);
  const Excitation excitation = record.on(static_cast<Index>(system.inputs().size()));
  Run best{HUGE_VAL, HUGE_VAL, {}};
  // The stepper with the lower cost per step; its error is measured here.
  const Stepper stepper = system.order() <= 200 ? Stepper::exact : Stepper::midpoint;
  const auto least = [&](double& seconds, int steps) {
    const double start = processor_seconds();
    best.trajectory =
        simulate(system, excitation,
                 {.step = record.step, .until = steps * record.step, .stepper = stepper});
    seconds = std::min(seconds, processor_seconds() - start);
  };
  for (int k = 0; k < (quick ? 1 : 3); ++k) {
    least(best.start, 0);
    least(best.seconds, record.steps);
  }
  return best;
}

MatrixXd by_midpoint(const StateSpace& m, double band_hz, bool quick) {
  const Record record(band_hz, quick);
  const double s = 2 / record.step;
  const MatrixXd I = MatrixXd::Identity(m.A.rows(), m.A.cols());
  const MatrixXd resolvent = (s * I - m.A).partialPivLu().inverse();
  const MatrixXd next = 2 * s * resolvent - I;  // x1 = 2 xm - x, (s - A) xm = s x + B um
  const VectorXd forced = 2 * resolvent * m.B.rowwise().sum(), direct = m.D.rowwise().sum();
  VectorXd x = VectorXd::Zero(m.A.rows());
  MatrixXd y(m.C.rows(), record.steps + 1);
  for (int k = 0; k <= record.steps; ++k) {
    y.col(k) = m.C * x + direct * record.at(k);
    x = (next * x + forced * ((record.at(k) + record.at(k + 1)) / 2)).eval();
  }
  return y;
}

double difference(const MatrixXd& one, const MatrixXd& other) {
  const VectorXd size = other.cwiseAbs().rowwise().maxCoeff();
  return (one - other).cwiseAbs().rowwise().maxCoeff().cwiseQuotient(size).maxCoeff();
}

}  // namespace titop_bench
