#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <titop/compiler/solve/kernels.hpp>
#include <titop/compiler/solve/response.hpp>
#include <titop/compiler/solve/scalar.hpp>
#include <titop/graph/closed_form.hpp>
#include <titop/graph/linalg/dense.hpp>
#include <titop/graph/linalg/index.hpp>
#include <titop/graph/pole.hpp>

namespace titop::solve {

/// For single blocks only, where fewer digits cancel.
using Complex100 = boost::multiprecision::cpp_complex_100;

template <>
struct Scalar<Complex100> {
  static double epsilon() { return 1e-100; }
  static double size(const Complex100& x) {
    return static_cast<double>(abs(x.real()) + abs(x.imag()));
  }
  static Complex100 from(double x) { return Complex100(x); }
  static std::complex<double> round(const Complex100& x) {
    return {static_cast<double>(x.real()), static_cast<double>(x.imag())};
  }
};

}  // namespace titop::solve

namespace titop::detail {
namespace {

using Eigen::Index;
using linalg::at;
using solve::Dense;
using solve::lift;
using solve::lifted;

template <class T>
solve::BlockResponse<T> response_in_double(const Block& block, const T& s,
                                           ParameterValues parameters) {
  Block::Response r = block.response(solve::Scalar<T>::round(s), parameters);
  if constexpr (std::is_same_v<T, std::complex<double>>)
    return {std::move(r.X), std::move(r.Y)};
  else
    return {lifted<T>(r.X), lifted<T>(r.Y)};
}

/// Doubles that hold all digits of T: one, two up to 32 digits, four up to 50.
template <class T>
int doubles_of() {
  const double epsilon = solve::Scalar<T>::epsilon();
  return epsilon > 1e-17 ? 1 : epsilon > 1e-33 ? 2 : 4;
}

/// Of a block without a finite state space.
template <class T>
solve::BlockResponse<T> closed_response(const ClosedForm& block, const T& s,
                                        ParameterValues parameters) {
  solve::BlockResponse<T> r;
  for (const Eigen::MatrixXcd& part :
       block.closed_form(solve::Scalar<T>::round(s), parameters, doubles_of<T>())) {
    if (r.Y.size() == 0) r.Y = Dense<T>::Constant(part.rows(), part.cols(), T(0));
    r.Y += lifted<T>(part);
  }
  r.X.resize(0, r.Y.cols());
  return r;
}

template <class T>
Error pole_of(const Block& block, const T& at_s) {
  return pole_at(solve::Scalar<T>::round(at_s), fmt::format("a {}", block.type()));
}

/// Y = rigid + W' diag(s^2 / d) W, d = s^2 + damping s + stiffness.
template <class T>
solve::BlockResponse<T> modal_response(const Block& block, const Modal& m, const T& s) {
  const auto n = m.W.rows();
  const Dense<T> W = lifted<T>(m.W);
  solve::BlockResponse<T> r{Dense<T>(2 * n, W.cols()), lifted<T>(m.rigid)};
  for (Index i = 0; i < n; ++i) {
    const T d = s * s + lift<T>(m.damping(i)) * s + lift<T>(m.stiffness(i));
    if (d == T(0)) throw pole_of(block, s);
    for (Index j = 0; j < W.cols(); ++j) {
      r.X(i, j) = W(i, j) / d;
      r.X(n + i, j) = s * r.X(i, j);
      for (Index k = 0; k < W.cols(); ++k) r.Y(k, j) += W(i, k) * s * r.X(n + i, j);
    }
  }
  return r;
}

/// Cancelling terms of an entry of X or Y over the entry, allowed per state: magnitudes add up,
/// rounding does not, and this much is usual in an LU.
constexpr double kTerms = 100;

/// The precision to use if one has too few digits; void: there is none.
template <class T>
struct FinerScalar {
  using type = void;
};
template <>
struct FinerScalar<std::complex<long double>> {
  using type = std::complex<solve::DoubleDouble>;
};
template <>
struct FinerScalar<std::complex<solve::DoubleDouble>> {
  using type = solve::Complex100;
};
template <>
struct FinerScalar<solve::Complex50> {
  using type = solve::Complex100;
};

template <class To, class From>
To real_as(const From& x) {
  if constexpr (std::is_same_v<To, solve::DoubleDouble>) {
    const double high = static_cast<double>(x);
    return To(high) + To(static_cast<double>(From(x - From(high))));
  } else if constexpr (std::is_same_v<From, solve::DoubleDouble>) {
    const double high = static_cast<double>(x);
    return To(high) + To(static_cast<double>(x - From(high)));
  } else {
    return static_cast<To>(x);
  }
}

/// z in another precision.
template <class To, class From>
To as(const From& z) {
  using Real = std::decay_t<decltype(std::declval<const To&>().real())>;
  using Part = std::decay_t<decltype(z.real())>;
  return To(real_as<Real>(Part(z.real())), real_as<Real>(Part(z.imag())));
}

template <class To, class From>
Dense<To> as(const Dense<From>& m) {
  return m.unaryExpr([](const From& z) -> To { return as<To>(z); });
}

template <class T>
Eigen::MatrixXd sizes(const Dense<T>& m) {
  return m.unaryExpr([](const T& x) -> double { return solve::size_of(x); });
}

/// The largest of terms / size, entry by entry; a 0 without terms is one. Infinite if a number
/// is none.
double largest_ratio(const Eigen::MatrixXd& terms, const Eigen::MatrixXd& size) {
  double result = 0;
  for (Index i = 0; i < size.size(); ++i) {
    if (terms(i) == 0) continue;
    const double ratio = terms(i) / size(i);
    if (std::isnan(ratio)) return HUGE_VAL;
    result = std::max(result, ratio);
  }
  return result;
}

/// Fewer states are solved in one part: their n^3 steps cost no more than the search for parts.
constexpr Index kManyStates = 16;

/// States that do not act on each other: all in one part if they are few.
using StateGroups = std::vector<std::vector<int>>;
StateGroups uncoupled(const Eigen::MatrixXd& A) {
  if (A.rows() >= kManyStates) return linalg::uncoupled_parts(A);
  std::vector<int> all(at(A.rows()));
  std::iota(all.begin(), all.end(), 0);
  return {std::move(all)};
}

Dynamics part_of(const Dynamics& d, const std::vector<int>& states) {
  return {d.A(states, states), d.B(states, Eigen::all), d.C(Eigen::all, states), d.D};
}

/// Largest ratio of the terms of an entry of X and Y to the entry; with K = s - A the terms are
/// |K^-1| |K| |X| and |D| + |C| |X| + |C K^-1| |K| |X|, independent of the units of states and
/// ports. Infinite if double has less than two digits of K^-1.
template <class T>
double cancels(const Dynamics& d, const StateGroups& parts, const T& s,
               const solve::BlockResponse<T>& r) {
  using Eigen::MatrixXcd;
  using Eigen::MatrixXd;
  const MatrixXd X = sizes(r.X), Y = sizes(r.Y);
  if (!X.allFinite() || !Y.allFinite()) return HUGE_VAL;
  MatrixXd of_outputs = d.D.cwiseAbs() + d.C.cwiseAbs() * X;
  double worst = 0;
  for (const std::vector<int>& states : parts) {
    const auto n = std::ssize(states);
    const MatrixXcd one = MatrixXcd::Identity(n, n),
                    K = solve::Scalar<T>::round(s) * one - d.A(states, states);
    const linalg::Solution solution = linalg::solve(K, one);
    const MatrixXcd& inverse = solution.z;
    const double two_digits = 100 * static_cast<double>(n) * solve::Scalar<double>::epsilon();
    if (!(solution.rcond > two_digits) || !inverse.allFinite()) return HUGE_VAL;
    const MatrixXd own = X(states, Eigen::all), right = K.cwiseAbs() * own;
    worst = std::max(worst, largest_ratio(inverse.cwiseAbs() * right, own));
    of_outputs += (d.C(Eigen::all, states) * inverse).cwiseAbs() * right;
  }
  return std::max(worst, largest_ratio(of_outputs, Y));
}

/// (s - A)^-1 B. Throws singular.
template <class T>
Dense<T> states_at(const Block& block, const Dynamics& d, const StateGroups& parts, const T& s) {
  Dense<T> X(d.A.rows(), d.B.cols());
  for (const std::vector<int>& states : parts) {
    const Dynamics part = part_of(d, states);
    const Resolvent<T> resolvent(part, s);
    if (resolvent.singular()) throw pole_of(block, s);
    X(states, Eigen::all) = resolvent.times(lifted<T>(part.B));
  }
  return X;
}

/// From the matrices, each entry accurate to `enough`. C X + D cancels, the more the lower s is
/// below the block's own frequencies: if T has too few digits, a finer precision is used. (100
/// digits always suffice: 1e-88 of its terms is 0, as a notch at its frequency.)
template <class T>
solve::BlockResponse<T> general_response(const Block& block, const Dynamics& d, const T& s,
                                         double enough) {
  const StateGroups parts = uncoupled(d.A);
  solve::BlockResponse<T> r{states_at(block, d, parts, s), lifted<T>(d.D)};
  for (Index i = 0; i < r.Y.rows(); ++i)
    for (Index j = 0; j < r.Y.cols(); ++j)
      for (Index k = 0; k < r.X.rows(); ++k) r.Y(i, j) += lift<T>(d.C(i, k)) * r.X(k, j);
  using More = typename FinerScalar<T>::type;
  if constexpr (!std::is_void_v<More>)
    if (d.A.rows() > 0 && !(cancels(d, parts, s, r) * solve::Scalar<T>::epsilon() <= enough)) {
      const solve::BlockResponse<More> finer = general_response(block, d, as<More>(s), enough);
      return {as<T>(finer.X), as<T>(finer.Y)};
    }
  return r;
}

/// Columns right of k, or right-hand sides, `count` of them, of as many rows as lu, n x n: x -=
/// (column k of L) x(k), below row k.
template <class T>
void reduce(Index n, const T* lu, Index k, Index count, T* columns) {
  for (T* x = columns; x != columns + count * n; x += n)
    if (const T by = x[k]; by != T(0))
      solve::subtract(n - k - 1, by, lu + k * n + k + 1, x + k + 1);
}

/// Rows a and b of n x columns numbers, column-major, change places.
template <class T>
void swap_rows(Index n, Index columns, T* x, Index a, Index b) {
  for (T* const end = x + columns * n; x != end; x += n) std::swap(x[a], x[b]);
}

/// States part by part, those that act first; pivots are chosen within a part, as in units in which
/// its rows and columns have equal norms.
struct PartOrder {
  boost::container::small_vector<Index, 4> states;
  boost::container::small_vector<Index, 4> end;      ///< of the part of each of these
  boost::container::small_vector<double, 4> weight;  ///< one over the unit of each
};

PartOrder by_graph(const Eigen::MatrixXd& A) {
  PartOrder order;
  const std::vector<std::vector<int>> parts = linalg::parts(A);
  for (auto part = parts.rbegin(); part != parts.rend(); ++part) {
    order.states.insert(order.states.end(), part->begin(), part->end());
    order.end.resize(order.states.size(), std::ssize(order.states));
    Eigen::MatrixXd own = A(*part, *part);
    for (const double unit : linalg::similarity_scaling(own)) order.weight.push_back(1 / unit);
  }
  return order;
}

PartOrder in_parts(const Eigen::MatrixXd& A) {
  const Index n = A.rows();
  if (n < 2) return {{0}, {n}, {1}};
  if (n == 2 && A(0, 1) != 0)  // many blocks: without a graph
    return A(1, 0) != 0 ? PartOrder{{0, 1}, {2, 2}, {1, 1}} : PartOrder{{1, 0}, {1, 2}, {1, 1}};
  return by_graph(A);
}

}  // namespace

template <class T>
Resolvent<T>::Resolvent(const Dynamics& dynamics, const T& s)
    : modal_(dynamics.modal.get()), s_(s), n_(dynamics.A.rows()) {
  if (modal_) return;
  PartOrder order = in_parts(dynamics.A);
  lu_.reserve(at(n_ * n_));
  for (Index j = 0; j < n_; ++j)
    for (Index i = 0; i < n_; ++i)
      lu_.push_back(-lift<T>(dynamics.A(order.states[at(i)], order.states[at(j)])));
  row_.reserve(at(n_));
  T* const lu = lu_.data();
  for (Index i = 0; i < n_; ++i) lu[i + i * n_] += s;
  for (Index k = 0; k < n_; ++k) {
    T* const column = lu + k * n_;
    Index best = k;
    double most = 0;
    for (Index i = k; i < order.end[at(k)]; ++i)
      if (const double size = solve::size_of(column[i]) * order.weight[at(i)]; size > most)
        best = i, most = size;
    row_.push_back(best);
    if (best != k) {
      swap_rows(n_, n_, lu, k, best);
      std::swap(order.weight[at(k)], order.weight[at(best)]);
    }
    for (Index i = k + 1; i < n_; ++i) column[i] /= column[k];
    reduce(n_, lu, k, n_ - k - 1, column + n_);
  }
  if (n_ > 0 && !std::ranges::is_sorted(order.states)) state_ = std::move(order.states);
}

template <class T>
bool Resolvent<T>::singular() const {
  for (Index k = 0; k < n_ && !modal_; ++k)
    if (lu_[at(k + k * n_)] == T(0)) return true;
  return false;
}

template <class T>
Dense<T> Resolvent<T>::times(Dense<T> r) const {
  apply(r.cols(), r.data());
  return r;
}

template <class T>
void Resolvent<T>::apply(Index columns, T* r) const {
  if (modal_) return apply_modes(columns, r);
  if (!state_.empty()) {
    const solve::Dense<T> given = Eigen::Map<const solve::Dense<T>>(r, n_, columns);
    Eigen::Map<solve::Dense<T>>(r, n_, columns) = given(state_, Eigen::all);
  }
  const T* const lu = lu_.data();
  // L is in the last order of the rows: all of them change places first.
  for (Index k = 0; k < n_; ++k)
    if (row_[at(k)] != k) swap_rows(n_, columns, r, k, row_[at(k)]);
  for (Index k = 0; k < n_; ++k) reduce(n_, lu, k, columns, r);
  for (T* x = r; x != r + columns * n_; x += n_)
    for (Index k = n_; k-- > 0;) {
      x[k] /= lu[k + k * n_];
      solve::subtract(k, x[k], lu + k * n_, x);
    }
  if (state_.empty()) return;
  const solve::Dense<T> found = Eigen::Map<const solve::Dense<T>>(r, n_, columns);
  Eigen::Map<solve::Dense<T>>(r, n_, columns)(state_, Eigen::all) = found;
}

template <class T>
void Resolvent<T>::apply_modes(Index columns, T* r) const {
  const Index modes = modal_->stiffness.size();
  for (Index i = 0; i < modes; ++i) {
    const T c = lift<T>(modal_->damping(i)), d = s_ * s_ + c * s_ + lift<T>(modal_->stiffness(i));
    for (T* x = r; x != r + columns * n_; x += n_) {
      const T eta = ((s_ + c) * x[i] + x[modes + i]) / d;
      x[modes + i] = s_ * eta - x[i];
      x[i] = eta;
    }
  }
}

template <class T>
solve::BlockResponse<T> response(const Block& block, const Dynamics& d, const T& s,
                                 ParameterValues parameters) {
  if (const ClosedForm* closed = closed_form_of(block))
    return closed_response(*closed, s, parameters);
  if (solve::Scalar<T>::epsilon() > 1e-16) return response_in_double(block, s, parameters);
  if (d.modal) return modal_response(block, *d.modal, s);
  const double states = static_cast<double>(d.A.rows());
  return general_response(block, d, s, kTerms * states * solve::Scalar<T>::epsilon());
}

#define TITOP_INSTANTIATE(T)                                                         \
  template class Resolvent<T>;                                                       \
  template solve::BlockResponse<T> response(const Block&, const Dynamics&, const T&, \
                                            ParameterValues);
TITOP_INSTANTIATE(double)
TITOP_COMPLEX_SCALARS(TITOP_INSTANTIATE)
#undef TITOP_INSTANTIATE

}  // namespace titop::detail
