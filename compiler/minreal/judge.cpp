#include <algorithm>
#include <cmath>
#include <numeric>
#include <titop/compiler/minreal/clusters.hpp>
#include <titop/compiler/minreal/judge.hpp>
#include <titop/graph/linalg/index.hpp>

namespace titop::minreal {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

/// Far narrower than the spacing of doubles at a pole: negligible in effect, but no proof of a 0.
constexpr double kNothing = 1e-17;
constexpr double kFarOff = 1e-6;  ///< above it not even exact arithmetic removes a mode

using linalg::at;

/// Response of all modes near the frequency of mode j, per port: sqrt(sum rows_i^2 w_i).
VectorXd background(const MatrixXd& rows, const ModeSet& m, Index j) {
  VectorXd sum = VectorXd::Zero(rows.cols());
  // The rows of a Jordan block may have any size: all others would look negligible compared with
  // them.
  for (Index i = 0; i < rows.rows(); ++i)
    if (m.apart[at(i)].empty())
      sum += rows.row(i).transpose().cwiseAbs2() / std::max(m.distance(i, j), 0.01 * m.lambda(j));
  return sum.cwiseSqrt();
}

/// Rounding in the row of mode j: contributions of the other modes, by `mixing`; those of its
/// cluster twice, once by the rotation, once by the product with B or C.
VectorXd rounding(const MatrixXd& rows, const MatrixXd& apart, const ModeSet& m, Index j,
                  const VectorXd& mixing) {
  VectorXd sum = apart.size() > 0 ? VectorXd(apart.row(j)) : VectorXd(VectorXd::Zero(rows.cols()));
  for (Index i = 0; i < rows.rows(); ++i) {
    const bool same = m.cluster[at(i)] == m.cluster[at(j)];
    sum += (same ? 2 * kEpsilon : mixing(i)) * rows.row(i).transpose();
  }
  return sum;
}

/// Largest ratio; entries without background count as 0.
double largest(const VectorXd& mine, const VectorXd& background) {
  double most = 0;
  for (Index l = 0; l < mine.size(); ++l)
    if (background(l) > 0) most = std::max(most, mine(l) / background(l));
  return most;
}

/// One side of a mode, inputs or outputs: its size against the background, and rounding's.
struct ModeSide {
  double size, noise;
  ModeSide(const MatrixXd& rows, const MatrixXd& apart, const ModeSet& m, Index j,
           const VectorXd& mixing) {
    const VectorXd all = background(rows, m, j);
    size = largest(rows.row(j), all);
    noise = largest(rounding(rows, apart, m, j, mixing), all);
  }
  /// All states are driven, or seen.
  explicit ModeSide(double lambda) : size(std::sqrt(lambda)), noise(0) {}
};

Verdict judge(const ModeSet& m, Index j, double resolution) {
  Verdict v;
  if (!m.apart[at(j)].empty()) {
    v.doubtful = !m.needed[at(j)];
    return v;
  }
  const bool inputs = m.b.cols() > 0, outputs = m.c.cols() > 0;
  const ModeSide b =
      inputs ? ModeSide(m.b, m.b_apart, m, j, m.mixing.col(j)) : ModeSide(m.lambda(j));
  const ModeSide c =
      outputs ? ModeSide(m.c, m.c_apart, m, j, m.mixing.row(j)) : ModeSide(m.lambda(j));
  v.visibility = b.size * c.size / (2 * m.lambda(j));
  v.bound = std::max(c.size * b.noise, b.size * c.noise) / (2 * m.lambda(j));
  v.unreachable = inputs && (!outputs || b.size <= c.size);
  const bool nothing = v.visibility <= 10 * v.bound || v.visibility <= kNothing;
  v.drop = (nothing && v.visibility <= kWarn && v.bound <= kWarn) || v.visibility <= resolution;
  const bool small =
      v.visibility <= kWarn && v.visibility <= kClearly * std::max(v.bound, kEpsilon * kEpsilon);
  v.doubtful = !v.drop && (small || v.visibility <= 10 * v.bound);
  return v;
}

/// Zero to double precision, and too narrow to matter otherwise: with more rounding, an apparently
/// negligible mode may have an effect.
bool is_zero(const Verdict& v) {
  return v.visibility <= v.bound && v.bound <= linalg::kProductRounding;
}

/// Why a mode was removed, or is near the limit.
std::string reason(const Verdict& v, bool hardly) {
  if (v.unreachable) return hardly ? "inputs hardly move it" : "no input moves it";
  return hardly ? "outputs hardly see it" : "no output sees it";
}

/// Adds a cluster that is judged as a whole to the verdict.
void add_whole(const WholeCluster& c, OrderVerdict& r) {
  const MinimalPart& p = c.part;
  const auto report = [&](int states, std::string why) {
    return JudgedMode{c.omega, states, p.visibility, p.bound, std::move(why)};
  };
  if (const int k = c.unreachable(); k > 0) r.removed.push_back(report(k, "no input moves it"));
  if (const int k = c.unseen(); k > 0) r.removed.push_back(report(k, "no output sees it"));
  const int left = c.states() - c.leaving(), fewer = left - static_cast<int>(p.lowest);
  r.order -= c.leaving();
  if (c.leaving() > 0) r.to_more = std::max(r.to_more, p.visibility);
  if (p.bound > kHides) r.highest += c.leaving();
  r.lowest -= fewer;
  if (fewer > 0) r.undecided.push_back(report(fewer, c.name));
}

}  // namespace

std::vector<Verdict> judge(const ModeSet& m, double resolution) {
  std::vector<Verdict> verdicts;
  for (Index j = 0; j < m.size(); ++j) verdicts.push_back(judge(m, j, resolution));
  return verdicts;
}

bool drop_down_to(int exact, int order, ModeSet& m, std::vector<Verdict>& verdicts) {
  for (WholeCluster& c : m.wholes) {
    if (order - c.leaving() < exact) {
      c.part.unreachable.resize(c.states(), 0);
      c.part.unseen.resize(c.states(), 0);
    }
    order -= c.leaving();
  }
  std::vector<std::size_t> weakest(verdicts.size());
  std::iota(weakest.begin(), weakest.end(), 0);
  std::stable_sort(weakest.begin(), weakest.end(), [&](std::size_t a, std::size_t b) {
    return verdicts[a].visibility < verdicts[b].visibility;
  });
  const std::vector<Verdict> judged = verdicts;
  const auto drop = [&](const auto& may) {
    int left = order - exact;
    for (Verdict& v : verdicts) v.drop = v.doubtful = false;
    for (const std::size_t j : weakest) {
      if (!m.apart[j].empty() || m.states[j] == 0 || m.states[j] > left || !may(judged[j]))
        continue;
      verdicts[j].drop = true;
      left -= m.states[j];
    }
    return left == 0;
  };
  if (drop([](const Verdict& v) { return v.visibility <= kFarOff; })) return true;
  // Otherwise the order does not determine which modes to remove: those that are removed without
  // it.
  return drop([](const Verdict& v) { return v.drop; });
}

OrderVerdict sum_up(const std::vector<Verdict>& verdicts, const ModeSet& m, int order) {
  OrderVerdict r;
  r.judged = true;
  r.order = order;
  int fewer = 0, more = 0;
  for (std::size_t j = 0; j < verdicts.size(); ++j) {
    const Verdict& v = verdicts[j];
    if (m.states[j] == 0) continue;
    const auto report = [&](std::string why) {
      return JudgedMode{m.omega(static_cast<Index>(j)), m.states[j], v.visibility, v.bound,
                        std::move(why)};
    };
    if (v.drop) {
      r.order -= m.states[j];
      more += is_zero(v) ? 0 : m.states[j];
      r.to_more = std::max(r.to_more, v.visibility);
      r.removed.push_back(report(reason(v, v.visibility > 10 * v.bound)));
    } else {
      r.to_fewer = m.apart[j].empty() ? std::min(r.to_fewer, v.visibility) : r.to_fewer;
      if (!v.doubtful) continue;
      fewer += m.states[j];
      r.undecided.push_back(report(m.apart[j].empty() ? reason(v, true) : m.apart[j]));
    }
  }
  r.lowest = -fewer;
  r.highest = more;
  for (const WholeCluster& c : m.wholes) add_whole(c, r);
  r.lowest += r.order;
  r.highest += r.order;
  return r;
}

}  // namespace titop::minreal
