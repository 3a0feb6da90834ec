#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <titop/analysis/reduction/split.hpp>
#include <titop/graph/error.hpp>
#include <titop/graph/linalg/eigen.hpp>
#include <titop/graph/linalg/schur.hpp>
#include <titop/graph/linalg/similarity_scaling.hpp>

namespace titop::detail {
namespace {

using Complex = std::complex<double>;
using Eigen::Index;
using Eigen::MatrixXcd;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr double kRealPart = 1e4;   ///< of |A|, in roundings: real part of an undamped pole
constexpr double kTogether = 1e6;   ///< largest transformation between two parts
constexpr double kAllAlike = 1e-3;  ///< weight of states without effect, as if all had the same
constexpr double kAtRest = 1e-10;   ///< |s| over |A| of a pole that may be 0

/// States by the pattern of A: those that no state depends on, the core, those that depend on no
/// state; in an order that makes A block upper triangular with strict triangles at both ends.
struct PeeledStates {
  std::vector<Index> sinks, core, sources;
};

PeeledStates peel(const MatrixXd& A) {
  PeeledStates p;
  for (Index i = 0; i < A.rows(); ++i) p.core.push_back(i);
  const auto take = [&](std::vector<Index>& to, auto stands_alone) {
    const auto found = std::find_if(p.core.begin(), p.core.end(), stands_alone);
    if (found == p.core.end()) return false;
    to.push_back(*found);
    p.core.erase(found);
    return true;
  };
  const auto free = [&](Index i, Index j) { return A(i, j) == 0; };
  const auto all = [&](auto test) { return std::all_of(p.core.begin(), p.core.end(), test); };
  while (take(p.sinks, [&](Index j) { return all([&](Index i) { return free(i, j); }); })) {
  }
  while (take(p.sources, [&](Index i) { return all([&](Index j) { return free(i, j); }); })) {
  }
  std::reverse(p.sources.begin(), p.sources.end());
  return p;
}

/// Columns Q that span a subspace closed under conjugation: a real orthonormal basis of it.
MatrixXd real_basis(const MatrixXcd& Q) {
  MatrixXd both(Q.rows(), 2 * Q.cols());
  both << Q.real(), Q.imag();
  if (Q.cols() == 0) return both;
  return Eigen::ColPivHouseholderQR<MatrixXd>(both).householderQ() *
         MatrixXd::Identity(Q.rows(), Q.cols());
}

/// The core in its own units, and its Schur form with the kept part in front.
class Core {
 public:
  Core(const StateSpace& m, const PeeledStates& p) : A_(m.A(p.core, p.core)) {
    for (const Index i : p.core)
      if (const auto k = static_cast<std::size_t>(i); k < m.states.size())
        names_.push_back(m.states[k]);
      else
        names_.push_back(fmt::format("state {}", i + 1));
    scale_ = linalg::similarity_scaling(A_);
    schur_ = linalg::schur(A_);
  }
  const MatrixXd& A() const { return A_; }
  const VectorXd& scale() const { return scale_; }
  const linalg::Schur& schur() const { return schur_; }
  Index order() const { return A_.rows(); }
  Complex pole(Index i) const { return schur_.T(i, i); }
  double norm() const { return A_.size() ? A_.norm() : 0; }
  bool has_zero() const {
    return order() > 0 && schur_.T.diagonal().cwiseAbs().minCoeff() <= kAtRest * norm();
  }
  /// Separates kept and stable.
  void divide() {
    if (try_divide(kUndamped)) return;
    const Error error = inseparable();
    for (near = 10 * kUndamped; near < 1; near *= 10)
      if (try_divide(near)) return;
    throw error;
  }
  Index kept = 0;
  double near = kUndamped;    ///< damping ratio up to which poles are kept
  MatrixXd V_kept, V_stable;  ///< order x kept, order x the rest; orthonormal
  MatrixXd over;              ///< kept x stable: right = V_stable + V_kept * over
  MatrixXcd U;                ///< of the stable part's own Schur form

 private:
  bool is_kept(Index i, double ratio) const {
    const double least =
        ratio / kUndamped * kRealPart * std::numeric_limits<double>::epsilon() * norm();
    return -pole(i).real() <= std::max(ratio * std::abs(pole(i)), least);
  }
  bool try_divide(double ratio) {
    std::vector<char> first;
    for (Index i = 0; i < order(); ++i) first.push_back(is_kept(i, ratio));
    kept = std::count(first.begin(), first.end(), 1);
    const Index n = order(), rest = n - kept;
    linalg::reorder(schur_, first);
    V_kept = real_basis(schur_.Q.leftCols(kept));
    V_stable = real_basis(schur_.Q.rightCols(rest));
    const MatrixXcd U_kept = V_kept.transpose().cast<Complex>() * schur_.Q.leftCols(kept);
    U = V_stable.transpose().cast<Complex>() * schur_.Q.rightCols(rest);
    const MatrixXcd Y = linalg::sylvester(schur_.T.topLeftCorner(kept, kept),
                                          schur_.T.bottomRightCorner(rest, rest),
                                          -schur_.T.topRightCorner(kept, rest));
    over = (U_kept * Y * U.adjoint()).real();
    return over.size() == 0 || over.norm() <= kTogether;
  }

  /// Names the pole nearest the axis of those that are not kept, and the state that is largest in
  /// it: the first column of a Schur form that begins with a pole is its eigenvector.
  Error inseparable() const {
    Index nearest = kept, state = 0;
    for (Index i = kept; i < order(); ++i)
      if (pole(i).real() > pole(nearest).real()) nearest = i;
    std::vector<char> first(static_cast<std::size_t>(order()), 0);
    first[static_cast<std::size_t>(nearest)] = 1;
    linalg::Schur s = schur_;
    linalg::reorder(s, first);
    s.Q.col(0).cwiseAbs().maxCoeff(&state);
    return Error(Code::singular,
                 fmt::format("{} has most of a pole at {:.3g}{:+.3g}j, which cannot be separated "
                             "from those on the axis",
                             names_[static_cast<std::size_t>(state)], pole(nearest).real(),
                             pole(nearest).imag()),
                 "their eigenvectors are nearly dependent: leave out the outputs that read it, or "
                 "use compile(diagram)");
  }

  MatrixXd A_;
  VectorXd scale_;
  linalg::Schur schur_;
  std::vector<std::string> names_;
};

/// Both ends in the core's coordinates, without the coupling between core and ends.
struct DecoupledEnds {
  MatrixXd from_core;  ///< sinks x core: a sink is z + from_core * core
  MatrixXd to_core;    ///< core x sources: the core is z + to_core * sources
};

DecoupledEnds decouple(const StateSpace& m, const PeeledStates& p, const Core& core) {
  const MatrixXcd &T = core.schur().T, &Q = core.schur().Q;
  const MatrixXd A_pc = m.A(p.sinks, p.core) * core.scale().asDiagonal(),
                 A_cr = core.scale().cwiseInverse().asDiagonal() * m.A(p.core, p.sources);
  const MatrixXcd N_p = m.A(p.sinks, p.sinks).cast<Complex>(),
                  N_r = m.A(p.sources, p.sources).cast<Complex>();
  DecoupledEnds e;
  e.from_core = (linalg::sylvester(N_p, T, -(A_pc.cast<Complex>() * Q)) * Q.adjoint()).real();
  e.to_core = (Q * linalg::sylvester(T, N_r, -(Q.adjoint() * A_cr.cast<Complex>()))).real();
  return e;
}

/// Rows of the states x columns of a part of the core, in the states' own units.
MatrixXd spread(const MatrixXd& V, const PeeledStates& p, const VectorXd& scale, Index n) {
  MatrixXd result = MatrixXd::Zero(n, V.cols());
  result(p.core, Eigen::all) = scale.asDiagonal() * V;
  return result;
}

/// Removes states that reach no output or that no input reaches, by the pattern.
SpectralPart without_idle(SpectralPart p) {
  std::vector<Index> stay;
  for (Index i = 0; i < p.order(); ++i) stay.push_back(i);
  const auto idle = [&](Index i) {
    bool acts = !p.C.col(i).isZero(0), moves = !p.B.row(i).isZero(0);
    for (const Index j : stay) acts |= p.A(j, i) != 0, moves |= p.A(i, j) != 0;
    return !acts || !moves;
  };
  for (auto found = stay.begin(); found != stay.end();) {
    found = std::find_if(stay.begin(), stay.end(), idle);
    if (found != stay.end()) stay.erase(found), found = stay.begin();
  }
  return {p.A(stay, stay), p.B(stay, Eigen::all), p.C(Eigen::all, stay), p.left(stay, Eigen::all),
          p.right(Eigen::all, stay)};
}

SpectralPart integrals(const StateSpace& m, const PeeledStates& p, const Core& core,
                       const DecoupledEnds& e, const MatrixXd& B_core, const MatrixXd& C_core) {
  const auto sinks = static_cast<Index>(p.sinks.size()),
             sources = static_cast<Index>(p.sources.size()), n = sinks + sources;
  const MatrixXd A_cr = core.scale().cwiseInverse().asDiagonal() * m.A(p.core, p.sources);
  SpectralPart part;
  part.A = MatrixXd::Zero(n, n);
  part.A.topLeftCorner(sinks, sinks) = m.A(p.sinks, p.sinks);
  part.A.bottomRightCorner(sources, sources) = m.A(p.sources, p.sources);
  part.A.topRightCorner(sinks, sources) = MatrixXd(m.A(p.sinks, p.sources)) - e.from_core * A_cr;
  part.B.resize(n, m.B.cols());
  part.B << MatrixXd(m.B(p.sinks, Eigen::all)) - e.from_core * B_core, m.B(p.sources, Eigen::all);
  part.C.resize(m.C.rows(), n);
  part.C << m.C(Eigen::all, p.sinks), MatrixXd(m.C(Eigen::all, p.sources)) + C_core * e.to_core;
  part.left = MatrixXd::Zero(n, m.A.rows());
  part.right = MatrixXd::Zero(m.A.rows(), n);
  std::vector<Index> states = p.sinks;
  states.insert(states.end(), p.sources.begin(), p.sources.end());
  for (Index j = 0; j < n; ++j)
    part.left(j, states[static_cast<std::size_t>(j)]) =
        part.right(states[static_cast<std::size_t>(j)], j) = 1;
  return without_idle(std::move(part));
}

Split assemble(const StateSpace& m, const PeeledStates& p, const Core& core) {
  const DecoupledEnds e = decouple(m, p, core);
  const Index n = m.A.rows(), rest = core.order() - core.kept;
  const MatrixXd B_own = core.scale().cwiseInverse().asDiagonal() * m.B(p.core, Eigen::all);
  const MatrixXd C_core = MatrixXd(m.C(Eigen::all, p.core) * core.scale().asDiagonal()) +
                          m.C(Eigen::all, p.sinks) * e.from_core;
  Split s;
  s.integrals = integrals(m, p, core, e, B_own, C_core);
  const MatrixXd B_core = B_own - e.to_core * m.B(p.sources, Eigen::all);
  const VectorXd inverse = core.scale().cwiseInverse();
  const auto part = [&](const MatrixXd& left, const MatrixXd& right, const MatrixXd& A) {
    return SpectralPart{A, left * B_core, C_core * right,
                        spread(left.transpose(), p, inverse, n).transpose(),
                        spread(right, p, core.scale(), n)};
  };
  s.kept = part(core.V_kept.transpose() - core.over * core.V_stable.transpose(), core.V_kept,
                core.V_kept.transpose() * core.A() * core.V_kept);
  s.U = core.U;
  s.near = core.near;
  s.T = core.schur().T.bottomRightCorner(rest, rest);
  s.stable = part(core.V_stable.transpose(), core.V_stable + core.V_kept * core.over,
                  core.V_stable.transpose() * core.A() * core.V_stable);
  s.poles.assign(p.sinks.size() + p.sources.size(), 0);
  for (Index i = 0; i < core.order(); ++i)
    if (const Complex at = core.pole(i); at.imag() >= 0)
      s.poles.push_back(i < core.kept && std::abs(at) <= kAtRest * core.norm() ? 0 : at);
  return s;
}

/// (s - A)^-1 B of a small part.
MatrixXcd solve(const SpectralPart& p, Complex s) {
  if (p.order() == 0) return MatrixXcd(0, p.B.cols());
  MatrixXcd S = -p.A.cast<Complex>();
  S.diagonal().array() += s;
  return S.partialPivLu().solve(MatrixXcd(p.B.cast<Complex>()));
}

}  // namespace

Split split(const StateSpace& m) {
  PeeledStates peeled = peel(m.A);
  Core core(m, peeled);
  if (core.has_zero() && core.order() < m.A.rows()) {  // integrals of integrals: all in one part
    peeled = {};
    for (Index i = 0; i < m.A.rows(); ++i) peeled.core.push_back(i);
    core = Core(m, peeled);
  }
  core.divide();
  Split result = assemble(m, peeled, core);
  result.reading = reading(m);
  return result;
}

VectorXd reading(const StateSpace& m) {
  MatrixXd A = m.A;
  return m.C.cwiseAbs() * linalg::similarity_scaling(A);
}

MatrixXd terms(const StateSpace& m, const Split& split, Complex s) {
  if (m.order() == 0) return m.D.cwiseAbs();
  MatrixXcd stable = split.U.adjoint() * split.stable.B.cast<Complex>(), shifted = -split.T;
  shifted.diagonal().array() += s;
  if (stable.rows() > 0) shifted.triangularView<Eigen::Upper>().solveInPlace(stable);
  const MatrixXcd x = split.stable.right * (split.U * stable) +
                      split.kept.right * solve(split.kept, s) +
                      split.integrals.right * solve(split.integrals, s);
  // Floor for outputs that are 0 by symmetry, up to rounding: as if all states were as large as the
  // largest one, each in its unit.
  const VectorXd unit =
      (split.stable.right.rowwise().squaredNorm() + split.kept.right.rowwise().squaredNorm() +
       split.integrals.right.rowwise().squaredNorm())
          .cwiseSqrt();
  const VectorXd inverse = (unit.array() > 0).select(unit.cwiseInverse(), 0);
  const MatrixXd far = (inverse.asDiagonal() * x).cwiseAbs().colwise().maxCoeff();
  const MatrixXd alike = kAllAlike * (m.C.cwiseAbs() * unit).cwiseMax(split.reading) * far;
  return m.C.cwiseAbs() * x.cwiseAbs() + alike + m.D.cwiseAbs();
}

}  // namespace titop::detail
