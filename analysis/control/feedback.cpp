#include <fmt/format.h>

#include <titop/analysis/control/feedback.hpp>
#include <titop/graph/error.hpp>
#include <titop/graph/linalg/dense.hpp>
#include <titop/graph/linalg/index.hpp>
#include <titop/graph/linalg/rounding.hpp>

namespace titop::detail {

using Eigen::Index;
using Eigen::MatrixXd;

StateSpace with_closed(const StateSpace& L, const std::vector<int>& closed) {
  const auto n = static_cast<Index>(closed.size());
  if (n == 0) return L;
  const MatrixXd Bk = L.B(Eigen::all, closed), Ck = L.C(closed, Eigen::all),
                 Dyk = L.D(Eigen::all, closed), Dku = L.D(closed, Eigen::all),
                 Dkk = L.D(closed, closed);
  const linalg::Inverse M = linalg::inverse(MatrixXd::Identity(n, n) + Dkk);
  if (!(M.rcond > static_cast<double>(n) * linalg::kEpsilon))
    throw Error(Code::ill_posed,
                "the closed loop has no unique solution: 1 + L is singular at high "
                "frequencies",
                "an algebraic loop of gain exactly -1 has no solution: add the dynamics of the "
                "actuator or of the sensor");
  StateSpace c = L;
  c.A -= Bk * M.matrix * Ck;
  c.B -= Bk * M.matrix * Dku;
  c.C -= Dyk * M.matrix * Ck;
  c.D -= Dyk * M.matrix * Dku;
  c.rates.clear();
  return c;
}

StateSpace sensitivity(const StateSpace& L) {
  std::vector<int> all;
  for (int i = 0; i < static_cast<int>(L.D.rows()); ++i) all.push_back(i);
  StateSpace S = with_closed(L, all);  // T
  S.C = -S.C;
  S.D = MatrixXd::Identity(L.D.rows(), L.D.cols()) - S.D;
  return S;
}

StateSpace alone(const StateSpace& L, int i) {
  std::vector<int> others;
  for (int k = 0; k < static_cast<int>(L.D.rows()); ++k)
    if (k != i) others.push_back(k);
  const StateSpace c = with_closed(L, others);
  StateSpace one;
  one.A = c.A, one.B = c.B.col(i), one.C = c.C.row(i), one.D = c.D.block(i, i, 1, 1);
  one.states = c.states;
  if (!c.inputs.empty()) one.inputs = {c.inputs[linalg::at(i)]};
  if (!c.outputs.empty()) one.outputs = {c.outputs[linalg::at(i)]};
  return one;
}

}  // namespace titop::detail
