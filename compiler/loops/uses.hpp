#pragma once

#include <deque>
#include <utility>
#include <vector>

namespace titop::loops {

/// The blocks of each column, while blocks lose columns, and the blocks that wait for elimination.
/// If one block of a column remains, it is known; a change costs O(1) per column.
class Uses {
 public:
  Uses(std::size_t columns, std::size_t blocks)
      : count_(columns, 0), sum_(columns, 0), waits_(blocks, 0) {}

  void add(int column, int block) { ++count(column), sum(column) += block; }
  void remove(int column, int block) { --count(column), sum(column) -= block; }
  bool alone(int column) const { return count_[static_cast<std::size_t>(column)] == 1; }
  /// The block, if it is `alone`.
  int block(int column) const { return static_cast<int>(sum_[static_cast<std::size_t>(column)]); }

  /// Behind those that wait, if it does not.
  void wait(int block) {
    if (!std::exchange(waits_[static_cast<std::size_t>(block)], 1)) queue_.push_back(block);
  }
  /// Removes the column; if another block has it alone now, that one waits.
  void leave(int column, int block) {
    remove(column, block);
    if (alone(column)) wait(this->block(column));
  }
  /// The one that has waited longest, which waits no more; -1: none.
  int next() {
    if (queue_.empty()) return -1;
    const int block = queue_.front();
    queue_.pop_front();
    waits_[static_cast<std::size_t>(block)] = 0;
    return block;
  }

 private:
  int& count(int column) { return count_[static_cast<std::size_t>(column)]; }
  long& sum(int column) { return sum_[static_cast<std::size_t>(column)]; }
  std::vector<int> count_;
  std::vector<long> sum_;  ///< of the numbers of its blocks
  std::vector<char> waits_;
  std::deque<int> queue_ = {};
};

}  // namespace titop::loops
