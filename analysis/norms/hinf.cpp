#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>
#include <titop/analysis/norms/hinf.hpp>
#include <titop/analysis/norms/scaled.hpp>
#include <titop/graph/error.hpp>
#include <titop/graph/linalg/dense.hpp>
#include <titop/graph/linalg/eigen.hpp>
#include <titop/graph/linalg/rounding.hpp>
#include <titop/graph/linalg/shifted.hpp>

namespace titop {
namespace {

using Eigen::Index;
using Eigen::MatrixXcd;
using Eigen::MatrixXd;
using Complex = std::complex<double>;

/// A level is above the largest value found by this: its crossings are then 1e-5 half bandwidths
/// apart, the root, of which kHalfDigits leave three digits.
constexpr double kAbove = 1e-10;
/// A value is near that of the direct term: levels further above it keep 14 digits.
constexpr double kNearDirect = 1e-2;

/// Singular values of H(j omega), with the slope of the largest one.
class SingularValues {
 public:
  explicit SingularValues(const StateSpace& m)
      : m_(m), x_(m.A, m.B), z_(m.A.transpose(), m.C.transpose()) {}

  HinfNorm at(double omega) const {
    return of(std::isinf(omega) ? MatrixXcd(m_.D.cast<Complex>())
                                : MatrixXcd(m_.C.cast<Complex>() * solved(x_, omega) + m_.D),
              omega);
  }
  /// d value / d omega = Re(left^H dH/d omega right), dH/ds = -C (s - A)^-2 B.
  double slope(const HinfNorm& p) const {
    const MatrixXcd X = solved(x_, p.omega), Z = solved(z_, p.omega);
    return (p.left.adjoint() * Z.transpose() * (X * p.right)).value().imag();
  }

 private:
  static MatrixXcd solved(const linalg::ShiftedSolver& solver, double omega) {
    linalg::Solution x = solver.solve({0, omega});
    if (!(x.rcond > 0) || !x.z.allFinite())
      throw Error(Code::singular,
                  fmt::format("the H-infinity norm is infinite: a pole at {:.6g}j rad/s", omega),
                  "damp it, or give a band_hz without it");
    return std::move(x.z);
  }
  static HinfNorm of(const MatrixXcd& H, double omega) {
    HinfNorm p;
    p.omega = omega;
    if (H.size() == 0) return p;
    const Eigen::JacobiSVD<MatrixXcd> svd(H, Eigen::ComputeThinU | Eigen::ComputeThinV);
    p.value = svd.singularValues()(0);
    p.second = svd.singularValues().size() > 1 ? svd.singularValues()(1) : 0;
    p.left = svd.matrixU().col(0), p.right = svd.matrixV().col(0);
    return p;
  }

  const StateSpace& m_;
  linalg::ShiftedSolver x_, z_;
};

/// Candidates for the frequencies at which a singular value is gamma: the imaginary parts of the
/// eigenvalues of the Hamiltonian matrix in [from, to], ascending, with both ends.
std::vector<double> crossings(const StateSpace& m, double gamma, double from, double to) {
  const Index n = m.A.rows(), nu = m.D.cols();
  // [B / gamma, C]: both off-diagonal blocks are then of one size.
  const double root = std::sqrt(gamma);
  const MatrixXd B = m.B / root, C = m.C / root, D = m.D / gamma;
  const MatrixXd R = MatrixXd::Identity(nu, nu) - D.transpose() * D;
  const MatrixXd inverse = linalg::inverse(R).matrix;
  const MatrixXd A = m.A + B * inverse * D.transpose() * C;
  MatrixXd H(2 * n, 2 * n);
  H << A, B * inverse * B.transpose(),
      -C.transpose() * C - C.transpose() * D * inverse * D.transpose() * C, -A.transpose();
  std::vector<double> result{from, to};
  for (const Complex& s : linalg::eigenvalues(H))
    if (s.imag() > from && s.imag() < to) result.push_back(s.imag());
  std::sort(result.begin(), result.end());
  return result;
}

/// One point of each interval between neighbours; none of an interval that rounding has closed.
std::vector<double> midpoints(const std::vector<double>& ends) {
  std::vector<double> result;
  for (std::size_t i = 0; i + 1 < ends.size(); ++i) {
    if (!(ends[i + 1] > ends[i])) continue;
    result.push_back(std::isinf(ends[i + 1]) ? 2 * ends[i] + 1 : (ends[i] + ends[i + 1]) / 2);
  }
  return result;
}

/// The largest value at the ends of the band, at the poles, and of the direct term if the band
/// reaches it.
HinfNorm first(const SingularValues& gain, const Eigen::VectorXcd& poles, double from, double to) {
  HinfNorm best = gain.at(from);
  const auto look = [&](double omega) {
    HinfNorm p = gain.at(omega);
    if (p.value > best.value) best = std::move(p);
  };
  look(to);
  for (const Complex& s : poles)
    if (const double w = std::abs(s); s.imag() >= 0 && w > from && w < to) look(w);
  return best;
}

/// Levels above the largest value found, in parts of it. Near that of the direct term the
/// Hamiltonian matrix has entries of 1 / (1 - D' D / gamma^2), and loses as many digits: from far
/// above it first.
std::vector<double> levels(double value, double direct) {
  if (value > (1 + kNearDirect) * direct) return {kAbove};
  return {10 * kNearDirect, kNearDirect, 1e-4, 1e-6, 1e-8, kAbove};
}

/// Replaces `best` by a larger value at or between the crossings of a level above it; false if
/// there is none above the lowest of these levels.
bool raised(HinfNorm& best, const SingularValues& gain, const StateSpace& m, double direct,
            const std::array<double, 2>& band) {
  const double before = best.value;
  for (const double part : levels(before, direct)) {
    std::vector<double> points = crossings(m, before * (1 + part), band[0], band[1]);
    const std::vector<double> between = midpoints(points);
    points.insert(points.end(), between.begin(), between.end());
    for (const double omega : points)
      if (HinfNorm p = gain.at(omega); p.value > best.value) best = std::move(p);
    if (best.value > before * (1 + kAbove)) return true;
  }
  return false;
}

/// The intervals of these frequencies in which the largest singular value exceeds the level; of
/// width 0 if it does so at one of them only, whose neighbours rounding has merged with it.
std::vector<std::array<double, 2>> above(const SingularValues& gain,
                                         const std::vector<double>& ends, double level) {
  std::vector<std::array<double, 2>> result;
  bool inside = false;
  const auto take = [&](double from, double to, double omega) {
    const bool now = gain.at(omega).value > level;
    if (now && inside) result.back()[1] = to;
    if (now && !inside) result.push_back({from, to});
    inside = now;
  };
  for (std::size_t i = 0; i < ends.size(); ++i) {
    take(ends[i], ends[i], ends[i]);
    if (i + 1 == ends.size()) break;
    for (const double omega : midpoints({ends[i], ends[i + 1]})) take(ends[i], ends[i + 1], omega);
  }
  return result;
}

/// The end of the band at which the gain is still that of `best`, if the farther end of the
/// interval around it is one. A singular value that is constant somewhere is constant everywhere,
/// since it is analytic: a plateau reaches both ends of the band. A single peak ends at crossings
/// of the level, kHalfDigits lower; one that the band cuts off does so at the farther end.
std::optional<double> plateau(const SingularValues& gain, const HinfNorm& best,
                              const std::array<double, 2>& around,
                              const std::array<double, 2>& band) {
  const double end = around[1] - best.omega > best.omega - around[0] ? around[1] : around[0];
  const bool of_band = end == band[0] || end == band[1];
  if (!of_band || end == best.omega || gain.at(end).value < best.value * (1 - kAbove)) return {};
  return end;
}

/// Where the slope is 0 in the interval around `best`: Newton's step, with the curvature of the
/// slopes at the interval's ends, twice. At an end of the band it stays.
HinfNorm refined(const SingularValues& gain, HinfNorm best, const std::array<double, 2>& around) {
  const double left = around[0], right = around[1];
  if (best.omega <= left || best.omega >= right || std::isinf(right)) return best;
  const double bend = (gain.slope(gain.at(right)) - gain.slope(gain.at(left))) / (right - left);
  for (int step = 0; step < 2 && bend < 0; ++step) {
    const double omega = best.omega - gain.slope(best) / bend;
    if (!(omega > left && omega < right)) break;
    HinfNorm next = gain.at(omega);
    if (next.value < best.value * (1 - 8 * linalg::kEpsilon)) break;
    best = std::move(next);
  }
  return best;
}

void check(const StateSpace& m, const Eigen::VectorXcd& poles, double from, double to) {
  if (!(from >= 0 && from < to))
    throw Error(Code::bad_value, "the band of the H-infinity norm is empty or negative",
                "give band_hz = {lowest, highest} in Hz");
  const double rounding = detail::rounding_of_poles(m);
  for (const Complex& s : poles)
    if (s.imag() >= 0 && std::abs(s.real()) <= rounding && s.imag() >= from - rounding &&
        s.imag() <= to + rounding)
      throw Error(
          Code::singular,
          fmt::format("the H-infinity norm is infinite: the pole {:.6g}{:+.6g}j is on the axis",
                      s.real(), s.imag()),
          "damp it, leave out the output that reads its position, or give a band_hz without it");
}

}  // namespace

HinfNorm norm_hinf(const StateSpace& model, const HinfOptions& options) {
  if (model.order() > kMostStatesOfHinf)
    throw Error(Code::bad_value,
                fmt::format("the H-infinity norm of a model of {} states", model.order()),
                fmt::format("reduce it to {} states or fewer: compile(diagram, Scene{{...}}), or "
                            "take frequency_response",
                            kMostStatesOfHinf));
  require_fitting(model, "norm_hinf");
  detail::require_finite(model, "H-infinity norm");
  const double from = 2 * std::numbers::pi * options.band_hz[0],
               to = 2 * std::numbers::pi * options.band_hz[1];
  const StateSpace m = detail::scaled(model);
  const Eigen::VectorXcd poles = m.order() > 0 ? linalg::eigenvalues(m.A) : Eigen::VectorXcd();
  check(m, poles, from, to);
  const SingularValues gain(m);
  HinfNorm best = first(gain, poles, from, to);
  if (m.order() == 0 || !(best.value > 0)) return best;
  const double direct = gain.at(HUGE_VAL).value;
  while (raised(best, gain, m, direct, {from, to})) {
  }
  const double level = best.value * (1 - linalg::kHalfDigits);
  std::vector<double> ends = crossings(m, level, from, to);
  ends.insert(std::upper_bound(ends.begin(), ends.end(), best.omega), best.omega);
  const double found = best.omega;  // in one of the intervals: its gain is above the level
  std::vector<double> others;
  for (const auto& interval : above(gain, ends, level)) {
    if (interval[0] <= found && found <= interval[1]) {
      if (const auto end = plateau(gain, best, interval, {from, to})) others.push_back(*end);
      best = refined(gain, std::move(best), interval);
    } else {
      others.push_back((interval[0] + interval[1]) / 2);
    }
  }
  best.others = std::move(others);
  return best;
}

}  // namespace titop
