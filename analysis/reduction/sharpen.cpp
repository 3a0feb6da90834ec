#include <algorithm>
#include <cmath>
#include <optional>
#include <titop/analysis/reduction/sharpen.hpp>
#include <titop/graph/linalg/rounding.hpp>
#include <titop/graph/support/parallel.hpp>

namespace titop::detail {
namespace {

using Complex = std::complex<double>;
using Eigen::Index;

/// The pair with the largest share of a mode.
struct PortPair {
  Index output = 0, input = 0;
};

/// 1 / H of the pair at s; 0 if s is a pole to the last bit.
Complex inverse(const System& system, const PortPair& pair, Complex s) {
  try {
    return 1.0 / system.transfer(s)(pair.output, pair.input);
  } catch (const Error& error) {
    if (!error.has(Code::singular)) throw;
    return 0;
  }
}

/// The root of s^2 + d s + lambda = 0 above the real axis.
Complex pole(double lambda, double d) { return {-d / 2, std::sqrt(lambda - d * d / 4)}; }

/// The pole near a guess with a relative error of about 1e-7; none if the function is not that of
/// one pole there.
std::optional<Complex> find_pole(const System& system, const PortPair& pair, Complex guess) {
  constexpr double kNear = 1e-6;   // relative distance of the first two points
  constexpr double kOdd = 0.1;     // their values differ in sign alone: one pole between them
  constexpr double kLast = 1e-15;  // a step in the last place
  Complex a = guess * (1 + kNear), b = guess * (1 - kNear);
  Complex fa = inverse(system, pair, a), fb = inverse(system, pair, b);
  if (!(std::abs(fa + fb) <= kOdd * std::abs(fa - fb))) return std::nullopt;
  for (int step = 0; step < 4 && fa != fb; ++step) {
    const Complex next = b - fb * (b - a) / (fb - fa);
    if (!(std::abs(next - guess) <= kNear * std::abs(guess))) return std::nullopt;
    a = b, fa = fb;
    b = next;
    if (std::abs(b - a) <= kLast * std::abs(b)) break;
    fb = inverse(system, pair, b);
    if (fb == 0.0) break;
  }
  return b;
}

PortPair best_pair(const Whole& w, Index j) {
  PortPair best;
  double largest = -1;
  for (Index i = 0; i < w.ca.rows(); ++i) {
    const double row = w.ca.row(i).norm() + w.cv.row(i).norm();
    const double c = std::abs(w.ca(i, j)) + std::abs(w.cv(i, j));
    for (Index m = 0; m < w.b.cols(); ++m) {
      const double size = row * w.b.col(m).norm();
      if (size > 0 && c * std::abs(w.b(j, m)) > largest * size)
        largest = c * std::abs(w.b(j, m)) / size, best = {i, m};
    }
  }
  return best;
}

/// Distance of mode j to the nearest one that is not in its cluster, relative to lambda.
double distance(const Eigen::VectorXd& lambda, Index elastic, Index j) {
  double nearest = HUGE_VAL;
  for (Index i = 0; i < elastic; ++i)
    if (const double off = std::abs(lambda(i) - lambda(j)) / lambda(j);
        off > 2 * linalg::kSameFrequency)
      nearest = std::min(nearest, off);
  return nearest;
}

/// Modes that had one frequency have one again, and one damping if they had one: in pairs that
/// symmetry makes 0 their terms cancel, and near a resonance the last digits between them would
/// not. `found`: those that have new values; the mean is theirs.
void unite(Whole& w, const Eigen::VectorXd& before, const Eigen::VectorXd& damping_before,
           const std::vector<char>& found) {
  const auto count = static_cast<Index>(found.size());
  for (Index first = 0, last = 0; first < count; first = last) {
    while (last < count && before(last) == before(first)) ++last;
    double lambda = 0, damping = 0, of = 0;
    for (Index j = first; j < last; ++j)
      if (found[static_cast<std::size_t>(j)]) lambda += w.lambda(j), damping += w.damping(j), ++of;
    if (of == 0) continue;
    w.lambda.segment(first, last - first).setConstant(lambda / of);
    const auto was = damping_before.segment(first, last - first);
    if (w.Z.size() > 0 &&
        was.maxCoeff() - was.minCoeff() <= linalg::kSameFrequency * was.maxCoeff())
      w.Z.diagonal().segment(first, last - first).setConstant(damping / of);
  }
}

}  // namespace

void sharpen(Whole& w, const System& system, double high) {
  if (!w.proportional) return;
  Index count = 0;
  while (count < w.elastic() && w.lambda(count) <= high * high) ++count;
  const Eigen::VectorXd before = w.lambda;
  const Eigen::VectorXd damping_before =
      w.Z.size() > 0 ? Eigen::VectorXd(w.Z.diagonal()) : Eigen::VectorXd::Zero(before.size());
  std::vector<char> moved(static_cast<std::size_t>(count), 0);
  parallel(static_cast<std::size_t>(count), 0, [&] {
    return [&](std::size_t i) {
      const auto j = static_cast<Index>(i);
      const double d = w.damping(j), lambda = before(j);
      if (d * d >= lambda) return;
      const auto found = find_pole(system, best_pair(w, j), pole(lambda, d));
      if (!found) return;
      // Farther than a third of the way to a neighbour it may be the neighbour's pole.
      const double move = std::abs(std::norm(*found) - lambda) / lambda;
      if (!(move <= distance(before, w.elastic(), j) / 3)) return;
      moved[i] = 1;
      w.lambda(j) = std::norm(*found);
      if (w.Z.size() > 0) w.Z(j, j) = std::max(0.0, -2 * found->real());
    };
  });
  unite(w, before, damping_before, moved);
}

}  // namespace titop::detail
