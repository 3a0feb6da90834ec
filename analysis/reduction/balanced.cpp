#include <algorithm>
#include <cmath>
#include <titop/analysis/reduction/balanced.hpp>
#include <titop/analysis/reduction/real_modes.hpp>
#include <titop/graph/error.hpp>
#include <titop/graph/linalg/dense.hpp>
#include <titop/graph/linalg/eigen.hpp>

namespace titop::detail {
namespace {

using Complex = std::complex<double>;
using Eigen::Index;
using Eigen::MatrixXcd;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr double kSilent = 1e-11;    ///< of the peaks: an unreachable or unobservable pole
constexpr double kDistinct = 1e-10;  ///< relative gap of singular values that may be cut through
constexpr double kClear = 1.1;       ///< times the target: a clear violation on one sample
constexpr double kDigits = 1e-11;    ///< of the peaks: possible loss of unpivoted elimination

/// Rows and columns `list` of a part.
SpectralPart select(const SpectralPart& p, const std::vector<Index>& list) {
  return {p.A(list, list), p.B(list, Eigen::all), p.C(Eigen::all, list), p.left(list, Eigen::all),
          p.right(Eigen::all, list)};
}

/// Lowest modulus of a pole that is not 0, or the band's end if that is lower.
double lowest(const Split& split, const Samples& samples) {
  double first = samples.omega.size() > 1 ? samples.omega.back() : 1;
  for (const Complex& p : split.poles)
    if (p != 0.0) first = std::min(first, std::abs(p));
  return first;
}

/// Determines whether a kept part is silent, that is, unreachable or unobservable.
///
/// Rounding gives a pole that counts as 0 (`Split::poles`) a residue and a small distance from 0;
/// both seem the larger, the lower the sample. If the band begins at 0, a pole at 0 can only be
/// hidden, since otherwise there is no gain: it is judged at the lowest pole's frequency.
class Judge {
 public:
  Judge(const Split& split, const Samples& samples)
      : lowest_(lowest(split, samples)), samples_(samples) {}
  bool is_silent(const SpectralPart& p) const {
    const bool is_zero = p.A.cwiseAbs().maxCoeff() < 0.5 * lowest_;  // distinct from all others
    // Samples begin at kStart if the band begins at 0.
    if (is_zero && samples_.omega.front() <= 2 * kStart * lowest_)
      return size(p, lowest_) <= kSilent;
    if (p.A.trace() > kUndamped * p.A.norm()) return false;
    double worst = 0;
    for (const Complex& s : samples_.s) worst = std::max(worst, size(p, s));
    return worst <= kSilent;
  }

 private:
  /// Largest share of any pair's peak.
  double size(const SpectralPart& p, Complex s) const {
    return transfer(p, s).cwiseAbs().cwiseQuotient(samples_.peak).maxCoeff();
  }
  double lowest_;
  const Samples& samples_;
};

/// The kept part in blocks per pole, without those on the axis that are silent; as it is if
/// poles are too close to defective.
SpectralPart without_silent(const Split& split, const Samples& samples) {
  const SpectralPart& p = split.kept;
  if (p.order() == 0) return p;
  RealModes modes;
  try {
    modes = real_modes(p.A, "");
  } catch (const Error&) {
    return p;
  }
  const MatrixXd inverse = modes.T.inverse();
  SpectralPart blocks{MatrixXd::Zero(p.order(), p.order()), inverse * p.B, p.C * modes.T,
                      inverse * p.left, p.right * modes.T};
  const Judge judge(split, samples);
  std::vector<Index> stay;
  const auto add = [&](const std::vector<Index>& list, const MatrixXd& A) {
    blocks.A(list, list) = A;
    if (!judge.is_silent(select(blocks, list))) stay.insert(stay.end(), list.begin(), list.end());
  };
  Index first = 0;
  for (const Eigen::Matrix2d& A : modes.A) {
    if (A.isDiagonal(0)) {
      add({first}, A.topLeftCorner<1, 1>());
      add({first + 1}, A.bottomRightCorner<1, 1>());
    } else {
      add({first, first + 1}, A);
    }
    first += 2;
  }
  for (const double pole : modes.single) add({first}, MatrixXd::Constant(1, 1, pole));
  return select(blocks, stay);
}

/// L U = S in place, L with diagonal 1, without pivots: the leading blocks of L and U are factors
/// of the leading blocks of S.
void factor(Eigen::Ref<MatrixXcd> S) {
  const Index n = S.rows(), half = n / 2;
  if (n < 2) return;
  if (n <= 16) {
    for (Index k = 0; k + 1 < n; ++k) {
      const Index rest = n - k - 1;
      S.col(k).tail(rest) /= S(k, k);
      S.bottomRightCorner(rest, rest).noalias() -= S.col(k).tail(rest) * S.row(k).tail(rest);
    }
    return;
  }
  factor(S.topLeftCorner(half, half));
  auto right = S.topRightCorner(half, n - half);
  auto below = S.bottomLeftCorner(n - half, half);
  const auto corner = S.topLeftCorner(half, half);
  corner.triangularView<Eigen::UnitLower>().solveInPlace(right);
  corner.triangularView<Eigen::Upper>().solveInPlace<Eigen::OnTheRight>(below);
  S.bottomRightCorner(n - half, n - half).noalias() -= below * right;
  factor(S.bottomRightCorner(n - half, n - half));
}

bool is_stable(const States::PartialFractions& p) {
  if (p.part.order() == 0) return true;
  const Eigen::VectorXcd poles = p.pole.size() ? p.pole : linalg::eigenvalues(p.part.A);
  return poles.real().maxCoeff() < 0;
}

}  // namespace

Balanced::Balanced(const StateSpace& model, const Split& split, const Samples& samples, double high)
    : split_(split), kept_(piece(without_silent(split_, samples))), D_(model.D), samples_(samples) {
  const States whole{{piece(split_.integrals), kept_}, D_, {}};
  for (std::size_t k = 0; k < samples.s.size(); ++k)
    rest_.push_back(samples.H[k] - whole.transfer(samples.s[k]));
  const auto [out, in] = port_sizes(samples.peak);
  sizes_ = {in.cwiseInverse().transpose(), out};
  balancings_[0] = balance(split_, sizes_);
  if (high > 0) balancings_[1] = balance(split_, sizes_, high);
  for (const bool weighted : {false, true})
    for (VectorXd& seen : seen_[weighted ? 1 : 0])
      if (const auto& b = balancings_[weighted ? 1 : 0]) seen.setZero(b->sigma.size() + 1);
}

int Balanced::unstable() const {
  int count = 0;
  for (const Complex& p : split_.poles)
    if (p.real() > kUndamped * std::abs(p)) count += p.imag() > 0 ? 2 : 1;
  return count;
}

double Balanced::error(const Choice& choice, double limit) const {
  Cut c = cut(balancing(choice), choice.order, choice.truncated);
  if (!c.part.A.allFinite() || !c.D.allFinite()) return HUGE_VAL;
  const States model{{piece(std::move(c.part))}, std::move(c.D), {}};
  double largest = 0;
  std::size_t worst = 0;
  for (std::size_t k = 0; k < rest_.size(); ++k) {
    const MatrixXcd off = rest_[k] - model.transfer(samples_.s[k]);
    const double here = off.cwiseAbs().cwiseQuotient(samples_.peak).maxCoeff();
    if (!(here <= largest)) largest = here, worst = k;
    if (!std::isfinite(here)) return HUGE_VAL;
    // Without eigenvectors every sample costs as much as all the others with them.
    if (here > limit && model.pieces.front().pole.size() == 0) break;
  }
  if (largest > limit) learn(choice, worst);
  return largest <= limit && is_stable(model.pieces.front()) ? largest : HUGE_VAL;
}

bool Balanced::fails(const Choice& c, double target) const {
  return seen_[c.weighted ? 1 : 0][c.truncated ? 1 : 0](c.order) > kClear * target + kDigits;
}

/// Truncated, C_r (s - A_r)^-1 B_r is a sum over the first r columns of C U^-1 and rows of L^-1 B,
/// with L U = s - A. At rest it is D - C A^-1 B - s C_r' (1 - s A_r')^-1 B_r' with A' = A^-1,
/// B' = A^-1 B, C' = C A^-1 [Liu, Anderson 1989]: the same. No pivot of either can be 0 right of
/// the axis, where leading blocks of balanced matrices have no poles.
void Balanced::learn(const Choice& c, std::size_t k) const {
  const Balancing& b = balancing(c);
  const Complex s = samples_.s[k];
  MatrixXcd S = -b.A.cast<Complex>(), B = b.B.cast<Complex>(), C = b.C.cast<Complex>(),
            H = rest_[k];
  if (c.truncated) {
    S.diagonal().array() += s;
  } else {
    const Eigen::PartialPivLU<MatrixXd> lu(b.A);
    const MatrixXd inverse = lu.inverse();
    H += C * (inverse * b.B);
    B = -s * (inverse * b.B);
    C = C * inverse;
    S = -s * inverse;
    S.diagonal().array() += 1;
  }
  factor(S);
  S.triangularView<Eigen::UnitLower>().solveInPlace(B);
  S.triangularView<Eigen::Upper>().solveInPlace<Eigen::OnTheRight>(C);
  VectorXd& seen = seen_[c.weighted ? 1 : 0][c.truncated ? 1 : 0];
  for (Index r = 0; r < seen.size(); ++r) {
    const double here = H.cwiseAbs().cwiseQuotient(samples_.peak).maxCoeff();
    if (here > seen(r) && std::isfinite(here)) seen(r) = here;
    if (r < b.A.rows()) H -= C.col(r) * B.row(r);
  }
}

std::optional<Balanced::Choice> Balanced::find(Index from, double target) const {
  for (Index r = from;; ++r) {
    Choice best{r, false, true, HUGE_VAL};
    bool any = false;
    for (const bool weighted : {false, true}) {
      if (!balancings_[weighted ? 1 : 0]) continue;
      const VectorXd& sigma = balancings_[weighted ? 1 : 0]->sigma;
      if (r > sigma.size()) continue;
      any = true;
      if (r > 0 && r < sigma.size() && sigma(r) > (1 - kDistinct) * sigma(r - 1)) continue;
      for (const bool truncated : {true, false}) {
        Choice c{r, weighted, truncated, 0};
        if (!fails(c, target) && (c.error = error(c, target)) < best.error) best = c;
      }
      if (best.error <= target) return best;
    }
    if (!any) return std::nullopt;
  }
}

Balanced::Choice Balanced::best() const {
  Choice best{0, false, true, HUGE_VAL};
  for (Index back = 0; back < 8; ++back)
    for (const bool weighted : {false, true}) {
      if (!balancings_[weighted ? 1 : 0]) continue;
      const Index r = balancings_[weighted ? 1 : 0]->sigma.size() - back;
      for (const bool truncated : {true, false}) {
        Choice c{r, weighted, truncated, 0};
        if (r >= 0 && (c.error = error(c, best.error)) < best.error) best = c;
      }
    }
  return best;
}

States Balanced::model(const Choice& choice) const {
  Cut c = cut(balancing(choice), choice.order, choice.truncated);
  return {{piece(split_.integrals), kept_, piece(std::move(c.part))}, D_ + c.D, {}};
}

MatrixXd Balanced::anywhere(const Choice& choice) const {
  if (choice.weighted) return {};
  return cut_bound(balancing(choice), choice.order) * sizes_.output *
         sizes_.input.cwiseInverse().transpose();
}

}  // namespace titop::detail
