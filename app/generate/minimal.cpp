#include "generate/assembly.hpp"

namespace titop::generate {
namespace {

/// Of its largest entry: a column with a smaller remainder depends on the others.
constexpr double kDependent = 1e-40;

/// Columns that span B, A B, A^2 B ..., each made of A times one before it, pivots set apart.
template <class S>
struct Krylov {
  std::vector<std::vector<S>> vectors;
  std::vector<std::size_t> pivots;

  Krylov(const Table<S>& A, const Table<S>& B) {
    for (std::size_t j = 0; j < B.cols(); ++j) take(column(B, j));
    for (std::size_t k = 0; k < vectors.size(); ++k) {
      std::vector<S> next(A.rows(), S(0));
      for (std::size_t i = 0; i < A.rows(); ++i)
        for (std::size_t j = 0; j < A.cols(); ++j) next[i] += A(i, j) * vectors[k][j];
      take(std::move(next));
    }
  }
  static std::vector<S> column(const Table<S>& B, std::size_t j) {
    std::vector<S> v;
    for (std::size_t i = 0; i < B.rows(); ++i) v.push_back(B(i, j));
    return v;
  }
  void take(std::vector<S> v) {
    double size = 0;
    for (const S& x : v) size = std::max(size, magnitude(x));
    for (std::size_t k = 0; k < vectors.size(); ++k) {
      const S f = v[pivots[k]];
      for (std::size_t i = 0; i < v.size(); ++i) v[i] -= f * vectors[k][i];
    }
    std::size_t pivot = 0;
    double best = 0;
    for (std::size_t i = 0; i < v.size(); ++i)
      if (magnitude(v[i]) > best) best = magnitude(v[i]), pivot = i;
    if (best <= kDependent * size) return;
    const S inverse = S(1) / v[pivot];
    for (S& x : v) x = x * inverse;
    vectors.push_back(std::move(v));
    pivots.push_back(pivot);
  }
};

/// The model restricted to its controllable subspace.
template <class S>
FirstOrder<S> moved(const FirstOrder<S>& m) {
  const Krylov<S> space(m.A, m.B);
  Table<S> V(m.A.rows(), space.vectors.size());
  for (std::size_t j = 0; j < V.cols(); ++j)
    for (std::size_t i = 0; i < V.rows(); ++i) V(i, j) = space.vectors[j][i];
  const Table<S> square = V.rows(space.pivots);
  return {solve(square, (m.A * V).rows(space.pivots)), solve(square, m.B.rows(space.pivots)),
          m.C * V, m.D};
}

template <class S>
FirstOrder<S> dual(const FirstOrder<S>& m) {
  return {m.A.transposed(), m.C.transposed(), m.B.transposed(), m.D.transposed()};
}

}  // namespace

template <class S>
FirstOrder<S> minimal(const FirstOrder<S>& model) {
  return dual(moved(dual(moved(model))));
}

template FirstOrder<Mod> minimal(const FirstOrder<Mod>&);
template FirstOrder<Digits> minimal(const FirstOrder<Digits>&);

}  // namespace titop::generate
