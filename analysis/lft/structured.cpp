#include <fmt/format.h>

#include <algorithm>
#include <numeric>
#include <titop/analysis/lft/structured.hpp>
#include <titop/graph/linalg/dense.hpp>
#include <titop/graph/linalg/eigen.hpp>
#include <titop/graph/linalg/index.hpp>
#include <titop/graph/linalg/spectral.hpp>

namespace titop::detail {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;
using linalg::at;

constexpr double kRank = 1e-9;           ///< of a row block: smaller singular values count as 0
constexpr double kSmallRows = 1e-5;      ///< of the largest ones: smaller rows may be rounding
constexpr double kIllConditioned = 1e3;  ///< poles are not separated beyond this

/// Rows and columns of one part of the coordinates.
struct MatrixBlock {
  Index first = 0, size = 0;
  bool pole = false;  ///< an invariant subspace of A: others of its kind do not act on it
};

/// The square part N of a model over states and pairs, with its inputs B and outputs C.
struct LftMatrices {
  MatrixXd N, B, C;
};

/// N restricted to the columns of R, with L R = I.
LftMatrices restricted(const LftMatrices& m, const MatrixXd& L, const MatrixXd& R) {
  return {L * m.N * R, L * m.B, m.C * R};
}

MatrixXd with_unit_columns(MatrixXd m) {
  for (Index j = 0; j < m.cols(); ++j)
    if (const double size = m.col(j).norm(); size > 0) m.col(j) /= size;
  return m;
}

/// Least subspaces of the blocks: orthonormal bases.
class Reach {
 public:
  Reach(const LftMatrices& m, const std::vector<MatrixBlock>& blocks, RankMargin& margin)
      : m_(m), blocks_(blocks), margin_(margin) {
    const MatrixXd B = with_unit_columns(m.B);
    for (const MatrixBlock& b : blocks_) size_.push_back(rows(m_.N, b).norm());
    const double largest = size_.empty() ? 0 : *std::max_element(size_.begin(), size_.end());
    for (double& size : size_) size = std::max(size, kSmallRows * largest);
    std::vector<MatrixXd> found;
    for (const MatrixBlock& b : blocks_) {
      bases.emplace_back(b.size, 0);
      found.push_back(added(bases.size() - 1, rows(B, b), 1));
    }
    while (std::any_of(found.begin(), found.end(), [](const MatrixXd& f) { return f.cols() > 0; }))
      found = next(found);
  }

  std::vector<MatrixXd> bases;

 private:
  static MatrixXd rows(const MatrixXd& m, const MatrixBlock& b) {
    return m.middleRows(b.first, b.size);
  }

  std::vector<MatrixXd> next(const std::vector<MatrixXd>& found) {
    std::vector<MatrixXd> result;
    for (std::size_t i = 0; i < blocks_.size(); ++i) {
      const MatrixBlock& to = blocks_[i];
      MatrixXd all(to.size, 0);
      for (std::size_t j = 0; j < blocks_.size(); ++j) {
        const MatrixBlock& from = blocks_[j];
        if (found[j].cols() == 0 || (to.pole && from.pole && i != j)) continue;
        const MatrixXd more = m_.N.block(to.first, from.first, to.size, from.size) * found[j];
        all.conservativeResize(to.size, all.cols() + more.cols());
        all.rightCols(more.cols()) = more;
      }
      result.push_back(added(i, all, size_[i]));
    }
    return result;
  }

  /// The new directions among these columns, added to the basis; `size`: of their rows.
  MatrixXd added(std::size_t block, const MatrixXd& columns, double size) {
    MatrixXd& V = bases[block];
    MatrixXd rest = columns;
    for (int twice = 0; twice < 2; ++twice) rest -= V * MatrixXd(V.transpose() * rest);
    if (rest.cols() == 0 || V.cols() == V.rows() || size == 0) return MatrixXd(V.rows(), 0);
    const Eigen::JacobiSVD<MatrixXd> svd(rest, Eigen::ComputeThinU);
    Index rank = 0;
    for (const double s : svd.singularValues()) {
      if (s > kRank * size && V.cols() + rank < V.rows())
        ++rank, margin_.kept = std::min(margin_.kept, s / size);
      else
        margin_.dropped = std::max(margin_.dropped, s / size);
    }
    MatrixXd fresh = svd.matrixU().leftCols(rank);
    for (int twice = 0; twice < 2; ++twice) fresh -= V * MatrixXd(V.transpose() * fresh);
    fresh = with_unit_columns(fresh);
    V.conservativeResize(V.rows(), V.cols() + rank);
    V.rightCols(rank) = fresh;
    return fresh;
  }

  const LftMatrices& m_;
  const std::vector<MatrixBlock>& blocks_;
  RankMargin& margin_;
  std::vector<double> size_;
};

MatrixXd block_diagonal(const std::vector<MatrixXd>& list) {
  Index rows = 0, cols = 0;
  for (const MatrixXd& m : list) rows += m.rows(), cols += m.cols();
  MatrixXd result = MatrixXd::Zero(rows, cols);
  rows = cols = 0;
  for (const MatrixXd& m : list) {
    result.block(rows, cols, m.rows(), m.cols()) = m;
    rows += m.rows(), cols += m.cols();
  }
  return result;
}

/// Real bases of the invariant subspaces of A, side by side, with their blocks.
MatrixXd pole_bases(const MatrixXd& A, std::vector<MatrixBlock>& blocks) {
  const Index n = A.rows();
  if (n == 0) return MatrixXd(0, 0);
  const linalg::Spectrum s = linalg::spectrum(A, kIllConditioned);
  MatrixXd P(n, n);
  for (const auto& c : s.clusters) {
    MatrixXd both(n, 2 * c.count);
    both << s.V.middleCols(c.first, c.count).real(), s.V.middleCols(c.first, c.count).imag();
    P.middleCols(c.first, c.count) =
        Eigen::JacobiSVD<MatrixXd>(both, Eigen::ComputeThinU).matrixU().leftCols(c.count);
    blocks.push_back({c.first, c.count, true});
  }
  return P;
}

/// Transformations to fewer coordinates and back, L R = I.
struct Projection {
  MatrixXd L, R;
  void restrict_to(const MatrixXd& left, const MatrixXd& right) { L = left * L, R = R * right; }
};

std::vector<MatrixBlock> shrunk(const std::vector<MatrixBlock>& blocks,
                                const std::vector<MatrixXd>& bases) {
  std::vector<MatrixBlock> result;
  Index first = 0;
  for (std::size_t i = 0; i < blocks.size(); ++i) {
    result.push_back({first, bases[i].cols(), blocks[i].pole});
    first += bases[i].cols();
  }
  return result;
}

/// Restricts to the subspaces that u reaches, then to those that y sees, until nothing changes.
void reduce_blocks(LftMatrices m, std::vector<MatrixBlock>& blocks, Projection& c,
                   RankMargin& margin) {
  for (Index before = -1; before != m.N.rows();) {
    before = m.N.rows();
    for (int side = 0; side < 2; ++side) {
      const std::vector<MatrixXd> bases = Reach(m, blocks, margin).bases;
      const MatrixXd V = block_diagonal(bases), Vt = V.transpose();
      m = restricted(m, Vt, V);
      c.restrict_to(Vt, V);
      blocks = shrunk(blocks, bases);
      m = {m.N.transpose(), m.C.transpose(), m.B.transpose()};  // the other side
    }
  }
}

/// Coordinates in which poles are apart and rows and columns of like size, with their blocks: those
/// of the poles, then those of the parameters.
Projection separated(MatrixXd N, Index states, const std::vector<int>& sizes,
                     std::vector<MatrixBlock>& blocks) {
  const Index n = N.rows();
  const VectorXd d = linalg::similarity_scaling_of_parts(N);
  MatrixXd P = MatrixXd::Identity(n, n), inverse = P;
  const MatrixXd bases = pole_bases(N.topLeftCorner(states, states), blocks);
  P.topLeftCorner(states, states) = bases;
  if (states > 0) inverse.topLeftCorner(states, states) = linalg::inverse(bases).matrix;
  for (Index first = states; const int size : sizes) blocks.push_back({first, size}), first += size;
  return {inverse * MatrixXd(d.cwiseInverse().asDiagonal()), MatrixXd(d.asDiagonal()) * P};
}

/// The block from `column` on is the one from `row` on, as it was.
void keep(Projection& c, Index row, Index column, Index size) {
  c.L.middleRows(column, size).setZero(), c.R.middleCols(column, size).setZero();
  c.L.block(column, row, size, size).setIdentity();
  c.R.block(row, column, size, size).setIdentity();
}

/// The first `states` of N are states, the others pairs.
StateSpace model_of(const LftMatrices& f, Index states, const StateSpace& given) {
  const Index q = f.N.rows() - states, nu = f.B.cols(), ny = f.C.rows();
  const Index r = given.B.cols() - nu;  // pairs before
  StateSpace s;
  s.A = f.N.topLeftCorner(states, states);
  s.B.resize(states, q + nu), s.C.resize(q + ny, states), s.D.resize(q + ny, q + nu);
  s.B << f.N.topRightCorner(states, q), f.B.topRows(states);
  s.C << f.N.bottomLeftCorner(q, states), f.C.leftCols(states);
  s.D << f.N.bottomRightCorner(q, q), f.B.bottomRows(q), f.C.rightCols(q),
      given.D.bottomRightCorner(ny, nu);
  s.inputs.assign(at(q), "w"), s.outputs.assign(at(q), "z");
  s.inputs.insert(s.inputs.end(), given.inputs.begin() + r, given.inputs.end());
  s.outputs.insert(s.outputs.end(), given.outputs.begin() + r, given.outputs.end());
  for (Index i = 0; i < states; ++i)
    s.states.push_back(states == given.order() ? given.states[at(i)] : fmt::format("x{}", i + 1));
  return s;
}

}  // namespace

Structured reduced(const StateSpace& given, const std::vector<int>& sizes) {
  const Index n = given.order(), r = std::accumulate(sizes.begin(), sizes.end(), Index{0}),
              nu = given.B.cols() - r, ny = given.C.rows() - r;
  LftMatrices m{MatrixXd(n + r, n + r), MatrixXd(n + r, nu), MatrixXd(ny, n + r)};
  m.N << given.A, given.B.leftCols(r), given.C.topRows(r), given.D.topLeftCorner(r, r);
  m.B << given.B.rightCols(nu), given.D.topRightCorner(r, nu);
  m.C << given.C.bottomRows(ny), given.D.bottomLeftCorner(ny, r);
  std::vector<MatrixBlock> blocks;
  Projection c = separated(m.N, n, sizes, blocks);
  Structured result;
  reduce_blocks(restricted(m, c.L, c.R), blocks, c, result.margin);
  const std::size_t poles = blocks.size() - sizes.size();
  Index states = 0;
  for (std::size_t i = 0; i < poles; ++i) states += blocks[i].size;
  if (states == n) keep(c, 0, 0, n);
  for (std::size_t i = 0, first = at(n); i < sizes.size(); first += at(sizes[i++])) {
    const MatrixBlock& b = blocks[poles + i];
    result.sizes.push_back(static_cast<int>(b.size));
    if (b.size == sizes[i]) keep(c, static_cast<Index>(first), b.first, b.size);
  }
  result.m = model_of(restricted(m, c.L, c.R), states, given);
  return result;
}

}  // namespace titop::detail
