#include <algorithm>
#include <titop/compiler/loops/reflections.hpp>
#include <titop/graph/linalg/rounding.hpp>

namespace titop::loops {

using Eigen::Index;

double Reflections::largest(const std::vector<int>& columns) const {
  double result = 0;
  for (const int c : columns)
    if (!taken(c)) result = std::max(result, norm(c));
  return result;
}

double Reflections::take(const std::vector<int>& columns, double least, const PivotChoice& choice) {
  const auto worth = [&](int c, double above) {
    const double size = taken(c) ? 0 : norm(c);
    return !(size > above) ? 0 : choice.worth.size() == 0 ? size : size * choice.worth(c);
  };
  std::vector<double> own(columns.size());
  while (done() < std::min(M_.rows(), choice.most)) {
    double best = 0, rival = 0;
    for (std::size_t i = 0; i < own.size(); ++i)
      best = std::max(best, own[i] = worth(columns[i], least));
    for (const int c : choice.rivals) rival = std::max(rival, worth(c, 0));
    if (!(best > choice.share * rival)) return largest(columns);
    const auto first =
        std::ranges::find_if(own, [&](double w) { return w >= linalg::kEqual * best; });
    const int pivot = columns[static_cast<std::size_t>(first - own.begin())];
    weakest_ = std::min(weakest_, norm(pivot));
    reflect(pivot);
  }
  return 0;
}

void Reflections::reflect(int column) {
  const Index k = done(), n = M_.rows() - k;
  Eigen::VectorXd v = M_.col(column).tail(n);
  const double alpha = v(0) > 0 ? -v.norm() : v.norm();
  pivots_.push_back(column);
  taken_[static_cast<std::size_t>(column)] = 1;
  if (v.tail(n - 1).isZero(0)) return;  // done already: exact zeros stay
  v(0) -= alpha;
  v.normalize();
  for (Index j = 0; j < M_.cols(); ++j) {
    const double along = v.dot(M_.col(j).tail(n));
    if (along != 0) M_.col(j).tail(n) -= 2 * along * v;
  }
  M_.col(column).tail(n).setZero();
  M_(k, column) = alpha;
}

}  // namespace titop::loops
