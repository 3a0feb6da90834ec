#pragma once

#include <vector>

namespace titop::loops {

/// The blocks of each column, while blocks lose columns. If one block remains, it is known; a
/// change costs O(1) per column.
class Uses {
 public:
  explicit Uses(int columns)
      : count_(static_cast<std::size_t>(columns), 0), sum_(static_cast<std::size_t>(columns), 0) {}

  void add(int column, int block) { ++count(column), sum(column) += block; }
  void remove(int column, int block) { --count(column), sum(column) -= block; }
  bool alone(int column) const { return count_[static_cast<std::size_t>(column)] == 1; }
  /// The block, if it is `alone`.
  int block(int column) const { return static_cast<int>(sum_[static_cast<std::size_t>(column)]); }

 private:
  int& count(int column) { return count_[static_cast<std::size_t>(column)]; }
  long& sum(int column) { return sum_[static_cast<std::size_t>(column)]; }
  std::vector<int> count_;
  std::vector<long> sum_;  ///< of the numbers of its blocks
};

}  // namespace titop::loops
