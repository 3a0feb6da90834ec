#include <algorithm>
#include <titop/compiler/dense/kept.hpp>

namespace titop::detail {

void Room::clear_for(const std::shared_ptr<const Writing>& writing, std::size_t size) {
  if (of == writing && values.size() == size) return;
  values.assign(size, 0);
  of = writing;
}

bool Kept::is_large() const {
  constexpr std::size_t kKeep = 1 << 17;  // numbers: 1 MB each
  const auto large = [](const std::vector<double>& v) { return v.size() > kKeep; };
  return large(coefficients) || large(products) || rooms.size() > 8 ||
         std::any_of(rooms.begin(), rooms.end(), [&](const Room& room) {
           return large(room.values) || large(room.space.z) || large(room.space.carried);
         });
}

Kept& kept_by_thread() {
  static thread_local Kept kept;
  return kept;
}

}  // namespace titop::detail
