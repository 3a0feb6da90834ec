#include <algorithm>
#include <numeric>
#include <titop/compiler/solve/elimination.hpp>
#include <titop/compiler/solve/scalar.hpp>
#include <titop/graph/linalg/index.hpp>
#include <utility>

/// Memory of the fronts' numbers.
namespace titop::solve {
namespace {

using linalg::at;

}  // namespace

/// Room for these fronts.
template <class T>
std::shared_ptr<typename Factors<T>::Lot> Factors<T>::lot_of(std::span<const int> fronts) const {
  std::size_t entry_count = 0, row_count = 0, carried = 0;
  for (const int f : fronts) {
    const Front& front = plan_->fronts[at(f)];
    entry_count += front.entries();
    row_count += at(front.row_count);
    carried += at(front.left_over());
  }
  const auto lot = std::make_shared<Lot>(std::vector<Made>(fronts.size()), Storage<T>(entry_count),
                                         Storage<int>(row_count), Storage<double>(carried));
  const T* entry = lot->entries.data();
  const int* row = lot->rows.data();
  const double* size = lot->sizes.data();
  for (std::size_t i = 0; i < fronts.size(); ++i) {
    const Front& front = plan_->fronts[at(fronts[i])];
    Made& m = lot->made[i];
    m.front = fronts[i];
    m.lu = {entry, front.entries()};
    m.order = {row, at(front.row_count)};
    m.least_size = {size, at(front.left_over())};
    entry += m.lu.size();
    row += m.order.size();
    size += m.least_size.size();
  }
  return lot;
}

/// Frees memory without a front in use. If the rest is more than twice the size of all fronts, they
/// move to a new place.
template <class T>
void Factors<T>::tidy() {
  const auto in_use = [&](const Made& m) { return fronts_[at(m.front)] == &m; };
  std::erase_if(lots_, [&](const auto& lot) { return std::ranges::none_of(lot->made, in_use); });
  if (singular_ >= 0 || entries_held() <= 2 * plan_->entries) return;
  std::vector<int> all(fronts_.size());
  std::iota(all.begin(), all.end(), 0);
  const std::shared_ptr<Lot> lot = lot_of(all);
  T* entry = lot->entries.data();
  int* row = lot->rows.data();
  double* size = lot->sizes.data();
  for (Made& made : lot->made) {
    const Made& from = *fronts_[at(made.front)];
    entry = std::ranges::copy(from.lu, entry).out;
    row = std::ranges::copy(from.order, row).out;
    size = std::ranges::copy(from.least_size, size).out;
    const auto lu = std::exchange(made.lu, {});
    const auto order = std::exchange(made.order, {});
    const auto least_size = std::exchange(made.least_size, {});
    made = from;
    made.lu = lu, made.order = order, made.least_size = least_size;
    fronts_[at(made.front)] = &made;
  }
  lots_ = {lot};
}

template <class T>
std::size_t Factors<T>::entries_held() const {
  std::size_t held = 0;
  for (const auto& lot : lots_) held += lot->entries.size();
  return held;
}

#define TITOP_INSTANTIATE(T)                                                                \
  template std::shared_ptr<Factors<T>::Lot> Factors<T>::lot_of(std::span<const int>) const; \
  template void Factors<T>::tidy();                                                         \
  template std::size_t Factors<T>::entries_held() const;
TITOP_INSTANTIATE(double)
TITOP_COMPLEX_SCALARS(TITOP_INSTANTIATE)
#undef TITOP_INSTANTIATE

}  // namespace titop::solve
