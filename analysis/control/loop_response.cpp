#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <titop/analysis/control/loop_response.hpp>
#include <titop/analysis/norms/scaled.hpp>
#include <titop/compiler/minreal/poles.hpp>
#include <titop/graph/error.hpp>
#include <titop/graph/linalg/dense.hpp>
#include <titop/graph/linalg/rounding.hpp>
#include <titop/graph/support/each_once.hpp>

namespace titop::detail {
namespace {

constexpr double kMostTurns = 1e5;  ///< of a delay, in quarters

/// Rounding of the poles of the discrete model whose image by w = c (z - 1) / (z + 1) this is.
double rounding_in_z(StateSpace m, double c) {
  const Eigen::MatrixXd I = Eigen::MatrixXd::Identity(m.A.rows(), m.A.rows());
  const linalg::Inverse inverse = linalg::equilibrated_inverse(c * I - m.A);
  // A pole at z = infinity, w = c, is not near the axis: the rounding of w alone counts.
  if (!(inverse.rcond > static_cast<double>(m.A.rows()) * linalg::kEpsilon)) return 0;
  m.A = inverse.matrix * (c * I + m.A);
  return rounding_of_poles(m);
}

}  // namespace

LoopResponse::LoopResponse(const StateSpace& L, double delay)
    : C_(L.C), D_(L.D), solver_(L.A, L.B), delay_(delay) {}

Eigen::MatrixXcd LoopResponse::at(std::complex<double> s) const {
  const linalg::Solution x = solver_.solve(s);
  if (!(x.rcond > 0) || !x.z.allFinite())
    return Eigen::MatrixXcd::Constant(D_.rows(), D_.cols(),
                                      std::numeric_limits<double>::infinity());
  return (C_ * x.z + D_) * std::exp(-s * delay_);
}

std::complex<double> LoopResponse::at(double omega) const {
  return std::isinf(omega) ? std::complex<double>(D_(0, 0))
                           : at(std::complex<double>(0, omega))(0, 0);
}

std::vector<std::complex<double>> all_poles(const StateSpace& model) {
  std::vector<std::complex<double>> all;
  for (const Pole& p : poles(model)) {
    all.push_back(p.s);
    if (p.pair) all.push_back(std::conj(p.s));
  }
  return all;
}

std::vector<SidedPole> sided_poles(const StateSpace& model, double period) {
  const StateSpace m = scaled(model);
  const double own = rounding_of_poles(m), in_z = period > 0 ? rounding_in_z(m, 2 / period) : 0;
  std::vector<SidedPole> result;
  for (const std::complex<double>& s : all_poles(model)) {
    // dw/dz = (2 / period - w)^2 period / 4
    const double of_z = period > 0 ? std::norm(2 / period - s) * period / 4 * in_z : 0,
                 rounding = std::max(own, of_z);
    if (std::abs(s.real()) <= rounding)
      result.push_back({{0, s.imag()}, Side::axis});
    else
      result.push_back({s, s.real() > 0 ? Side::right : Side::left});
  }
  return result;
}

std::vector<double> structured(const std::vector<std::complex<double>>& roots, double delay,
                               double end) {
  std::vector<double> list;
  const auto add = [&](double omega) {
    if (omega > 0 && std::isfinite(omega)) list.push_back(omega);
  };
  for (const std::complex<double>& s : roots) add(std::abs(s)), add(std::abs(s.imag()));
  if (delay > 0) {
    const double step = std::numbers::pi / 2 / delay;
    for (double k = 1; k * step <= end; ++k) list.push_back(k * step);
    for (const std::complex<double>& s : roots) {
      const double center = std::abs(s.imag()),
                   half_width = std::max(std::abs(s.real()), linalg::kHalfDigits * center);
      for (double off = half_width / 2; off > 0 && off <= center / 2; off *= 2)
        add(center - off), add(center + off);
    }
  }
  if (list.empty()) list.push_back(1);
  const auto [low, high] = std::minmax_element(list.begin(), list.end());
  for (const double omega : {*low / 10, *low / 100, *high * 10, *high * 100}) list.push_back(omega);
  std::sort(list.begin(), list.end());
  const std::size_t count = list.size();
  for (std::size_t i = 0; i + 1 < count; ++i) add(std::sqrt(list[i]) * std::sqrt(list[i + 1]));
  detail::keep_each_once(list);
  return list;
}

double end_of_turns(const LoopResponse& response, const std::vector<std::complex<double>>& roots) {
  const double turn = 2 * std::numbers::pi / response.delay();
  const std::vector<double> list = structured(roots, 0, 0);
  const auto size = [&](double omega) { return std::abs(response.at(omega)); };
  double last = 0;  // |L| = 1 or more
  for (const double omega : list)
    if (size(omega) >= 1 - linalg::kHalfDigits) last = omega;
  double least = HUGE_VAL;
  for (int k = 1; k <= 8; ++k) least = std::min(least, size(last + k * turn / 4));
  double end = last;
  for (const double omega : list)
    if (size(omega) >= least) end = std::max(end, omega);
  end += 2 * turn;
  if (4 * end > kMostTurns * turn)
    throw Error(Code::bad_value,
                fmt::format("a delay of {:g} s is {:.2g} turns at {:.3g} rad/s, where the loop "
                            "still matters",
                            response.delay(), end / turn, end),
                "check the unit of the delay (seconds); reduce the gain at high frequencies");
  return end;
}

}  // namespace titop::detail
