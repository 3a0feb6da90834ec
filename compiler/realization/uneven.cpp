#include <titop/compiler/realization/uneven.hpp>

namespace titop::detail {

std::vector<std::size_t> uneven_batches(const Writing& writing, std::span<const OwnTerms> own) {
  constexpr double kUneven = 1e4;
  double most = 0;
  for (const OwnTerms& o : own) most = std::max(most, o.most);
  std::vector<std::size_t> result;
  for (std::size_t i = 0; i < own.size(); ++i)
    if (writing.has_counterparts(i) && own[i].least * kUneven < most) result.push_back(i);
  return result;
}

}  // namespace titop::detail
