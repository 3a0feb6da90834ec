#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <titop/compiler/economy/balanced.hpp>
#include <titop/compiler/economy/real_modes.hpp>
#include <titop/graph/error.hpp>
#include <titop/graph/linalg/dense.hpp>

namespace titop::detail {
namespace {

using Complex = std::complex<double>;
using Eigen::Index;
using Eigen::MatrixXcd;
using Eigen::MatrixXd;

constexpr double kSilent = 1e-11;    ///< of the peaks: a pole that nobody moves or nobody sees
constexpr double kUnstable = 1e-6;   ///< growth over |s| that is no rounding
constexpr double kDistinct = 1e-10;  ///< relative gap of singular values that may be cut through

/// Rows and columns `list` of a part.
Part select(const Part& p, const std::vector<Index>& list) {
  return {p.A(list, list), p.B(list, Eigen::all), p.C(Eigen::all, list), p.left(list, Eigen::all),
          p.right(Eigen::all, list)};
}

/// Largest share of any pair's peak that a part has on the samples.
double effect(const Part& p, const Samples& samples) {
  double worst = 0;
  for (const Complex& s : samples.s)
    worst = std::max(worst, transfer(p, s).cwiseAbs().cwiseQuotient(samples.peak).maxCoeff());
  return worst;
}

/// The same part in blocks per pole, without those on the axis that no input moves or no output
/// sees; as it is where poles are too close to defective.
Part without_silent(const Part& p, const Samples& samples) {
  if (p.order() == 0) return p;
  RealModes modes;
  try {
    modes = real_modes(p.A, "");
  } catch (const Error&) {
    return p;
  }
  const MatrixXd inverse = modes.T.inverse();
  Part blocks{MatrixXd::Zero(p.order(), p.order()), inverse * p.B, p.C * modes.T, inverse * p.left,
              p.right * modes.T};
  std::vector<Index> stay;
  const auto judge = [&](const std::vector<Index>& list, const MatrixXd& A) {
    blocks.A(list, list) = A;
    const bool grows = A.trace() > kUnstable * A.norm();
    if (grows || !(effect(select(blocks, list), samples) <= kSilent))
      stay.insert(stay.end(), list.begin(), list.end());
  };
  Index first = 0;
  for (const Eigen::Matrix2d& A : modes.A) {
    judge({first, first + 1}, A);
    first += 2;
  }
  for (const double pole : modes.single) judge({first}, MatrixXd::Constant(1, 1, pole));
  return select(blocks, stay);
}

bool is_stable(const MatrixXd& A) {
  return A.size() == 0 || linalg::eigenvalues(A).real().maxCoeff() < 0;
}

}  // namespace

Balanced::Balanced(const StateSpace& model, const Split& split, const Samples& samples, double high)
    : split_(split),
      kept_(piece(without_silent(split_.kept, samples))),
      D_(model.D),
      samples_(samples) {
  const States whole{{piece(split_.integrals), kept_}, D_, {}};
  for (std::size_t k = 0; k < samples.s.size(); ++k)
    rest_.push_back(samples.H[k] - whole.transfer(samples.s[k]));
  const auto [out, in] = port_sizes(samples.peak);
  sizes_ = {in.cwiseInverse().transpose(), out};
  balancings_[0] = balance(split_, sizes_);
  if (high > 0) balancings_[1] = balance(split_, sizes_, high);
}

int Balanced::unstable() const {
  int count = 0;
  for (const Complex& p : split_.poles)
    if (p.real() > kUnstable * std::abs(p)) count += p.imag() > 0 ? 2 : 1;
  return count;
}

double Balanced::error(const Choice& choice, double limit) const {
  const Balancing& b = balancing(choice);
  const Cut c = cut(b, choice.order, choice.truncated);
  if (!c.part.A.allFinite() || !c.D.allFinite()) return HUGE_VAL;
  double largest = 0;
  for (std::size_t i = 0; i < rest_.size(); ++i) {
    const std::size_t k = (i + worst_) % rest_.size();
    const MatrixXcd off = rest_[k] - transfer(c.part, samples_.s[k]) - c.D.cast<Complex>();
    const double here = off.cwiseAbs().cwiseQuotient(samples_.peak).maxCoeff();
    if (here > limit || !std::isfinite(here)) {
      worst_ = k;
      return HUGE_VAL;
    }
    largest = std::max(largest, here);
  }
  return is_stable(c.part.A) ? largest : HUGE_VAL;
}

std::optional<Balanced::Choice> Balanced::find(Index from, double target) const {
  for (Index r = from;; ++r) {
    Choice best{r, false, true, HUGE_VAL};
    bool any = false;
    for (const bool weighted : {false, true}) {
      if (!balancings_[weighted ? 1 : 0]) continue;
      const Eigen::VectorXd& sigma = balancings_[weighted ? 1 : 0]->sigma;
      if (r > sigma.size()) continue;
      any = true;
      if (r > 0 && r < sigma.size() && sigma(r) > (1 - kDistinct) * sigma(r - 1)) continue;
      for (const bool truncated : {true, false}) {
        Choice c{r, weighted, truncated, 0};
        c.error = error(c, std::min(target, best.error));
        if (c.error < best.error) best = c;
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
