#include "support/faulty_models.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <complex>
#include <vector>

namespace titop_test {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using titop::StateSpace;
using Wide = Eigen::Matrix<std::complex<long double>, Eigen::Dynamic, Eigen::Dynamic>;

constexpr double kNoEntry = 1e-9;

std::string place(const char* matrix, Index i, Index j) {
  return std::string(matrix) + "(" + std::to_string(i) + ", " + std::to_string(j) + ")";
}

FaultyModel without_state(const StateSpace& m, Index out) {
  FaultyModel result{m, "without " + m.states[static_cast<std::size_t>(out)]};
  std::vector<Index> keep;
  for (Index i = 0; i < m.A.rows(); ++i)
    if (i != out) keep.push_back(i);
  result.model.A = m.A(keep, keep);
  result.model.B = m.B(keep, Eigen::all);
  result.model.C = m.C(Eigen::all, keep);
  result.model.states.erase(result.model.states.begin() + out);
  return result;
}

/// The transfer, and the size of its terms.
struct WideTransfer {
  MatrixXd terms;
  Wide G;
  WideTransfer(const StateSpace& m, std::complex<long double> s) {
    using Number = std::complex<long double>;
    Wide K = -m.A.cast<Number>();
    K.diagonal().array() += s;
    const Wide X = K.partialPivLu().solve(Wide(m.B.cast<Number>()));
    G = m.C.cast<Number>() * X + m.D.cast<Number>();
    terms = m.C.cwiseAbs() * X.cwiseAbs().cast<double>() + m.D.cwiseAbs();
  }
};

}  // namespace

std::optional<FaultyModel> with_fault(const StateSpace& model, Rng& rng, bool dropping) {
  const int kind = rng.below(dropping ? 5 : 4);
  if (kind == 4) return without_state(model, rng.below(model.order()));
  FaultyModel result{model, {}};
  MatrixXd* const matrices[] = {&result.model.A, &result.model.B, &result.model.C, &result.model.D};
  constexpr const char* kNames[] = {"A", "B", "C", "D"};
  MatrixXd& M = *matrices[kind];
  std::vector<Index> entries;
  for (Index i = 0; i < M.size(); ++i)
    if (M(i) != 0 && std::abs(M(i)) >= kNoEntry * M.cwiseAbs().maxCoeff()) entries.push_back(i);
  if (entries.empty()) return {};
  const Index at = entries[static_cast<std::size_t>(rng.below(static_cast<int>(entries.size())))];
  M(at) *= 1 + 1e-4;
  result.fault = place(kNames[kind], at % M.rows(), at / M.rows());
  return result;
}

double change_of_transfer(const StateSpace& right, const StateSpace& faulty, double lowest,
                          double highest) {
  constexpr int kPoints = 200;
  MatrixXd size = MatrixXd::Zero(right.D.rows(), right.D.cols()), terms = size, off = size;
  for (int k = 0; k < kPoints; ++k) {
    const double w = lowest * std::pow(highest / lowest, k / (kPoints - 1.0));
    const WideTransfer a(right, {0.05 * w, w}), b(faulty, {0.05 * w, w});
    size = size.cwiseMax(a.G.cwiseAbs().cast<double>());
    terms = terms.cwiseMax(a.terms);
    off = off.cwiseMax((a.G - b.G).cwiseAbs().cast<double>());
  }
  double worst = 0;
  for (Index i = 0; i < size.rows(); ++i)
    for (Index j = 0; j < size.cols(); ++j) {
      const double around = std::sqrt(size.row(i).maxCoeff() * size.col(j).maxCoeff());
      if (size(i, j) > kNoEntry * std::max(terms(i, j), around))
        worst = std::max(worst, off(i, j) / size(i, j));
    }
  return worst;
}

}  // namespace titop_test
