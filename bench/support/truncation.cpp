#include "support/truncation.hpp"

#include <algorithm>
#include <numeric>
#include <titop/analysis/reduction/ray.hpp>
#include <titop/analysis/reduction/sharpen.hpp>
#include <titop/compiler/system/compile_graph.hpp>

namespace titop_bench {

using namespace titop;

Truncation::Truncation(const Diagram& d, const Scene& scene) {
  const auto data = detail::compile_graph(detail::restricted(d.graph(), scene), {});
  const System system(data);
  whole_ =
      detail::whole(system, detail::coordinates(system, *data), detail::positions_read(d.graph()));
  detail::sharpen(whole_, system, 1.2 * detail::band_of(system, scene, whole_).high);
}

Eigen::VectorXd Truncation::omega() const {
  return whole_.lambda.head(whole_.elastic()).cwiseSqrt();
}

const detail::Small& Truncation::model(long count) {
  const auto found = models_.find(count);
  if (found != models_.end()) return found->second;
  std::vector<Eigen::Index> lowest(static_cast<std::size_t>(count));
  std::iota(lowest.begin(), lowest.end(), 0);
  const Eigen::MatrixXd no_vectors(whole_.elastic(), 0);
  return models_.emplace(count, detail::project(whole_, lowest, no_vectors)).first->second;
}

double Truncation::error(long count, const FineGrid& grid) {
  const auto found = errors_.find(count);
  if (found != errors_.end()) return found->second;
  const detail::Small& m = model(count);
  return errors_[count] = grid.error([&](std::complex<double> s) { return m.transfer(s); });
}

long Truncation::needed(double accuracy, const FineGrid& grid) {
  const long n = static_cast<long>(whole_.elastic());
  long few = 0, many = 1;
  while (many < n && error(many, grid) > accuracy) few = many, many *= 2;
  many = std::min(many, n);
  while (many - few > std::max(1L, many / 20)) {
    const long k = (few + many) / 2;
    (error(k, grid) <= accuracy ? many : few) = k;
  }
  return many;
}

}  // namespace titop_bench
