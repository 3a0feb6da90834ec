#include <algorithm>
#include <titop/compiler/realization/kept.hpp>

namespace titop::detail {

void Room::clear_for(const std::shared_ptr<const Writing>& writing, std::size_t size) {
  if (of == writing && values.size() == size) return;
  values.assign(size, 0);
  of = writing;
}

bool Kept::is_large() const {
  constexpr std::size_t kOne = 1 << 17, kAll = 1 << 22;  // numbers: 1 MB each, 32 MB together
  std::size_t most = 0, all = 0;
  const auto take = [&](const std::vector<double>& v) {
    most = std::max(most, v.capacity()), all += v.capacity();
  };
  take(coefficients), take(products);
  for (const Room& room : rooms)
    for (const auto* v : {&room.values, &room.space.z, &room.space.rows, &room.space.carried})
      take(*v);
  return most > kOne || all > kAll;
}

Kept& kept_by_thread() {
  static thread_local Kept kept;
  return kept;
}

}  // namespace titop::detail
