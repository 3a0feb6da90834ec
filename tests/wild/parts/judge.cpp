#include "wild/parts/judge.hpp"

#include <fmt/format.h>

#include <Eigen/LU>
#include <cmath>
#include <functional>
#include <numbers>
#include <titop/titop.hpp>

#include "support/rng.hpp"
#include "wild/oracle/beam.hpp"
#include "wild/oracle/model.hpp"
#include "wild/parts/write.hpp"

namespace wild {

using Eigen::Index;
using Eigen::MatrixXcd;
using titop::Error;
using titop::System;

std::string_view to_string(Verdict verdict) {
  constexpr std::string_view names[] = {"right",          "refused rightly",  "refused falsely",
                                        "wrong but said", "wrong in silence", "not judged"};
  return names[static_cast<std::size_t>(verdict)];
}

std::vector<Complex> points_of(const Scene& scene, unsigned seed) {
  titop_test::Rng rng(seed);
  std::vector<Complex> s;
  for (int i = 0; i < 3; ++i) {
    const double size = scene.omega * std::exp2(rng.between(-2, 2));
    const double angle = i == 0 ? std::numbers::pi / 2 : rng.between(-1.5, 1.5);
    s.push_back(i == 0 ? Complex(0, size) : std::polar(size, angle));
  }
  return s;
}

namespace {

constexpr double kRight = 1e-8;     ///< required accuracy of a block of the transfer
constexpr double kData = 1e-15;     ///< the change of data that is tried
constexpr double kRounding = 100;   ///< errors worth so many such changes are the scene's own
constexpr double kNothing = 1e-13;  ///< a block that rounding alone fills
/// Of the largest block: the square of the 50 digits' rounding, which may fill a block that is 0.
constexpr double kSquared = 1e-90;

struct Blocks {
  MatrixXd size, allowed;
  std::vector<int> rows, cols;
};

/// Largest entry of |a - b| per block, over all points.
MatrixXd largest(const std::vector<MatrixXcd>& a, const std::vector<MatrixXcd>* b,
                 const std::vector<int>& rows, const std::vector<int>& cols) {
  MatrixXd size = MatrixXd::Zero(static_cast<Index>(rows.size()), static_cast<Index>(cols.size()));
  for (std::size_t k = 0; k < a.size(); ++k) {
    const MatrixXcd off = b ? MatrixXcd(a[k] - (*b)[k]) : a[k];
    for (Index i = 0, r = 0; i < size.rows(); r += rows[static_cast<std::size_t>(i++)])
      for (Index j = 0, c = 0; j < size.cols(); c += cols[static_cast<std::size_t>(j++)]) {
        const double entry =
            off.block(r, c, rows[static_cast<std::size_t>(i)], cols[static_cast<std::size_t>(j)])
                .cwiseAbs()
                .maxCoeff();
        size(i, j) = entry <= size(i, j) ? size(i, j) : entry;  // nan stays
      }
  }
  return size;
}

/// Allowed error per block: 1e-8 of it, or the effect of the data's last digits; blocks that are
/// exact zeros against their row and column.
Blocks blocks_of(const Scene& scene, const std::vector<MatrixXcd>& exact, const MatrixXd& moved) {
  Blocks b{.size = {}, .allowed = {}, .rows = output_blocks(scene), .cols = input_blocks(scene)};
  b.size = largest(exact, nullptr, b.rows, b.cols);
  b.allowed = b.size;
  // The change by rounding is about as large as rounding itself: one sample is right within a
  // factor of 1e4.
  const double least = kSquared * b.size.maxCoeff();
  const MatrixXd real =
      (moved.array() < 1e-4 * b.size.array() && b.size.array() > least).select(b.size, 0.0);
  const double all = real.maxCoeff();
  for (Index i = 0; i < b.size.rows(); ++i)
    for (Index j = 0; j < b.size.cols(); ++j) {
      const auto or_all = [&](double x) { return x > 0 ? x : all > 0 ? all : 1; };
      const double mean =
          std::sqrt(or_all(real.row(i).maxCoeff())) * std::sqrt(or_all(real.col(j).maxCoeff()));
      const bool zero = b.size(i, j) < kNothing * mean && real(i, j) == 0;
      b.allowed(i, j) = std::max(kRight * (zero ? mean : b.size(i, j)), kRounding * moved(i, j));
    }
  return b;
}

/// Warnings of the default certificate and the log that would make a user doubt; those of the data
/// (a soft material) say nothing of digits.
std::string said(const System& system) {
  std::string text;
  // Apply column by column is a model in double, too.
  for (const auto& notes : {system.notes(), system.dense_notes()})
    for (const titop::Note& note : notes)
      if (note.kind == titop::Note::Kind::warning && note.pass != "check")
        text += note.pass + ": " + note.text + "; ";
  const titop::Certificate c = system.dense_certificate();
  if (!(c.residual <= 1e-8)) text += fmt::format("residual {:.1e}; ", c.residual);
  if (!(c.dense_against_factors <= 1e-8))
    text += fmt::format("dense against factors {:.1e}; ", c.dense_against_factors);
  if (!(c.dense_error <= 1e-9)) text += fmt::format("dense error {:.1e}; ", c.dense_error);
  if (!(c.dense_error_where_small <= 1e-8))
    text += fmt::format("below the modes {:.1e}; ", c.dense_error_where_small);
  return text;
}

/// A transfer, and the effect of the last digits of its matrices.
struct Got {
  std::vector<MatrixXcd> H;
  std::vector<MatrixXcd> rounding = {};
};

Got of_model(const titop::StateSpace& m, const std::vector<Complex>& s, Digits digits) {
  const ModelTransfer t = model_transfer(m.A, m.B, m.C, m.D, s, kData, digits);
  Got got{.H = t.H};
  for (const MatrixXd& size : t.rounding) got.rounding.push_back(size.cast<Complex>());
  return got;
}

/// A, B, C, D column by column through the factors.
titop::StateSpace through_apply(const System& system) {
  const Index n = system.order(), nu = static_cast<Index>(system.inputs().size());
  const auto ny = static_cast<Index>(system.outputs().size());
  titop::StateSpace m;
  m.A.resize(n, n), m.B.resize(n, nu), m.C.resize(ny, n), m.D.resize(ny, nu);
  for (Index j = 0; j < n + nu; ++j) {
    VectorXd x = VectorXd::Zero(n), u = VectorXd::Zero(nu);
    (j < n ? x(j) : u(j - n)) = 1;
    const System::Rates r = system.apply(x, u);
    (j < n ? m.A.col(j) : m.B.col(j - n)) = r.xdot;
    (j < n ? m.C.col(j) : m.D.col(j - n)) = r.y;
  }
  return m;
}

/// Positions and rates in a row are sums of stretches and of the base's motion: 1e-12 of the
/// largest term is allowed if these cancel. Returns the largest position of any mass, per column.
MatrixXd largest_position(Scene scene, const std::vector<Complex>& s, Digits digits) {
  scene.outputs.clear();
  for (int i = 0; i < static_cast<int>(scene.nodes.size()); ++i)
    for (const int site : {-1, 0})
      if (one_axis(scene, {i, site}))
        scene.outputs.push_back({.measured = Reading::Measured::position, .at = {i, site}});
  if (scene.outputs.empty())
    return MatrixXd::Zero(1, static_cast<Index>(input_blocks(scene).size()));
  const MatrixXd all =
      largest(truth(scene, s, digits).H, nullptr, output_blocks(scene), input_blocks(scene));
  return all.colwise().maxCoeff();
}

/// The error that this allows, blocks as those of the transfer.
MatrixXd cancelled(const Scene& scene, const std::vector<Complex>& s, Digits digits) {
  const MatrixXd position = largest_position(scene, s, digits);
  double fastest = 0;
  for (const Complex& point : s) fastest = std::max(fastest, std::abs(point));
  std::vector<double> factor;
  for (const Reading& r : scene.outputs) {
    const double f = r.measured == Reading::Measured::position ? 1
                     : r.measured == Reading::Measured::rate   ? fastest
                                                               : 0;
    Scene one = scene;
    one.outputs = {r};
    factor.insert(factor.end(), output_blocks(one).size(), f);
  }
  MatrixXd allowed(static_cast<Index>(factor.size()), position.cols());
  for (Index i = 0; i < allowed.rows(); ++i)
    allowed.row(i) = 1e-12 * factor[static_cast<std::size_t>(i)] * position.row(0);
  return allowed;
}

struct Road {
  std::string name;
  std::function<Got()> transfer;
};

std::string codes(const Error& e) {
  std::string text;
  for (const titop::Mistake& m : e.mistakes())
    text += fmt::format("{}: {}; ", titop::to_string(m.code), m.message);
  return text;
}

/// True if the transfer grows with s, so that it needs derivatives of inputs.
bool improper(const Scene& scene) {
  double fastest = scene.omega;
  for (const Node& n : scene.nodes) {
    if (n.omega.size() > 0) fastest = std::max(fastest, n.omega.maxCoeff());
    if (n.beam) fastest = std::max(fastest, beam_model(*n.beam).fastest);
    if (n.A.size() > 0) fastest = std::max(fastest, n.A.cwiseAbs().maxCoeff());
    fastest = std::max({fastest, std::sqrt(n.k / n.m), n.c / n.m});
    if (n.kind == Node::Kind::bushing)  // on the smallest body, of 2^-4 kg and 2^-8 kg m^2
      fastest =
          std::max({fastest, std::sqrt(n.stiffness.maxCoeff() * 256), n.damping.maxCoeff() * 256});
  }
  const Truth t =
      truth(scene, {Complex(fastest * 1e6, fastest * 1e6), Complex(fastest * 1e8, fastest * 1e8)},
            Digits::fifty);
  if (t.H.empty()) return false;
  return ((t.H[1].cwiseAbs() - 10 * t.H[0].cwiseAbs()).array() > 1e-12 * t.H[1].norm()).any();
}

void refuse(Judgement& j, const Scene& scene, const Error& e, const std::string& road) {
  j.road = road;
  j.text = codes(e);
  const bool rightly = e.has(titop::Code::improper) && improper(scene);
  j.verdict = rightly ? Verdict::refused_rightly : Verdict::refused_falsely;
}

/// True if input 0 reaches these outputs by rounding only, of terms as large as those of the other
/// inputs of its block.
bool nothing_from_first(const std::vector<MatrixXcd>& exact, Index row, Index rows, Index cols) {
  double first = 0, all = 0;
  for (const MatrixXcd& H : exact) {
    first = std::max(first, H.col(0).segment(row, rows).cwiseAbs().maxCoeff());
    all = std::max(all, H.block(row, 0, rows, cols).cwiseAbs().maxCoeff());
  }
  return first < kNothing * all;
}

/// Steps by `simulate` against the inverse Laplace transform, in allowed errors.
double time_error(const Scene& scene, const std::vector<MatrixXcd>& transfer, const System& system,
                  double fastest) {
  const double t = 4 / fastest;
  const auto nu = static_cast<Index>(system.inputs().size());
  const VectorXd exact = step_response(scene, 0, t);
  const titop::Trajectory run =
      titop::simulate(system, titop::Excitation::step(VectorXd::Unit(nu, 0)),
                      {.step = t / 8, .until = t, .stepper = titop::Stepper::exact});
  const VectorXd last = run.y.col(run.y.cols() - 1);
  double worst = 0;
  Index row = 0;
  for (const int size : output_blocks(scene)) {
    const auto block = exact.segment(row, size);
    if (block.allFinite() && !nothing_from_first(transfer, row, size, input_blocks(scene)[0]) &&
        block.cwiseAbs().maxCoeff() > 1e-9 * exact.cwiseAbs().maxCoeff())
      worst = std::max(worst, (last.segment(row, size) - block).cwiseAbs().maxCoeff() /
                                  block.cwiseAbs().maxCoeff());
    row += size;
  }
  return worst / 1e-7;
}

/// A scene with its true transfers, and the errors that are allowed beside them.
struct JudgedScene {
  const Scene& scene;
  Digits digits;
  Truth exact;
  Blocks blocks;
};

/// Allowed errors: the change of the transfer by the digits of the data. False if they are as large
/// as the transfer itself. One that is 0 everywhere, as of a rigid body on the ground, is compared
/// with 1: masses and lengths are about 1.
bool find_allowed(JudgedScene& c, unsigned seed, Judgement& j) {
  const auto rows = output_blocks(c.scene), cols = input_blocks(c.scene);
  const Truth off = truth(disturbed(c.scene, kData, seed + 1), j.s, c.digits);
  const MatrixXd moved = off.H.empty()
                             ? MatrixXd::Constant(static_cast<Index>(rows.size()),
                                                  static_cast<Index>(cols.size()), HUGE_VAL)
                             : largest(off.H, &c.exact.H, rows, cols);
  Blocks& b = c.blocks = blocks_of(c.scene, c.exact.H, moved);
  const double size = b.size.maxCoeff();
  j.text = fmt::format("allowed {:.1e} beside {:.1e}", b.allowed.maxCoeff(), size);
  return (b.allowed.array() <= 1e-4 * (size < kNothing ? 1 : size)).all();
}

std::vector<Road> roads_of(const System& system, const std::vector<Complex>& points,
                           Digits digits) {
  return {{"transfer",
           [&system, &points] {
             Got got;
             for (const Complex& s : points) got.H.push_back(system.transfer(s));
             return got;
           }},
          {"apply",
           [&system, &points, digits] { return of_model(through_apply(system), points, digits); }},
          {"dense",
           [&system, &points, digits] { return of_model(system.state_space(), points, digits); }}};
}

/// Takes the largest error of a road beside the allowed one, if it is larger than j.error, and its
/// place.
void compare(const JudgedScene& c, const Road& road, Judgement& j, std::string& place) {
  const Blocks& b = c.blocks;
  const Got got = road.transfer();
  const MatrixXd error = largest(got.H, &c.exact.H, b.rows, b.cols);
  MatrixXd allowed = b.allowed;
  if (!got.rounding.empty()) allowed += largest(got.rounding, nullptr, b.rows, b.cols);
  if ((error.array() > allowed.array()).any()) allowed += cancelled(c.scene, j.s, c.digits);
  for (Index r = 0; r < error.rows(); ++r)
    for (Index k = 0; k < error.cols(); ++k) {
      if (error(r, k) <= j.error * allowed(r, k)) continue;
      j.error = error(r, k) / allowed(r, k);
      j.road = road.name;
      place = fmt::format("block ({}, {}): off by {:.2e} of {:.2e}, allowed {:.1e}", r, k,
                          error(r, k), b.size(r, k), allowed(r, k));
    }
}

/// Likewise for a simulated step.
void compare_in_time(const JudgedScene& c, const System& system, Judgement& j, std::string& place) {
  const MatrixXd A = system.state_space().A;
  const double fastest = std::max(A.size() > 0 ? A.eigenvalues().cwiseAbs().maxCoeff() : 1.0, 1e-3);
  const double e = time_error(c.scene, c.exact.H, system, fastest);
  if (e > 1) j.error = e, j.road = "simulate", place = fmt::format("off by {:.1e}", e * 1e-7);
}

Judgement judge_in(Digits digits, const Scene& scene, unsigned seed, bool with_time) {
  Judgement j;
  j.s = points_of(scene, seed);
  JudgedScene c{scene, digits, truth(scene, j.s, digits), {}};
  const bool exists = c.exact.none.empty();
  if (exists && !find_allowed(c, seed, j)) {
    j.verdict = Verdict::not_judged;
    return j;
  }
  std::optional<System> system;
  try {
    system.emplace(titop::compile(diagram_of(scene)));
  } catch (const Error& e) {
    refuse(j, scene, e, "compile");
    if (!exists) j.verdict = Verdict::refused_rightly;
    return j;
  }
  if (!exists) {
    j.verdict = Verdict::not_judged;
    j.text = c.exact.none;
    return j;
  }
  std::string road, place;
  try {
    for (const Road& r : roads_of(*system, j.s, digits)) {
      road = r.name;
      compare(c, r, j, place);
      if (!(j.error <= 1)) break;
    }
    road = "simulate";
    if (j.error <= 1 && with_time && !scene.inputs.empty()) compare_in_time(c, *system, j, place);
  } catch (const Error& e) {
    refuse(j, scene, e, road);
    return j;
  }
  if (j.error <= 1) return j;
  const std::string doubt = said(*system);
  j.verdict = doubt.empty() ? Verdict::wrong_in_silence : Verdict::wrong_but_said;
  j.text = place + (doubt.empty() ? "" : "; said: " + doubt);
  return j;
}

}  // namespace

Judgement judge(const Scene& scene, unsigned seed, bool with_time) {
  // Long double may have lost the digits, of the truth or of a model's transfer.
  try {
    const Judgement j = judge_in(Digits::wide, scene, seed, with_time);
    if (j.verdict != Verdict::wrong_in_silence && j.verdict != Verdict::wrong_but_said) return j;
  } catch (const std::domain_error&) {
  }
  return judge_in(Digits::fifty, scene, seed, with_time);
}

}  // namespace wild
