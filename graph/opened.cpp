#include <algorithm>
#include <titop/graph/opened.hpp>

namespace titop {

using Eigen::Index;
using Eigen::MatrixXd;

bool is_opened(const Value& value, std::span<const int> parameters) {
  return value.is_parameter() &&
         std::find(parameters.begin(), parameters.end(), value.index()) != parameters.end();
}

namespace {

/// The matrix with more rows and columns, which are 0.
MatrixXd grown(const MatrixXd& m, Index rows, Index cols) {
  MatrixXd result = MatrixXd::Zero(m.rows() + rows, m.cols() + cols);
  result.topLeftCorner(m.rows(), m.cols()) = m;
  return result;
}

double w_scale(const OpenedPair& pair) { return pair.scale_z ? 1 : pair.value.scale(); }

}  // namespace

Opened with_pairs(const Dynamics& given, const std::vector<OpenedPair>& pairs,
                  std::span<const int> parameters) {
  std::vector<Index> place(pairs.size(), -1);
  Opened o;
  for (std::size_t k = 0; k < pairs.size(); ++k)
    if (is_opened(pairs[k].value, parameters)) {
      place[k] = static_cast<Index>(o.parameter.size());
      o.parameter.push_back(pairs[k].value.index());
    }
  const Index more = static_cast<Index>(o.parameter.size()), nu = given.B.cols(),
              ny = given.C.rows();
  const MatrixXd D = given.dense_direct();
  Dynamics& d = o.dynamics;
  d.A = given.A, d.B = grown(given.B, 0, more);
  d.C = grown(given.C, more, 0), d.D = grown(D, more, more);
  for (std::size_t k = 0; k < pairs.size(); ++k) {
    if (place[k] < 0) continue;
    const double scale = w_scale(pairs[k]);
    if (pairs[k].moves >= 0)
      o.motions.push_back({pairs[k].moves, scale * pairs[k].moved_by, pairs[k].of_motion,
                           pairs[k].of_motion_states, static_cast<int>(place[k])});
    if (pairs[k].on_states.size() > 0) d.B.col(nu + place[k]) = scale * pairs[k].on_states;
    if (pairs[k].on_outputs.size() > 0)
      d.D.col(nu + place[k]).head(ny) = scale * pairs[k].on_outputs;
  }
  for (std::size_t k = 0; k < pairs.size(); ++k) {
    if (place[k] < 0) continue;
    const OpenedPair& p = pairs[k];
    const Index row = ny + place[k];
    if (p.of_states.size() > 0) d.C.row(row) = p.of_states;
    if (p.of_inputs.size() > 0) d.D.row(row).head(nu) = p.of_inputs;
    if (p.of_outputs.size() > 0) {
      d.C.row(row) += p.of_outputs * d.C.topRows(ny);
      d.D.row(row) += p.of_outputs * d.D.topRows(ny);
    }
    for (const auto& [other, factor] : p.of_pairs)
      if (place[other] >= 0) d.D(row, nu + place[other]) += factor * w_scale(pairs[other]);
    if (!p.scale_z) continue;
    d.C.row(row) *= p.value.scale();
    d.D.row(row) *= p.value.scale();
  }
  return o;
}

}  // namespace titop
