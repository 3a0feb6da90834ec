#include <cstdlib>
#include <map>
#include <stdexcept>

#include "methods/blocks_at_s.hpp"

namespace titop_bench {

using Eigen::Index;
using Eigen::MatrixXcd;
using Eigen::MatrixXd;
using Complex = std::complex<double>;

namespace {

/// K by pairs of blocks.
std::map<std::pair<Index, Index>, MatrixXd> couplings(const Network& net, const Places& p) {
  std::map<std::pair<Index, Index>, MatrixXd> list;
  std::vector<Index> of_u(at(net.K.rows())), of_y(at(net.K.cols()));
  for (Index i = 0; i < p.blocks(); ++i) {
    for (Index r = 0; r < p.inputs(i); ++r) of_u[at(p.u[at(i)] + r)] = i;
    for (Index r = 0; r < p.outputs(i); ++r) of_y[at(p.y[at(i)] + r)] = i;
  }
  for (int j = 0; j < net.K.outerSize(); ++j)
    for (Sparse::InnerIterator k(net.K, j); k; ++k) {
      const Index a = of_u[at(k.row())], b = of_y[at(j)];
      MatrixXd& m =
          list.try_emplace({a, b}, MatrixXd::Zero(p.inputs(a), p.outputs(b))).first->second;
      m(k.row() - p.u[at(a)], j - p.y[at(b)]) = k.value();
    }
  return list;
}

std::vector<Index> nonzero_rows(const MatrixXd& m) {
  std::vector<Index> rows;
  for (Index i = 0; i < m.rows(); ++i)
    if (!m.row(i).isZero(0)) rows.push_back(i);
  return rows;
}

/// One march along a chain; columns: external inputs, then the guesses at the first block.
template <class T>
class March {
 public:
  March(const Network& net, Complex s)
      : net_(net),
        p_(net),
        K_(couplings(net, p_)),
        E_(MatrixXd(net.E)),
        F_(MatrixXd(net.F)),
        s_(s) {
    guesses_ = static_cast<Index>(from_next(0).size());
  }

  MatrixXcd transfer() {
    const Index nw = net_.E.cols();
    Table<T> z(net_.F.rows(), nw + guesses_), u = known(0, nullptr), wanted(0, 0), misses(0, 0);
    for (Index i = 0;; ++i) {
      const Table<T> H = response(net_, p_, i, number<T>(s_.real(), s_.imag()));
      if (i == 0)
        for (Index k = 0; k < guesses_; ++k) u(from_next(0)[at(k)], nw + k) += number<T>(1);
      else
        misses = fulfil(i, H, wanted, u);
      const Table<T> y = product(H, u);
      for (Index r = 0; r < z.rows(); ++r)
        for (Index k = 0; k < y.rows(); ++k)
          if (F_(r, p_.y[at(i)] + k) != number<T>(0)) z.subtract(-F_(r, p_.y[at(i)] + k), y, k, r);
      if (i + 1 == p_.blocks()) break;
      wanted = wanted_of_next(i, u);
      u = known(i + 1, &y);
    }
    return closed(z, misses);
  }

 private:
  const MatrixXd* coupling(Index i, Index j) const {
    const auto k = K_.find({i, j});
    return k == K_.end() ? nullptr : &k->second;
  }
  std::vector<Index> from_next(Index i) const {
    const MatrixXd* K = coupling(i, i + 1);
    return K ? nonzero_rows(*K) : std::vector<Index>{};
  }

  /// Inputs of block i without those from the next block.
  Table<T> known(Index i, const Table<T>* y) const {
    Table<T> u(p_.inputs(i), net_.E.cols() + guesses_);
    for (Index r = 0; r < u.rows(); ++r)
      for (Index c = 0; c < net_.E.cols(); ++c) u(r, c) = E_(p_.u[at(i)] + r, c);
    if (const MatrixXd* K = y ? coupling(i, i - 1) : nullptr)
      for (Index r = 0; r < u.rows(); ++r)
        for (Index k = 0; k < K->cols(); ++k)
          if ((*K)(r, k) != 0) u.subtract(number<T>(-(*K)(r, k)), *y, k, r);
    return u;
  }

  /// Values that the next block must supply: rows from_next(i) of u, less the external part there.
  Table<T> wanted_of_next(Index i, const Table<T>& u) const {
    const auto rows = from_next(i);
    Table<T> w(static_cast<Index>(rows.size()), u.cols());
    for (Index r = 0; r < w.rows(); ++r)
      for (Index c = 0; c < w.cols(); ++c)
        w(r, c) = u(rows[at(r)], c) -
                  (c < net_.E.cols() ? E_(p_.u[at(i)] + rows[at(r)], c) : number<T>(0));
    return w;
  }

  /// Chooses the inputs from the next block such that `wanted` is met; returns the remainder that
  /// cannot be met, at the last block.
  Table<T> fulfil(Index i, const Table<T>& H, const Table<T>& wanted, Table<T>& u) const {
    const MatrixXd& K = *coupling(i - 1, i);
    const auto rows = nonzero_rows(K), free = from_next(i);
    Table<T> K_rows(wanted.rows(), K.cols());
    for (Index r = 0; r < K_rows.rows(); ++r)
      for (Index c = 0; c < K.cols(); ++c) K_rows(r, c) = number<T>(K(rows[at(r)], c));
    const Table<T> KH = product(K_rows, H);
    Table<T> missing = product(KH, u);
    for (Index r = 0; r < missing.rows(); ++r)
      for (Index c = 0; c < missing.cols(); ++c) missing(r, c) = wanted(r, c) - missing(r, c);
    if (free.empty()) return missing;
    Table<T> G(KH.rows(), static_cast<Index>(free.size()));
    if (G.rows() != G.cols()) throw std::logic_error("tearing: not a chain");
    for (Index r = 0; r < G.rows(); ++r)
      for (Index c = 0; c < G.cols(); ++c) G(r, c) = KH(r, free[at(c)]);
    solve(std::move(G), missing);
    for (Index k = 0; k < missing.rows(); ++k) u.subtract(number<T>(-1), missing, k, free[at(k)]);
    return Table<T>(0, 0);
  }

  /// The guess for which all misses are 0, put into z.
  MatrixXcd closed(const Table<T>& z, const Table<T>& misses) const {
    const Index nw = net_.E.cols();
    Table<T> guess = part(misses, 0, 0, guesses_, nw);
    solve(part(misses, 0, nw, guesses_, guesses_),
          guess);  // misses = m_w w + m_t t: t = -m_t^-1 m_w w
    Table<T> result = part(z, 0, 0, z.rows(), nw);
    for (Index r = 0; r < z.rows(); ++r)
      for (Index k = 0; k < guesses_; ++k) result.subtract(T(z(r, nw + k)), guess, k, r);
    const Table<T> G{MatrixXd(net_.G)};
    for (Index r = 0; r < z.rows(); ++r) result.subtract(number<T>(-1), G, r, r);
    return result.to_double();
  }

  const Network& net_;
  Places p_;
  std::map<std::pair<Index, Index>, MatrixXd> K_;
  Table<T> E_, F_;
  Complex s_;
  Index guesses_ = 0;
};

template <class T>
MatrixXcd tearing(const Network& net, Complex s) {
  return March<T>(net, s).transfer();
}

}  // namespace

bool is_chain(const Network& network) {
  const Places p(network);
  const auto K = couplings(network, p);
  for (const auto& [pair, m] : K)
    if (std::abs(pair.first - pair.second) != 1) return false;
  for (Index i = 1; i < p.blocks(); ++i) {
    const auto back = K.find({i - 1, i});
    if (back == K.end() || K.find({i, i - 1}) == K.end()) return false;
    const auto next = K.find({i, i + 1});
    if (next != K.end() && nonzero_rows(next->second).size() != nonzero_rows(back->second).size())
      return false;
  }
  return p.blocks() > 1;
}

MatrixXcd tearing_at_s(const Network& network, Complex s, Digits digits) {
  if (!is_chain(network)) throw std::logic_error("tearing: not a chain");
  TITOP_BENCH_IN(tearing, network, s, digits);
}

}  // namespace titop_bench
