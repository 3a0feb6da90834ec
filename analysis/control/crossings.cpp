#include <algorithm>
#include <boost/math/tools/toms748_solve.hpp>
#include <cmath>
#include <functional>
#include <limits>
#include <titop/analysis/control/crossings.hpp>
#include <titop/analysis/control/zeros.hpp>
#include <titop/graph/linalg/rounding.hpp>

namespace titop::detail {
namespace {

using Complex = std::complex<double>;
using Eigen::Index;
using Eigen::MatrixXd;
using Function = std::function<double(double)>;

constexpr int kBits = 50;  ///< of a frequency: all but three

/// f, which is at most 1, is smaller at a root that is known to kBits, and not at a jump.
constexpr double kRoot = 1e-3;

void add(std::vector<Complex>& list, const Eigen::VectorXcd& more) {
  list.insert(list.end(), more.begin(), more.end());
}

/// L(s) L(-s) - 1, with the states of L and of its mirror image.
StateSpace unit_circle(const StateSpace& L) {
  const Index n = L.A.rows();
  StateSpace f;
  f.A = MatrixXd::Zero(2 * n, 2 * n), f.B = MatrixXd(2 * n, 1), f.C = MatrixXd(1, 2 * n);
  f.A << L.A, MatrixXd::Zero(n, n), L.B * L.C, -L.A;
  f.B << L.B, L.B * L.D;
  f.C << L.D * L.C, -L.C;
  f.D = L.D * L.D - MatrixXd::Ones(1, 1);
  return f;
}

/// L(s) - L(-s): 2 j Im L on the axis.
StateSpace real_axis(const StateSpace& L) {
  const Index n = L.A.rows();
  StateSpace f;
  f.A = MatrixXd::Zero(2 * n, 2 * n), f.B = MatrixXd(2 * n, 1), f.C = MatrixXd(1, 2 * n);
  f.A.topLeftCorner(n, n) = L.A, f.A.bottomRightCorner(n, n) = -L.A;
  f.B << L.B, L.B;
  f.C << L.C, L.C;
  f.D = MatrixXd::Zero(1, 1);
  return f;
}

/// Roots of f between neighbours of the list by its changes of sign; jumps (poles on the axis) are
/// none, nor are intervals in which f is 0. A candidate at which f is 0 to half the digits, without
/// a change of sign near it, is a root, too: there the curve touches, and the candidate is double.
std::vector<double> roots_of(const Function& f, const std::vector<double>& list,
                             const std::vector<Complex>& candidates) {
  std::vector<double> roots;
  double last = list.front(), at_last = f(last);
  for (const double omega : list) {
    const double value = f(omega);
    if (value == 0) continue;
    if (value * at_last < 0) {
      std::uintmax_t steps = 200;
      const auto [a, b] = boost::math::tools::toms748_solve(
          f, last, omega, at_last, value, boost::math::tools::eps_tolerance<double>(kBits), steps);
      const double root = std::abs(f(a)) < std::abs(f(b)) ? a : b;
      if (std::abs(f(root)) < kRoot) roots.push_back(root);
    }
    last = omega, at_last = value;
  }
  for (const Complex& s : candidates) {
    const double omega = std::abs(s.imag());
    const bool found = std::any_of(roots.begin(), roots.end(), [&](double r) {
      return std::abs(r - omega) <= linalg::kDoubleRoot * omega;
    });
    if (omega > 0 && !found && std::abs(f(omega)) <= linalg::kHalfDigits) roots.push_back(omega);
  }
  std::sort(roots.begin(), roots.end());
  return roots;
}

/// Takes out candidates that are rounding of a double root of f at 0. `roots`: of L.
void drop_at_zero(std::vector<Complex>& candidates, const std::vector<Complex>& roots,
                  const Function& f) {
  if (!(std::abs(f(0)) <= linalg::kHalfDigits)) return;
  double slowest = 0;
  for (const Complex& s : roots)
    if (s != 0.0 && (slowest == 0 || std::abs(s) < slowest)) slowest = std::abs(s);
  std::erase_if(candidates,
                [&](const Complex& s) { return std::abs(s) < linalg::kDoubleRoot * slowest; });
}

/// Extends the list by factors of 10, up to where f has its sign at infinity, and down to where it
/// has its sign at 0: far beyond all poles and zeros a large gain falls, or rises, to 1. Not if f
/// is 0 to half the digits at that end.
void extend(std::vector<double>& list, const Function& f) {
  const auto beyond = [&](double end, double factor) {
    const double sign = f(end);
    double omega = factor > 1 ? list.back() : list.front();
    if (std::abs(sign) <= linalg::kHalfDigits) return;
    while (f(omega) * sign < 0 && std::isnormal(omega * factor)) list.push_back(omega *= factor);
    std::sort(list.begin(), list.end());
  };
  beyond(std::numeric_limits<double>::infinity(), 10);
  beyond(0, 0.1);
}

std::vector<Complex> roots_of_model(const StateSpace& L) {
  std::vector<Complex> roots = all_poles(L);
  add(roots, transmission_zeros(L));
  return roots;
}

}  // namespace

std::vector<LoopCrossing> unit_crossings(const StateSpace& L, const LoopResponse& response) {
  const Eigen::VectorXcd zeros = transmission_zeros(unit_circle(L));
  std::vector<Complex> candidates(zeros.begin(), zeros.end()), roots = roots_of_model(L);
  const Function f = [&](double omega) {
    const double size = std::abs(response.at(omega));
    return std::isfinite(size) ? (size * size - 1) / (size * size + 1) : 1;
  };
  drop_at_zero(candidates, roots, f);
  roots.insert(roots.end(), candidates.begin(), candidates.end());
  std::vector<LoopCrossing> result;
  std::vector<double> list = structured(roots, 0, 0);
  extend(list, f);
  for (const double omega : roots_of(f, list, candidates))
    result.push_back({omega, response.at(omega)});
  return result;
}

std::vector<LoopCrossing> negative_crossings(const StateSpace& L, const LoopResponse& response) {
  const bool delayed = response.delay() > 0;
  std::vector<Complex> candidates, roots = roots_of_model(L);
  if (!delayed) add(candidates, transmission_zeros(real_axis(L)));
  // The sine of the angle: no size, and no pole.
  const Function f = [&](double omega) {
    const Complex value = response.at(omega);
    return std::isfinite(std::abs(value)) && value != 0.0 ? value.imag() / std::abs(value) : 0.5;
  };
  drop_at_zero(candidates, roots, f);
  roots.insert(roots.end(), candidates.begin(), candidates.end());
  if (delayed)
    for (const LoopCrossing& c : unit_crossings(L, response)) roots.emplace_back(0, c.omega);
  const double end = delayed ? end_of_turns(response, roots) : 0;
  std::vector<LoopCrossing> result;
  const auto look = [&](double omega) {
    const Complex value = response.at(omega);
    if (std::isfinite(std::abs(value)) && value.real() < 0) result.push_back({omega, value});
  };
  if (std::find(roots.begin(), roots.end(), Complex(0)) == roots.end()) look(0);
  for (const double omega : roots_of(f, structured(roots, response.delay(), end), candidates))
    look(omega);
  if (!delayed) look(std::numeric_limits<double>::infinity());
  return result;
}

}  // namespace titop::detail
