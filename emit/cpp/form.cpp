#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <titop/analysis/simulation/hold.hpp>
#include <titop/compiler/realization/proportional.hpp>
#include <titop/compiler/system/transfer_part.hpp>
#include <titop/emit/cpp/form.hpp>
#include <titop/graph/linalg/dense.hpp>
#include <titop/graph/linalg/eigen.hpp>
#include <titop/graph/linalg/rounding.hpp>

namespace titop::emit {

using Eigen::Index;
using Eigen::MatrixXcd;
using Eigen::MatrixXd;
using MatrixXl = Eigen::Matrix<long double, Eigen::Dynamic, Eigen::Dynamic>;

namespace {

bool contains(const std::vector<Index>& list, Index i) {
  return std::find(list.begin(), list.end(), i) != list.end();
}

/// Error of C (s - A)^-1 B + D. HUGE_VAL if s - A is singular in double.
double difference_at(const ModelForm& form, std::complex<double> s, const MatrixXcd& exact,
                     const Points& points) {
  const Index n = form.A.rows();
  linalg::Solution solution{.z = MatrixXcd(n, form.B.cols()), .rcond = 1};
  if (n > 0)
    solution =
        linalg::solve(s * MatrixXcd::Identity(n, n) - form.A, form.B.cast<std::complex<double>>());
  return solution.rcond > 0 ? difference(form, solution.z, exact, points).worst : HUGE_VAL;
}

/// Zero rows, and rows of fewer than three digits: `off` is a thousandth of `exact` or more.
std::vector<Index> noisy_rows(const MatrixXd& exact, const MatrixXd& off) {
  std::vector<Index> rows;
  for (Index i = 0; i < exact.rows(); ++i)
    if (off.row(i).maxCoeff() >= linalg::kThreeDigits * exact.row(i).maxCoeff()) rows.push_back(i);
  return rows;
}

/// A in blocks on the diagonal, and the way there and back.
struct BlockDiagonalForm {
  MatrixXl A, to_states, from_states;
};

/// [q; qdot] = scale V [m; mdot] for the modes V of the symmetric form, pairs (m, mdot) one after
/// the other. None if there is no such form or damping couples its modes.
std::optional<BlockDiagonalForm> oscillators(const StateSpace& model) {
  const SecondOrder second = second_order(model);
  if (!second.found) return std::nullopt;
  const std::optional<ProportionalModes> found = proportional_modes(second);
  if (!found) return std::nullopt;
  const SymmetricModes& sym = found->undamped.modes;
  const Eigen::VectorXd scale = second.D.diagonal();  // diagonal without an energy
  const Index n = model.A.rows(), count = sym.lambda.size();
  BlockDiagonalForm modes{MatrixXl::Zero(n, n), MatrixXl::Zero(n, n), MatrixXl::Zero(n, n)};
  for (Index k = 0; k < count; ++k) {
    modes.A(2 * k, 2 * k + 1) = 1;
    modes.A(2 * k + 1, 2 * k) = -sym.lambda(k);
    modes.A(2 * k + 1, 2 * k + 1) = -found->z(k);
    for (Index i = 0; i < count; ++i) {
      const Index rows[] = {second.q[static_cast<std::size_t>(i)],
                            second.qdot[static_cast<std::size_t>(i)]};
      for (Index half = 0; half < 2; ++half) {
        modes.to_states(rows[half], 2 * k + half) = scale(i) * sym.V(i, k);
        modes.from_states(2 * k + half, rows[half]) = sym.V(i, k) / scale(i);
      }
    }
  }
  return modes;
}

using Long = std::complex<long double>;
constexpr long double kLongEpsilon = std::numeric_limits<long double>::epsilon();
using MatrixXcl = Eigen::Matrix<Long, Eigen::Dynamic, Eigen::Dynamic>;

/// SharpEigenvectors V of A, W = V^-1, and W A V on its diagonal.
struct SharpEigenvectors {
  MatrixXcl V, W;
  Eigen::Matrix<Long, Eigen::Dynamic, 1> values;
};

/// SharpEigenvectors of double, refined in long double: with R = W A V nearly diagonal, V (I + X)
/// with X_ij = R_ij / (R_jj - R_ii) is so to second order [Dongarra, Moler, Wilkinson 1983]. The
/// slow poles of a stiff model thus keep their digits.
SharpEigenvectors sharp_eigenvectors(const MatrixXd& A) {
  const linalg::Eigensystem coarse = linalg::eigensystem(A);
  const MatrixXd scaled = coarse.scale.cwiseInverse().asDiagonal() * A * coarse.scale.asDiagonal();
  SharpEigenvectors e;
  e.V = (coarse.scale.cwiseInverse().asDiagonal() * coarse.V).cast<Long>();
  for (int step = 0;; ++step) {
    e.W = Eigen::PartialPivLU<MatrixXcl>(e.V).inverse();
    const MatrixXcl R = e.W * (scaled.cast<Long>() * e.V);
    e.values = R.diagonal();
    if (step == 3) break;
    MatrixXcl X = MatrixXcl::Zero(A.rows(), A.rows());
    for (Index j = 0; j < A.rows(); ++j)
      for (Index i = 0; i < A.rows(); ++i)
        if (const Long gap = R(j, j) - R(i, i); i != j && std::abs(R(i, j)) < 0.1L * std::abs(gap))
          X(i, j) = R(i, j) / gap;
    e.V += (e.V * X).eval();
  }
  e.V = coarse.scale.cast<Long>().asDiagonal() * e.V;
  e.W = e.W * coarse.scale.cwiseInverse().cast<Long>().asDiagonal();
  return e;
}

/// A pair a +- bj of A as [[a, b], [-b, a]] on the real and imaginary part of its vector.
BlockDiagonalForm general_modes(const MatrixXd& A) {
  const SharpEigenvectors e = sharp_eigenvectors(A);
  const Index n = A.rows();
  BlockDiagonalForm modes{MatrixXl::Zero(n, n), MatrixXl::Zero(n, n), MatrixXl::Zero(n, n)};
  Index at = 0;
  for (Index k = 0; k < n && at < n; ++k) {
    const Long pole = e.values(k);
    const bool real = std::abs(pole.imag()) <= 100 * kLongEpsilon * std::abs(pole);
    if (!real && pole.imag() < 0) continue;
    modes.A(at, at) = pole.real();
    modes.to_states.col(at) = e.V.col(k).real();
    modes.from_states.row(at) = e.W.row(k).real();
    if (real || ++at == n) {
      ++at;
      continue;
    }
    modes.A(at, at) = pole.real();
    modes.A(at - 1, at) = pole.imag();
    modes.A(at, at - 1) = -pole.imag();
    modes.to_states.col(at) = e.V.col(k).imag();
    modes.from_states.row(at - 1) *= 2;
    modes.from_states.row(at) = -2 * e.W.row(k).imag();
    ++at;
  }
  return modes;
}

/// A row may be at rounding level at one point (a stiff row, far below its frequency) and not at
/// another: it is silent only if it is noise compared with its largest entry over all points.
/// Transfers in 50 digits are expensive, so the other points are evaluated only if rows are silent
/// at the first.
void find_silent(const System& system, Points& points) {
  MatrixXd size, off;
  const auto look_at = [&](std::complex<double> s) {
    const MatrixXcd exact = system.transfer(s, Precision::digits50);
    const MatrixXd now = (system.transfer(s, Precision::standard) - exact).cwiseAbs();
    size = size.size() ? MatrixXd(size.cwiseMax(exact.cwiseAbs())) : MatrixXd(exact.cwiseAbs());
    off = off.size() ? MatrixXd(off.cwiseMax(now)) : now;
    points.silent_outputs = noisy_rows(size, off);
    points.silent_inputs = noisy_rows(size.transpose(), off.transpose());
  };
  const std::size_t first = std::min<std::size_t>(2, points.s.size() - 1);
  look_at(points.s[first]);
  for (std::size_t i = 0; i < points.s.size(); ++i)
    if (i != first && !(points.silent_outputs.empty() && points.silent_inputs.empty()))
      look_at(points.s[i]);
}

}  // namespace

TransferDifference difference(const ModelForm& form, const MatrixXcd& X, const MatrixXcd& exact,
                              const Points& points) {
  constexpr double kTermRounding = 10 * linalg::kEpsilon;
  const MatrixXcd G = form.C * X + form.D;
  const MatrixXd terms = form.C.cwiseAbs() * X.cwiseAbs() + form.D.cwiseAbs();
  TransferDifference d;
  for (Index i = 0; i < exact.rows(); ++i)
    for (Index j = 0; j < exact.cols(); ++j) {
      if (contains(points.silent_outputs, i) || contains(points.silent_inputs, j)) continue;
      const double off = std::abs(G(i, j) - exact(i, j));
      const double size = std::max(std::sqrt(exact.row(i).cwiseAbs().maxCoeff()) *
                                       std::sqrt(exact.col(j).cwiseAbs().maxCoeff()),
                                   kOfCancelled * terms(i, j));
      if (!(off <= 0)) d.worst = std::max(d.worst, std::isfinite(off) ? off / size : HUGE_VAL);
      if (size > 0) d.rounding = std::max(d.rounding, kTermRounding * terms(i, j) / size);
    }
  return d;
}

double worst_output(const Eigen::VectorXd& off, const Eigen::VectorXd& size, const Points& points) {
  double worst = 0;
  for (Index i = 0; i < off.size(); ++i)
    if (!(off(i) <= 0) && !contains(points.silent_outputs, i))
      worst = std::max(worst, std::isfinite(off(i)) ? off(i) / size(i) : HUGE_VAL);
  return worst;
}

Points response_points(const System& system, const std::vector<Pole>& poles) {
  double low = HUGE_VAL, high = 0;
  for (const Pole& p : poles)
    if (p.omega > 0) low = std::min(low, p.omega), high = std::max(high, p.omega);
  if (high == 0) low = high = 1;
  constexpr int count = 8;
  Points points;
  for (int i = 0; i < count; ++i) {
    const double w = 0.3 * low * std::pow(9 * (high / low), double(i) / (count - 1));
    const std::complex<double> s(0.1 * w, w);
    // Far below the modes of a closed chain the factors may have no digit.
    const std::optional<MatrixXcd> exact =
        titop::detail::transfer_if_any(titop::detail::data_of(system), s);
    if (!exact) continue;
    points.s.push_back(s);
    points.exact.push_back(*exact);
  }
  if (!points.s.empty()) find_silent(system, points);
  return points;
}

double response_error(const ModelForm& form, const Points& points) {
  double worst = 0;
  for (std::size_t i = 0; i < points.s.size(); ++i)
    worst = std::max(worst, difference_at(form, points.s[i], points.exact[i], points));
  return worst;
}

Points at_rest(const Points& points, const MatrixXd& static_gain) {
  // So much smaller than near the slowest pole that it is the rounding of a 0.
  constexpr double kNothing = 1e-10;
  Points rest{{}, {}, points.silent_outputs, points.silent_inputs};
  const MatrixXd now = static_gain.cwiseAbs(), slow = points.exact[0].cwiseAbs();
  for (Index i = 0; i < now.rows(); ++i)
    if (now.row(i).maxCoeff() < kNothing * slow.row(i).maxCoeff()) rest.silent_outputs.push_back(i);
  for (Index j = 0; j < now.cols(); ++j)
    if (now.col(j).maxCoeff() < kNothing * slow.col(j).maxCoeff()) rest.silent_inputs.push_back(j);
  return rest;
}

double static_error(const ModelForm& form, const MatrixXd& exact, const Points& points) {
  return difference_at(form, 0, exact.cast<std::complex<double>>(), at_rest(points, exact));
}

double step_error(const ModelForm& form, const MatrixXd& inputs, const MatrixXd& exact,
                  const Points& points) {
  Eigen::VectorXd x = Eigen::VectorXd::Zero(form.A.rows());
  Eigen::VectorXd size = Eigen::VectorXd::Zero(exact.rows()), off = size;
  for (Index k = 0; k < inputs.cols(); ++k) {
    const Eigen::VectorXd u = inputs.col(k);
    off = off.cwiseMax((form.C * x + form.D * u - exact.col(k)).cwiseAbs());
    size = size.cwiseMax(form.C.cwiseAbs() * x.cwiseAbs() + form.D.cwiseAbs() * u.cwiseAbs());
    x = (form.A_h * x + form.B_h * u).eval();
  }
  return worst_output(off, size, points);
}

MatrixXd trajectory_inputs(Index inputs, Index steps) {
  MatrixXd u(inputs, steps);
  for (Index k = 0; k < steps; ++k)
    for (Index j = 0; j < inputs; ++j)
      u(j, k) = double((7 * k * k + 37 * k + 101 * j) % 17 - 8) / 8;
  return u;
}

ModelForm own_form(const StateSpace& model) {
  ModelForm form;
  form.A = model.A, form.B = model.B, form.C = model.C, form.D = model.D;
  return form;
}

ModelForm modal_form(const StateSpace& model) {
  std::optional<BlockDiagonalForm> modes = oscillators(model);
  if (!modes) modes = general_modes(model.A);
  ModelForm form;
  form.modal = true;
  form.A = modes->A.cast<double>();
  form.B = (modes->from_states * model.B.cast<long double>()).cast<double>();
  form.C = (model.C.cast<long double>() * modes->to_states).cast<double>();
  form.D = model.D;
  form.to_states = modes->to_states.cast<double>();
  form.from_states = modes->from_states.cast<double>();
  return form;
}

void add_hold(ModelForm& form, double h) {
  Hold all = hold(form.A, form.B, h);
  form.A_h = std::move(all.A), form.B_h = std::move(all.B);
}

}  // namespace titop::emit
