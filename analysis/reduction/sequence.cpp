#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <titop/analysis/reduction/sequence.hpp>
#include <titop/graph/linalg/eigen.hpp>
#include <titop/graph/linalg/index.hpp>
#include <titop/graph/linalg/rounding.hpp>
#include <utility>

namespace titop::detail {
namespace {

using Complex = std::complex<double>;
using Eigen::Index;
using Eigen::MatrixXcd;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr double kSameError = 1e-6;     ///< errors that count as equal: the first is taken
constexpr double kParallel = 1 - 1e-9;  ///< cosine: an output's modal vector is that of an input
constexpr double kStalls = 0.95;        ///< of the error before: columns have not helped

using linalg::at;

/// Sensitivity of an output to the elastic modes: positions, accelerations, or rates.
VectorXd reading(const Whole& w, Index output) {
  const Index n = w.elastic();
  VectorXd a = w.ca.row(output).head(n).transpose();
  if (w.is_position[at(output)]) return a.cwiseProduct(w.lambda.head(n));
  return a.isZero(0) ? VectorXd(w.cv.row(output).head(n).transpose()) : a;
}

/// True if every output's modal vector is parallel to that of an input.
bool collocated(const Whole& w) {
  const Index n = w.elastic();
  for (Index i = 0; i < w.ca.rows(); ++i) {
    const VectorXd c = reading(w, i);
    double best = c.isZero(0) ? 1 : 0;
    for (Index m = 0; m < w.b.cols() && best < kParallel; ++m)
      if (const double size = c.norm() * w.b.col(m).head(n).norm(); size > 0)
        best = std::max(best, std::abs(c.dot(w.b.col(m).head(n))) / size);
    if (best < kParallel) return false;
  }
  return true;
}

/// W with the part of a column of norm 1 that is orthogonal to it; false if that is rounding.
bool append(MatrixXd& W, VectorXd column) {
  for (int twice = 0; twice < 2; ++twice) {
    column -= W * (W.transpose() * column);
    const double left = column.norm();
    if (left < linalg::kInSpan) return false;
    column /= left;
  }
  W.conservativeResize(Eigen::NoChange, W.cols() + 1);
  W.rightCols<1>() = column;
  return true;
}

}  // namespace

MatrixXcd difference(const Samples& full, const MatrixXcd& Hr, std::size_t k) {
  MatrixXcd d = full.H[k] - Hr;
  if (!d.allFinite())
    throw Error(Code::not_finite,
                fmt::format("the transfer of the scene is not finite at {:.4g} Hz",
                            full.omega[k] / (2 * std::numbers::pi)),
                "numbers overflow there: look for stiffnesses and masses that are far too large or "
                "too small, or take other units");
  return d;
}

MatrixXd errors(const Samples& full, const Small& small) {
  MatrixXd worst = MatrixXd::Zero(full.peak.rows(), full.peak.cols());
  for (std::size_t k = 0; k < full.s.size(); ++k)
    worst = worst.cwiseMax(difference(full, small, k).cwiseAbs());
  return worst.cwiseQuotient(full.peak);
}

Sequence::Sequence(const Whole& whole, const Samples& samples, double high)
    : whole_(whole), samples_(samples), collocated_(collocated(whole)) {
  const Index n = whole.elastic();
  while (inside_ < n && whole.lambda(inside_) <= high * high) ++inside_;
  // Above a mode its residual at infinite frequency is nearer to it than its static part: by
  // lambda / |s|^2; damped beyond critical it has a second pole, at about its damping coefficient.
  const double low = samples.omega.front();
  for (Index j = 0; j < n; ++j)
    below_.push_back(whole.lambda(j) < low * low && whole.damping(j) < low);
  is_kept_.assign(at(n), 0);
  W_.resize(n, 0);
  added_.resize(n, 0);
  worst_ = evaluate();
  note(worst_);
}

Sequence::Choice Sequence::choice(std::size_t step) const {
  const Step& s = steps_[step];
  return {{kept_.begin(), kept_.begin() + s.kept}, added_.leftCols(s.columns)};
}

Small Sequence::model(const Choice& choice) const {
  MatrixXd W(choice.vectors.rows(), 0);
  for (Index i = 0; i < choice.vectors.cols(); ++i) append(W, choice.vectors.col(i));
  return small(choice.kept, W);
}

/// The projection, plus the high-frequency asymptote of the modes below the band that are not kept.
Small Sequence::small(const std::vector<Index>& kept, const MatrixXd& W) const {
  Small result = project(whole_, kept, W);
  std::vector<char> left_out = below_;
  for (const Index j : kept) left_out[at(j)] = 0;
  for (Index j = 0; j < inside_; ++j)
    if (left_out[at(j)]) result.D0 += whole_.ca.col(j) * whole_.b.row(j);
  return result;
}

void Sequence::note(const WorstPair& worst) {
  steps_.push_back({static_cast<Index>(kept_.size()), W_.cols(), worst.error});
}

Sequence::WorstPair Sequence::evaluate() {
  model_ = small(kept_, W_);
  error_.resize(samples_.s.size());
  WorstPair worst;
  for (std::size_t k = 0; k < samples_.s.size(); ++k) {
    error_[k] = difference(samples_, model_, k);
    for (Index j = 0; j < error_[k].cols(); ++j)
      for (Index i = 0; i < error_[k].rows(); ++i)
        if (const double e = std::abs(error_[k](i, j)) / samples_.peak(i, j);
            !(e <= (1 + kSameError) * worst.error))
          worst = {i, j, k, e};
  }
  return worst;
}

bool Sequence::grow() {
  if (!(worst_.error > 0) || stalled() || !(add_pending() || extend(worst_))) return false;
  worst_ = evaluate();
  note(worst_);
  return true;
}

/// True if column after column has not helped: rounding is reached.
bool Sequence::stalled() const {
  const std::size_t columns = 8 + at(whole_.b.cols() + whole_.ca.rows());
  const std::size_t patience = collocated_ ? columns : 2 * columns;  // two steps to a pair
  if (steps_.size() <= patience) return false;
  const Step& before = steps_[steps_.size() - 1 - patience];
  return steps_.back().kept == before.kept && steps_.back().error > kStalls * before.error;
}

bool Sequence::extend(const WorstPair& worst) {
  return keep_one(worst, 0.5) || add_columns(worst) || keep_one(worst, 0);
}

/// The dropped mode of the band with the largest term in this error, if all of them explain at
/// least this fraction of it.
bool Sequence::keep_one(const WorstPair& worst, double least) {
  std::vector<Index> dropped;
  for (Index j = 0; j < inside_; ++j)
    if (!is_kept_[at(j)]) dropped.push_back(j);
  if (dropped.empty()) return false;
  const Eigen::VectorXcd terms =
      whole_.loose_coupled ? coupled_terms(worst, dropped) : own_terms(worst, dropped);
  Complex sum = 0;
  Index best = -1;
  double largest = 0;
  for (Index i = 0; i < terms.size(); ++i) {
    sum += terms(i);
    if (std::abs(terms(i)) > largest) largest = std::abs(terms(i)), best = dropped[at(i)];
  }
  const double total = std::abs(error_[worst.sample](worst.output, worst.input));
  if (best < 0 || std::abs(sum) < least * total) return false;
  is_kept_[at(best)] = 1;
  kept_.push_back(best);
  return true;
}

Eigen::VectorXcd Sequence::own_terms(const WorstPair& worst,
                                     const std::vector<Index>& modes) const {
  const Complex s = samples_.s[worst.sample];
  Eigen::VectorXcd terms(static_cast<Index>(modes.size()));
  for (std::size_t i = 0; i < modes.size(); ++i) {
    const Index j = modes[i];
    const Complex c = s * (s * whole_.ca(worst.output, j) + whole_.cv(worst.output, j));
    const double residual = below_[at(j)] ? whole_.ca(worst.output, j) : 0;  // its asymptote
    terms(static_cast<Index>(i)) =
        (c / (s * (s + whole_.damping(j)) + whole_.lambda(j)) - residual) *
        whole_.b(j, worst.input);
  }
  return terms;
}

/// Momenta shift resonances by far more than their width: the modes' equations with those of the
/// model's coordinates eliminated, a Schur complement.
Eigen::VectorXcd Sequence::coupled_terms(const WorstPair& worst,
                                         const std::vector<Index>& modes) const {
  const Complex s = samples_.s[worst.sample];
  const MatrixXd &V = model_.V, Z = whole_.Z(modes, Eigen::all);
  MatrixXcd S = s * Z(Eigen::all, modes), to = s * (Z * V),
            from = s * (V.transpose() * whole_.Z(Eigen::all, modes));
  S.diagonal().array() += s * s + whole_.lambda(modes).array();
  Eigen::VectorXcd force = whole_.b(modes, worst.input);
  Eigen::RowVectorXcd c = s * (s * whole_.ca(worst.output, modes) + whole_.cv(worst.output, modes));
  if (V.cols() > 0) {
    MatrixXcd own = s * model_.Z;
    own.diagonal().array() += s * s + model_.k.array();
    const Eigen::PartialPivLU<MatrixXcd> lu(own);
    const MatrixXcd moved = lu.solve(from);
    const Eigen::RowVectorXcd read =
        s * (s * model_.ca.row(worst.output) + model_.cv.row(worst.output)) +
        model_.cq.row(worst.output);
    S -= to * moved;
    force -= to * lu.solve(MatrixXcd(model_.b.col(worst.input).cast<Complex>()));
    c -= read * moved;
  }
  const Eigen::VectorXcd added = S.partialPivLu().solve(force);
  Eigen::VectorXcd terms = c.transpose().cwiseProduct(added);
  for (std::size_t i = 0; i < modes.size(); ++i)
    if (below_[at(modes[i])])
      terms(static_cast<Index>(i)) -=
          whole_.ca(worst.output, modes[i]) * whole_.b(modes[i], worst.input);
  return terms;
}

bool Sequence::add(VectorXd column) {
  column.head(inside_).setZero();
  const double size = column.norm();
  if (!(size > 0) || !std::isfinite(size)) return false;
  column /= size;
  if (!append(W_, column)) return false;
  added_.conservativeResize(Eigen::NoChange, W_.cols());
  added_.rightCols<1>() = column;
  return true;
}

bool Sequence::add_pending() {
  if (pending_.size() == 0) return false;
  const VectorXd column = std::exchange(pending_, VectorXd());
  return add(column);
}

bool Sequence::add_columns(const WorstPair& worst) {
  const Index n = whole_.elastic();
  if (inside_ == n) return false;
  const double omega = samples_.omega[worst.sample];
  VectorXd weight = VectorXd::Zero(n);
  weight.tail(n - inside_) =
      (whole_.lambda.segment(inside_, n - inside_).array() - omega * omega).inverse();
  const VectorXd b = whole_.b.col(worst.input).head(n), c = reading(whole_, worst.output);
  if (!collocated_) pending_ = weight.cwiseProduct(c);
  if (add(weight.cwiseProduct(b)) || add_pending()) return true;
  // In the span already: the error is due to damping, or to the other end of the band. The residual
  // of the model there.
  const Complex s = samples_.s[worst.sample];
  const Eigen::VectorXcd q = model_.V * model_.response(s, worst.input);
  Eigen::VectorXcd left = whole_.b.col(worst.input).cast<Complex>() - s * s * q -
                          whole_.lambda.cast<Complex>().cwiseProduct(q);
  if (whole_.Z.size() > 0) left -= s * (whole_.Z * q);
  VectorXd first = weight.cwiseProduct(left.real().head(n)),
           second = weight.cwiseProduct(left.imag().head(n));
  if (second.norm() > first.norm()) first.swap(second);
  if (add(first) || add(second)) return true;
  pending_ = weight.cwiseAbs2().cwiseProduct(c);
  return add(weight.cwiseAbs2().cwiseProduct(b)) || add_pending();
}

}  // namespace titop::detail
