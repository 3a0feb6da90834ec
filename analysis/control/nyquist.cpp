#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>
#include <optional>
#include <titop/analysis/control/crossings.hpp>
#include <titop/analysis/control/feedback.hpp>
#include <titop/analysis/control/nyquist.hpp>
#include <titop/analysis/control/zeros.hpp>
#include <titop/graph/linalg/eigen.hpp>
#include <titop/graph/linalg/rounding.hpp>
#include <titop/graph/support/each_once.hpp>

namespace titop::detail {
namespace {

using Complex = std::complex<double>;
using Eigen::MatrixXcd;
using std::numbers::pi;

constexpr double kMostTurn = 0.5;     ///< [rad] of the determinant in half a step
constexpr double kFirstStep = 1e-12;  ///< of its modulus: beside a pole on the axis
constexpr double kEnd = 1e3;          ///< times the fastest pole: the determinant is near its limit
constexpr double kWhole = 0.1;        ///< of a turn: the sum of all is a whole number of them
constexpr int kHalvings = 40;
constexpr int kPointsAround = 16;  ///< of a circle around a pole on the axis
constexpr int kCircles = 60;       ///< tried, each a fourth of the one before: down to 1e-36
/// Of a determinant that is rounding alone no step is small enough: the count then does not agree.
constexpr int kSplits = 1000;  ///< of one piece

/// A piece of the path: s of t from 0 to 1.
using Curve = std::function<Complex(double)>;

class Winding {
 public:
  explicit Winding(const LoopResponse& response) : response_(response) {}

  /// The turn of det(1 + L) along the path [rad].
  double along(const Curve& path) const {
    splits_ = kSplits;
    return turn(path, 0, at(path(0)), 1, at(path(1)), kHalvings);
  }
  Complex at(Complex s) const {
    const MatrixXcd L = response_.at(s);
    if (!L.allFinite()) return 0;
    const MatrixXcd F = MatrixXcd::Identity(L.rows(), L.cols()) + L;
    return F.size() == 1 ? F(0, 0) : Eigen::PartialPivLU<MatrixXcd>(F).determinant();
  }

 private:
  double turn(const Curve& path, double t0, Complex f0, double t1, Complex f1, int left) const {
    const double t = (t0 + t1) / 2;
    const Complex f = at(path(t));
    const double first = std::arg(f / f0), second = std::arg(f1 / f);
    if (left == 0 || splits_ == 0 || (std::abs(first) < kMostTurn && std::abs(second) < kMostTurn))
      return std::isfinite(first + second) ? first + second : 0;
    --splits_;
    return turn(path, t0, f0, t, f, left - 1) + turn(path, t, f, t1, f1, left - 1);
  }

  const LoopResponse& response_;
  mutable int splits_ = 0;  ///< that remain
};

/// The poles of L on the axis, upper half, each location once.
std::vector<double> on_axis(const std::vector<SidedPole>& open) {
  std::vector<double> list;
  for (const SidedPole& p : open)
    if (p.side == Side::axis && p.s.imag() >= 0) list.push_back(p.s.imag());
  std::sort(list.begin(), list.end());
  list.erase(std::unique(list.begin(), list.end(),
                         [](double a, double b) { return b - a <= linalg::kSameFrequency * b; }),
             list.end());
  return list;
}

/// True if |L| > 10 at points of this circle around j omega.
bool large_around(double omega, double r, const LoopResponse& response) {
  for (int k = 0; k < kPointsAround; ++k)
    if (!(response.at(Complex(0, omega) + std::polar(r, 2 * pi * k / kPointsAround)).norm() > 10))
      return false;
  return true;
}

/// A third of the distance to the next root elsewhere: poles, and with a delay also zeros of L. 0
/// with a delay if |L| is large on no circle: L does not see this pole, which stays as it is.
double radius(double omega, const std::vector<Complex>& roots, const LoopResponse& response) {
  double nearest = omega > 0 ? omega : HUGE_VAL;
  for (const Complex& s : roots)
    if (const double d = std::abs(s - Complex(0, omega));
        d > linalg::kSameFrequency * std::abs(s) && d > 0)
      nearest = std::min(nearest, d);
  double r = std::isinf(nearest) ? 1 : nearest / 3;
  // Closed-loop poles with a delay are not known. None is inside if |L| > 1 on the circle, within
  // which L has no zero: 1 / L is analytic there, and largest on the circle.
  for (int k = 0; response.delay() > 0 && !large_around(omega, r, response); ++k, r /= 4)
    if (k == kCircles) return 0;
  return r;
}

/// Frequencies between `from` and `to` at which steps begin.
std::vector<double> steps(double from, double to, const std::vector<Complex>& poles, double delay) {
  std::vector<double> list{from, to};
  const auto add = [&](double omega) {
    if (omega > from && omega < to) list.push_back(omega);
  };
  for (const Complex& s : poles) {
    add(s.imag());
    const double size = std::max(std::abs(s.real()), kFirstStep * std::abs(s));
    for (double d = size; d > 0 && d < 4 * std::abs(s); d *= 4)
      add(s.imag() + d), add(s.imag() - d);
  }
  if (const double step = pi / 4 / delay; delay > 0)
    for (double omega = from + step; omega < to; omega += step) list.push_back(omega);
  detail::keep_each_once(list);
  return list;
}

/// Beyond it L is its direct term; with a delay, where |L| stays below 1.
double end_of_steps(const StateSpace& L, const LoopResponse& response,
                    const std::vector<Complex>& poles) {
  if (response.delay() > 0) {
    std::vector<Complex> roots = poles;
    for (const LoopCrossing& c : unit_crossings(L, response)) roots.emplace_back(0, c.omega);
    return end_of_turns(response, roots);
  }
  double end = 1;
  for (const Complex& s : poles) end = std::max(end, kEnd * std::abs(s));
  return end;
}

/// The turn of det(1 + L) from s = 0 (or right of it) up the axis to infinity; none if L does not
/// see a pole on the axis.
std::optional<double> turn_of_half(const StateSpace& L, const LoopResponse& response,
                                   const std::vector<SidedPole>& open,
                                   const std::vector<Complex>& poles) {
  const Winding winding(response);
  const double end = end_of_steps(L, response, poles);
  double sum = 0, from = 0;
  const auto straight = [&](double to) {
    const std::vector<double> list = steps(from, to, poles, response.delay());
    for (std::size_t i = 0; i + 1 < list.size(); ++i)
      sum += winding.along(
          [&](double t) { return Complex(0, list[i] + t * (list[i + 1] - list[i])); });
  };
  std::vector<Complex> roots = poles;
  if (response.delay() > 0)
    for (const Complex& s : transmission_zeros(L)) roots.push_back(s);
  for (const double omega : on_axis(open)) {
    const double r = radius(omega, roots, response), first = omega > 0 ? -pi / 2 : 0;
    if (r == 0) return {};
    if (omega > 0) straight(omega - r);
    sum += winding.along(
        [&](double t) { return Complex(0, omega) + std::polar(r, first + t * (pi / 2 - first)); });
    from = omega + r;
  }
  straight(end);
  const double last = (Eigen::MatrixXd::Identity(L.D.rows(), L.D.cols()) + L.D).determinant();
  if (response.delay() > 0) return sum - std::arg(winding.at({0, end}));  // |L| < 1: nearest to 0
  return sum + std::arg(last / winding.at({0, end}));
}

}  // namespace

NyquistCount nyquist_count(const StateSpace& L, const LoopResponse& response, double period) {
  NyquistCount count;
  const std::vector<SidedPole> open = sided_poles(L, period);
  std::vector<Complex> poles;
  for (const SidedPole& p : open) {
    count.open_right += p.side == Side::right;
    poles.push_back(p.s);
  }
  if (response.delay() == 0) {
    for (const SidedPole& p : sided_poles(sensitivity(L), period)) {
      count.closed_right += p.side == Side::right;
      count.closed_on_axis += p.side == Side::axis;
      poles.push_back(p.s);
    }
    if (count.closed_on_axis > 0) return count;
  }
  const std::optional<double> half = turn_of_half(L, response, open, poles);
  if (!half) {
    count.closed_on_axis = 1;
    return count;
  }
  const double turns = -2 * *half / (2 * pi);
  count.encirclements = static_cast<int>(std::lround(turns));
  if (response.delay() > 0) count.closed_right = count.open_right + count.encirclements;
  count.agree = std::abs(turns - count.encirclements) < kWhole && count.closed_right >= 0 &&
                count.encirclements == count.closed_right - count.open_right;
  return count;
}

}  // namespace titop::detail
