#pragma once

/// The source of the generated test, with @KEYS@ for the parts that differ from model to model.
namespace titop::emit {

inline constexpr const char* kHead = R"(// Written by titop from the diagram @DIAGRAM@; do not edit.
// Proves @NAME@.hpp: its matrices are recovered by calling it, and compared with numbers that do not
// come from them. A program by itself; with TITOP_TEST_WITHOUT_MAIN part of another.
#include "@NAME@.hpp"

#ifndef TITOP_TEST_WITHOUT_MAIN
#define DOCTEST_CONFIG_IMPLEMENT_WITH_MAIN
#endif
#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <complex>
#include <cstddef>
#include <utility>
#include <vector>

// Of its own, so that no name here meets the model's.
namespace @NAME@_proof {

namespace model = ::@NAME@;

namespace {

using Complex = std::complex<double>;
using Columns = std::vector<std::vector<double>>;

/// f of every unit vector: the columns of a linear function's matrix.
template <class Vector, class Function>
Columns columns(Function f) {
  Columns result;
  Vector v{};
  for (double& entry : v) {
    entry = 1;
    const auto column = f(v);
    result.emplace_back(column.begin(), column.end());
    entry = 0;
  }
  return result;
}

const Columns A = columns<model::State>([](auto& x) { return model::derivative(x, {}); });
const Columns B = columns<model::Input>([](auto& u) { return model::derivative({}, u); });
const Columns C = columns<model::State>([](auto& x) { return model::output(x, {}); });
const Columns D = columns<model::Input>([](auto& u) { return model::output({}, u); });

/// s - A, factored with partial pivoting on scaled rows.
class LuResolvent {
 public:
  explicit LuResolvent(Complex s)
      : s_(s), lu_(A.size(), std::vector<Complex>(A.size())), row_(A.size()) {
    const std::size_t n = A.size();
    for (std::size_t i = 0; i < n; ++i) {
      row_[i] = i;
      for (std::size_t j = 0; j < n; ++j) lu_[i][j] = (i == j ? s : 0.0) - A[j][i];
      double largest = 0;
      for (const Complex& entry : lu_[i]) largest = std::max(largest, std::abs(entry));
      scale_.push_back(largest > 0 ? 1 / largest : 1);
    }
    for (std::size_t k = 0; k < n; ++k) eliminate(k);
  }
  std::vector<Complex> solve(const std::vector<Complex>& b) const {
    const std::size_t n = b.size();
    std::vector<Complex> x(n);
    for (std::size_t i = 0; i < n; ++i) {
      x[i] = b[row_[i]];
      for (std::size_t j = 0; j < i; ++j) x[i] -= lu_[i][j] * x[j];
    }
    for (std::size_t i = n; i-- > 0;) {
      for (std::size_t j = i + 1; j < n; ++j) x[i] -= lu_[i][j] * x[j];
      x[i] /= lu_[i][i];
    }
    return x;
  }
  /// The same, and a step of refinement.
  std::vector<Complex> refined(const std::vector<Complex>& b) const {
    std::vector<Complex> x = solve(b), rest = b;
    for (std::size_t j = 0; j < x.size(); ++j) {
      rest[j] -= s_ * x[j];
      for (std::size_t i = 0; i < x.size(); ++i) rest[i] += A[j][i] * x[j];
    }
    const std::vector<Complex> more = solve(rest);
    for (std::size_t i = 0; i < x.size(); ++i) x[i] += more[i];
    return x;
  }

 private:
  void eliminate(std::size_t k) {
    std::size_t pivot = k;
    for (std::size_t i = k; i < lu_.size(); ++i)
      if (scale_[i] * std::abs(lu_[i][k]) > scale_[pivot] * std::abs(lu_[pivot][k])) pivot = i;
    std::swap(lu_[k], lu_[pivot]);
    std::swap(row_[k], row_[pivot]);
    std::swap(scale_[k], scale_[pivot]);
    for (std::size_t i = k + 1; i < lu_.size(); ++i) {
      if (lu_[i][k] == 0.0) continue;
      lu_[i][k] /= lu_[k][k];
      for (std::size_t j = k + 1; j < lu_.size(); ++j) lu_[i][j] -= lu_[i][k] * lu_[k][j];
    }
  }

  Complex s_;
  std::vector<std::vector<Complex>> lu_;
  std::vector<std::size_t> row_;
  std::vector<double> scale_;
};

}  // namespace

TEST_CASE("@NAME@: size") {
  CHECK(A.size() == @N@);
  CHECK(B.size() == @NU@);
  CHECK(model::output({}, {}).size() == @NY@);
}
)";

inline constexpr const char* kResponse = R"(
namespace {

using Indices = std::vector<std::size_t>;

/// Rows and columns of the transfer that are 0 up to rounding: not compared.
const Indices silent_outputs = @SILENT_OUTPUTS@;
const Indices silent_inputs = @SILENT_INPUTS@;
[[maybe_unused]] bool contains(const Indices& list, std::size_t i) {
  return std::find(list.begin(), list.end(), i) != list.end();
}

/// Column j of C (s - A)^-1 B + D, and of the terms that it is the sum of.
struct ResponseColumn {
  std::vector<Complex> value;
  std::vector<double> terms;
};
ResponseColumn response(const LuResolvent& resolvent, std::size_t j) {
  const std::vector<Complex> x = resolvent.refined({B[j].begin(), B[j].end()});
  ResponseColumn r{{D[j].begin(), D[j].end()}, {}};
  for (std::size_t i = 0; i < D[j].size(); ++i) {
    r.terms.push_back(std::abs(D[j][i]));
    for (std::size_t k = 0; k < x.size(); ++k) {
      r.value[i] += C[k][i] * x[k];
      r.terms[i] += std::abs(C[k][i] * x[k]);
    }
  }
  return r;
}

/// Worst entry against `expected`, outputs x inputs by columns: relative to the geometric mean of
/// the largest entries of its row and column, or to 1e-6 of the terms that cancel in it.
[[maybe_unused]] double transfer_error(Complex s, const double (*expected)[2],
                                       const Indices& no_outputs = silent_outputs,
                                       const Indices& no_inputs = silent_inputs) {
  const LuResolvent resolvent(s);
  const std::size_t nu = D.size(), ny = D[0].size();
  std::vector<double> row(ny), column(nu);
  const auto exact = [&](std::size_t i, std::size_t j) {
    return Complex(expected[j * ny + i][0], expected[j * ny + i][1]);
  };
  for (std::size_t j = 0; j < nu; ++j)
    for (std::size_t i = 0; i < ny; ++i) {
      row[i] = std::max(row[i], std::abs(exact(i, j)));
      column[j] = std::max(column[j], std::abs(exact(i, j)));
    }
  double worst = 0;
  for (std::size_t j = 0; j < nu; ++j) {
    if (contains(no_inputs, j)) continue;
    const ResponseColumn found = response(resolvent, j);
    for (std::size_t i = 0; i < ny; ++i) {
      if (contains(no_outputs, i)) continue;
      const double off = std::abs(found.value[i] - exact(i, j));
      const double size = std::max(std::sqrt(row[i]) * std::sqrt(column[j]), 1e-6 * found.terms[i]);
      if (!(off <= 0)) worst = std::isfinite(off) ? std::max(worst, off / size) : HUGE_VAL;
    }
  }
  return worst;
}

}  // namespace
)";

inline constexpr const char* kTransfer = R"(
// Of the factored system, in which no A, B, C, D were formed.
TEST_CASE("@NAME@: transfer") {
  const double tolerance = @TOLERANCE@;
@CHECKS@}
)";

inline constexpr const char* kPoles = R"(
namespace {

struct ExpectedPole {
  double re, im;  // im > 0 stands for the conjugate as well
};
const ExpectedPole poles[] = @POLES@;

/// The eigenvalue of A next to p, by inverse iteration.
Complex eigenvalue_near(Complex p) {
  const Complex shift = p + 1e-10 * std::abs(p) * Complex(0.6, 0.8);
  const LuResolvent resolvent(shift);
  std::vector<Complex> x(A.size());
  for (std::size_t i = 0; i < x.size(); ++i) x[i] = 1 + 0.1 * static_cast<double>(i * i % 7);
  Complex found;
  for (int step = 0; step < 6; ++step) {
    const std::vector<Complex> y = resolvent.solve(x);
    std::size_t at = 0;
    for (std::size_t i = 0; i < y.size(); ++i)
      if (std::abs(y[i]) > std::abs(y[at])) at = i;
    found = shift - x[at] / y[at];
    for (std::size_t i = 0; i < y.size(); ++i) x[i] = y[i] / y[at];
  }
  return found;
}

}  // namespace

TEST_CASE("@NAME@: poles") {
  Complex sum = 0;
  double size = 0, trace = 0;
  std::size_t count = 0;
  for (const ExpectedPole& p : poles) {
    count += p.im > 0 ? 2 : 1;
    sum += p.im > 0 ? Complex(2 * p.re) : Complex(p.re, p.im);
    size += std::hypot(p.re, p.im);
  }
  for (std::size_t i = 0; i < A.size(); ++i) trace += A[i][i];
  CHECK(count == A.size());
  CHECK(std::abs(trace - sum) <= 1e-10 * size);
  for (const std::size_t k : std::vector<std::size_t>@WHICH@) {
    const Complex p(poles[k].re, poles[k].im);
    INFO("pole ", p.real(), " ", p.imag());
    CHECK(std::abs(eigenvalue_near(p) - p) <= @TOLERANCE@ * std::abs(p));
  }
}
)";

inline constexpr const char* kStaticGain = R"(
TEST_CASE("@NAME@: static gain") {
  static const double expected[][2] = @VALUES@;
  // Not compared: outputs that are 0 at rest, such as rates.
  const Indices outputs = @SILENT_OUTPUTS@;
  const Indices inputs = @SILENT_INPUTS@;
  CHECK(transfer_error(0, expected, outputs, inputs) <= @TOLERANCE@);
}
)";

inline constexpr const char* kTrajectory = R"(
namespace {

/// Numbers from -1 to 1 without rounding.
model::Input input_at(std::size_t k) {
  model::Input u{};
  std::size_t j = 0;
  for (double& entry : u)
    entry = (static_cast<double>((7 * k * k + 37 * k + 101 * j++) % 17) - 8) / 8;
  return u;
}

/// Largest |C| |x| + |D| |u| of each output so far.
void grow(std::vector<double>& size, const model::State& x, const model::Input& u) {
  for (std::size_t i = 0; i < size.size(); ++i) {
    double terms = 0;
    for (std::size_t k = 0; k < C.size(); ++k) terms += std::abs(C[k][i] * x[k]);
    for (std::size_t j = 0; j < D.size(); ++j) terms += std::abs(D[j][i] * u[j]);
    size[i] = std::max(size[i], terms);
  }
}

}  // namespace

// In long double, from the model's own states.
TEST_CASE("@NAME@: trajectory") {
  static const double expected[][@NY@] = @VALUES@;
  std::vector<double> off(@NY@), size(@NY@);
  model::State x{};
  for (std::size_t k = 0; k < @STEPS@; ++k) {
    const model::Input u = input_at(k);
    const model::Output y = model::output(x, u);
    for (std::size_t i = 0; i < off.size(); ++i)
      off[i] = std::max(off[i], std::abs(y[i] - expected[k][i]));
    grow(size, x, u);
    x = model::step(x, u);
  }
  for (std::size_t i = 0; i < off.size(); ++i) {
    if (contains(silent_outputs, i)) continue;
    INFO(model::output_names[i]);
    CHECK(off[i] <= @TOLERANCE@ * size[i]);
  }
}
)";

inline constexpr const char* kTaylor = R"(
namespace {

/// exp(A h) x + integral: @SUBSTEPS@ parts of the step, 24 terms of Taylor's series each.
model::State step_by_series(model::State x, const model::Input& u) {
  for (int part = 0; part < @SUBSTEPS@; ++part) {
    model::State term = model::derivative(x, u);
    for (int power = 1; power <= 24; ++power) {
      for (std::size_t i = 0; i < term.size(); ++i) {
        term[i] *= model::sample_time / @SUBSTEPS@ / power;
        x[i] += term[i];
      }
      term = model::derivative(term, {});
    }
  }
  return x;
}

}  // namespace

// The last steps of the trajectory: all states have come into motion.
TEST_CASE("@NAME@: step against derivative") {
  std::vector<double> off(@NY@), size(@NY@);
  model::State x{};
  for (std::size_t k = 0; k < @STEPS@; ++k) {
    const model::Input u = input_at(k);
    const model::State before = x;
    x = model::step(x, u);
    grow(size, x, {});
    if (k + 3 < @STEPS@) continue;
    const model::Output y = model::output(x, {});
    const model::Output by_series = model::output(step_by_series(before, u), {});
    for (std::size_t i = 0; i < off.size(); ++i)
      off[i] = std::max(off[i], std::abs(y[i] - by_series[i]));
  }
  for (std::size_t i = 0; i < off.size(); ++i) {
    if (contains(silent_outputs, i)) continue;
    INFO(model::output_names[i]);
    CHECK(off[i] <= @TOLERANCE@ * size[i]);
  }
}
)";

inline constexpr const char* kEnd = R"(
}  // namespace @NAME@_proof
)";

}  // namespace titop::emit
