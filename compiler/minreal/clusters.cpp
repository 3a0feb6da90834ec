#include <algorithm>
#include <cmath>
#include <functional>
#include <numeric>
#include <titop/compiler/minreal/clusters.hpp>
#include <titop/graph/linalg/eigen.hpp>
#include <titop/graph/linalg/index.hpp>

namespace titop::minreal {
namespace {

using Eigen::Index;
using Eigen::MatrixXcd;
using Eigen::MatrixXd;

using linalg::at;

template <class Matrix>
Matrix turned(const Matrix& b, const Matrix& c) {
  const Index k = b.rows();
  Matrix result = Matrix::Identity(k, k);
  Index reached = k;
  if (b.cols() > 0) {
    const Eigen::JacobiSVD<Matrix> svd(b, Eigen::ComputeFullU);
    result = svd.matrixU();
    const Eigen::VectorXd sigma = svd.singularValues();
    reached = 0;
    while (reached < sigma.size() && sigma(reached) > linalg::kHalfDigits * sigma(0)) ++reached;
  }
  if (c.cols() > 0 && reached > 1) {
    const Matrix seen = result.leftCols(reached).adjoint() * c;
    const Eigen::JacobiSVD<Matrix> svd(seen, Eigen::ComputeFullU);
    result.leftCols(reached) = (result.leftCols(reached) * svd.matrixU()).eval();
  }
  return result;
}

}  // namespace

MatrixXd turn(const MatrixXd& b, const MatrixXd& c) { return turned(b, c); }
MatrixXcd turn(const MatrixXcd& b, const MatrixXcd& c) { return turned(b, c); }

bool UncoupledParts::one() const {
  return std::adjacent_find(of_mode.begin(), of_mode.end(), std::not_equal_to<>()) == of_mode.end();
}

UncoupledParts find_parts(const MatrixXd& A, const MatrixXd& vectors, const ModeSet& m) {
  UncoupledParts parts;
  std::vector<int>& part = parts.of_state;
  part.resize(at(A.rows()));
  std::iota(part.begin(), part.end(), 0);
  const auto join = [&](int a, int b) {
    if (a != b) std::replace(part.begin(), part.end(), std::max(a, b), std::min(a, b));
  };
  for (Index j = 0; j < A.cols(); ++j)
    for (Index i = 0; i < A.rows(); ++i)
      if (A(i, j) != 0) join(part[at(i)], part[at(j)]);
  std::vector<Index> state(at(m.size()));
  for (Index j = 0; j < m.size(); ++j) {
    const double most = vectors.col(j).maxCoeff(&state[at(j)]);
    for (Index i = 0; i < A.rows(); ++i)
      if (vectors(i, j) > kClearRank * most) join(part[at(i)], part[at(state[at(j)])]);
  }
  for (Index j = 0; j < m.size(); ++j)
    for (Index i = 0; i < j; ++i)
      if (m.cluster[at(i)] == m.cluster[at(j)])
        join(part[at(state[at(i)])], part[at(state[at(j)])]);
  for (const Index i : state) parts.of_mode.push_back(part[at(i)]);
  return parts;
}

void balance_sides(const UncoupledParts& parts, ModeSet& m) {
  const std::vector<int>& part = parts.of_mode;
  if (parts.one() || m.b.cols() == 0 || m.c.cols() == 0) return;
  // Each step comes closer by half the way, in logarithms.
  constexpr int kSteps = 60;
  for (int step = 0; step < kSteps; ++step) {
    const Eigen::RowVectorXd b_port = m.b.colwise().maxCoeff(), c_port = m.c.colwise().maxCoeff();
    Eigen::VectorXd b = Eigen::VectorXd::Zero(std::ssize(part)), c = b;
    for (Index j = 0; j < m.size(); ++j) {
      const int p = part[at(j)];
      for (Index l = 0; l < m.b.cols(); ++l)
        if (b_port(l) > 0) b(p) = std::max(b(p), m.b(j, l) / b_port(l));
      for (Index k = 0; k < m.c.cols(); ++k)
        if (c_port(k) > 0) c(p) = std::max(c(p), m.c(j, k) / c_port(k));
    }
    for (Index j = 0; j < m.size(); ++j) {
      const int p = part[at(j)];
      const double factor = b(p) > 0 && c(p) > 0 ? std::sqrt(std::sqrt(c(p) / b(p))) : 0;
      const double inverse = factor > 0 ? 1 / factor : 0;
      m.b.row(j) *= factor;
      m.c.row(j) *= inverse;
      if (m.b_apart.size() > 0) m.b_apart.row(j) *= factor;
      if (m.c_apart.size() > 0) m.c_apart.row(j) *= inverse;
    }
  }
}

bool clearly_full_rank(MatrixXd M) {
  if (M.rows() == 0) return true;
  const Eigen::VectorXd size = M.rowwise().norm();
  if (M.cols() < M.rows() || !(size.minCoeff() > kClearRow * size.maxCoeff())) return false;
  M = size.cwiseInverse().asDiagonal() * M;
  return Eigen::JacobiSVD<MatrixXd>(M).singularValues()(M.rows() - 1) > kClearRank;
}

}  // namespace titop::minreal
