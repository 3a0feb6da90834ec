#include <titop/compiler/solve/null_rows.hpp>

namespace titop::solve {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::RowVectorXd;

std::size_t at(Index i) { return static_cast<std::size_t>(i); }

/// x L = c, front by front: first U transposed from the leaves to the root, then L transposed back.
class Transposed {
 public:
  explicit Transposed(const Factors<double>& factors) : f_(factors), plan_(factors.plan()) {}

  RowVectorXd solve(const RowVectorXd& c) {
    c_.resize(at(c.size()));
    for (Index i = 0; i < c.size(); ++i) c_[at(i)] = {c(i), std::abs(c(i))};
    carried_.assign(at(plan_.carried), {});
    x_ = RowVectorXd::Zero(c.size());
    for (std::size_t f = 0; f < plan_.fronts.size(); ++f) upward(f);
    for (std::size_t f = plan_.fronts.size(); f-- > 0;) downward(f);
    return x_;
  }

 private:
  void upward(std::size_t index) {
    const Front& f = plan_.fronts[index];
    const double* lu = f_.made(index).lu.data();
    const std::ptrdiff_t n = f.columns();
    for (int k = 0; k < f.pivot_count; ++k) {
      Kept& own = c_[at(f.first_unknown + k)];
      const double pivot = lu[k * n + k];
      own = settled({own.value / pivot, own.size / std::abs(pivot)});
      if (own.size == 0) continue;
      for (int j = k + 1; j < f.pivot_count; ++j)
        pass(own, lu[k * n + j], c_[at(f.first_unknown + j)]);
      int column = f.pivot_count;
      for (const int v : plan_.list(f.border))
        for (int i = 0; i < plan_.structure.variable_size[at(v)]; ++i, ++column)
          pass(own, lu[k * n + column], c_[at(plan_.first[at(v)] + i)]);
    }
  }

  void downward(std::size_t index) {
    const Front& f = plan_.fronts[index];
    const Factors<double>::Made& made = f_.made(index);
    const std::ptrdiff_t n = f.columns();
    std::vector<Kept> b(at(f.row_count));
    for (int i = 0; i < f.pivot_count; ++i) b[at(i)] = c_[at(f.first_unknown + i)];
    for (int i = f.pivot_count; i < f.row_count; ++i)
      b[at(i)] = carried_[at(f.first_carried + i - f.pivot_count)];
    for (int k = f.pivot_count - 1; k >= 0; --k) {
      for (int i = k + 1; i < f.row_count; ++i) pass(b[at(i)], made.lu[at(i * n + k)], b[at(k)]);
      b[at(k)] = settled(b[at(k)]);
    }
    std::vector<Kept> assembled(b.size());
    for (std::size_t i = 0; i < b.size(); ++i) assembled[at(made.order[i])] = b[i];
    int place = 0;
    for (const int r : plan_.list(f.rows))
      for (int i = 0; i < plan_.structure.row_size[at(r)]; ++i)
        x_(plan_.row_first[at(r)] + i) = assembled[at(place++)].value;
    for (const int c : plan_.list(f.children)) {
      const Front& child = plan_.fronts[at(c)];
      for (int i = 0; i < child.left_over(); ++i)
        carried_[at(child.first_carried + i)] = assembled[at(place++)];
    }
  }

  static void pass(const Kept& from, double factor, Kept& to) {
    to.add(-factor * from.value, std::abs(factor) * from.size);
  }

  const Factors<double>& f_;
  const Plan& plan_;
  std::vector<Kept> c_, carried_;
  RowVectorXd x_;
};

/// p M = 0 by row operations.
struct LeftNull {
  MatrixXd M, size;
  std::vector<int> rows = {}, columns = {};  ///< not pivots yet

  explicit LeftNull(KeptMatrix m) : M(std::move(m.value)), size(std::move(m.size)) {
    for (int i = 0; i < M.rows(); ++i) rows.push_back(i);
    for (int j = 0; j < M.cols(); ++j) columns.push_back(j);
  }

  NullRows solve() {
    const Index n = M.rows();
    MatrixXd by = MatrixXd::Identity(n, n);  // row operations so far: M now = by * M before
    for (;;) {
      const auto [r, c] = pivot();
      if (r == rows.end()) break;
      const int row = *r, column = *c;
      rows.erase(r), columns.erase(c);
      for (const int i : rows) {
        const double l = M(i, column) / M(row, column);
        if (l == 0) continue;
        for (const int j : columns) {
          Kept k{M(i, j), size(i, j)};
          k.add(-l * M(row, j), std::abs(l) * size(row, j));
          M(i, j) = k.cleaned(), size(i, j) = k.size;
        }
        by.row(i) -= l * by.row(row);
      }
    }
    NullRows result;
    result.y.resize(static_cast<Index>(rows.size()), n);
    for (std::size_t k = 0; k < rows.size(); ++k)
      result.y.row(static_cast<Index>(k)) = by.row(rows[k]);
    result.own.assign(rows.begin(), rows.end());
    return result;
  }

  std::pair<std::vector<int>::iterator, std::vector<int>::iterator> pivot() {
    std::pair best{rows.end(), columns.end()};
    double score = 0;
    for (auto r = rows.begin(); r != rows.end(); ++r)
      for (auto c = columns.begin(); c != columns.end(); ++c) {
        if (M(*r, *c) == 0) continue;
        // The diagonal is a pure number; the others have their rows' and columns' units.
        const double share = std::abs(M(*r, *c)) / size(*r, *c) * (*r == *c ? 2 : 1);
        if (share > score) score = share, best = {r, c};
      }
    return best;
  }
};

}  // namespace

KeptMatrix KeptMatrix::transposed() const {
  KeptMatrix t;
  t.value = value.transpose(), t.size = size.transpose();
  return t;
}

NullRows left_null(KeptMatrix M) { return LeftNull(std::move(M)).solve(); }

RowVectorXd solve_transposed(const Factors<double>& factors, const RowVectorXd& c) {
  return Transposed(factors).solve(c);
}

// L = F - sum of value_i e_row_i e_unknown_i', F what the factors are of. y L = 0 is y F = p' Q
// with p = y at the patched rows: y = p' Y, Y = Q F^-1, and p' (I - Y at these rows) = 0.
NullRows null_rows(const Factors<double>& patched) {
  const std::vector<Patch> patches = patched.patches();
  const auto m = static_cast<Index>(patches.size());
  const Index n = patched.plan().unknowns;
  MatrixXd Y(m, n);
  KeptMatrix M(m, m);
  Transposed transposed(patched);
  for (Index i = 0; i < m; ++i) {
    const Patch& p = patches[at(i)];
    Y.row(i) = transposed.solve(p.value * RowVectorXd::Unit(n, p.unknown));
  }
  for (Index i = 0; i < m; ++i)
    for (Index j = 0; j < m; ++j) {
      Kept k;
      k.add(-Y(i, patches[at(j)].row), std::abs(Y(i, patches[at(j)].row)));
      if (i == j) k.add(1, 1);
      M.set(i, j, {k.cleaned(), std::abs(k.cleaned())});
    }
  NullRows small = left_null(std::move(M));
  NullRows result{MatrixXd::Zero(small.y.rows(), n), {}};
  for (Index k = 0; k < small.y.rows(); ++k) {
    for (Index r = 0; r < n; ++r) {
      Kept sum;
      for (Index i = 0; i < m; ++i)
        sum.add(small.y(k, i) * Y(i, r), std::abs(small.y(k, i) * Y(i, r)));
      result.y(k, r) = sum.cleaned();
    }
    // At the patched rows y is p itself.
    for (Index i = 0; i < m; ++i) result.y(k, patches[at(i)].row) = small.y(k, i);
    result.own.push_back(patches[at(small.own[at(k)])].row);
  }
  return result;
}

}  // namespace titop::solve
