#include <algorithm>
#include <titop/compiler/passes/close/reflections.hpp>

namespace titop::passes::closing {

using Eigen::Index;

namespace {

constexpr double kEqual = 1 - 1e-6;

}  // namespace

double Reflections::largest(const std::vector<int>& columns) const {
  double result = 0;
  for (const int c : columns)
    if (!taken(c)) result = std::max(result, norm(c));
  return result;
}

double Reflections::take(const std::vector<int>& columns, double least, double share,
                         const std::vector<int>& rivals) {
  while (done() < M_.rows()) {
    const double best = largest(columns);
    if (!(best > least && best > share * largest(rivals))) return best;
    for (const int c : columns)
      if (!taken(c) && norm(c) >= kEqual * best) {
        reflect(c);
        break;
      }
    weakest_ = std::min(weakest_, best);
  }
  return 0;
}

void Reflections::reflect(int column) {
  const Index k = done(), n = M_.rows() - k;
  Eigen::VectorXd v = M_.col(column).tail(n);
  const double alpha = v(0) > 0 ? -v.norm() : v.norm();
  pivots_.push_back(column);
  taken_[static_cast<std::size_t>(column)] = 1;
  if (v.tail(n - 1).isZero(0)) return;  // stands already: exact zeros stay
  v(0) -= alpha;
  v.normalize();
  for (Index j = 0; j < M_.cols(); ++j) {
    const double along = v.dot(M_.col(j).tail(n));
    if (along != 0) M_.col(j).tail(n) -= 2 * along * v;
  }
  M_.col(column).tail(n).setZero();
  M_(k, column) = alpha;
}

}  // namespace titop::passes::closing
