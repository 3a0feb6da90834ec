#pragma once

#include <Eigen/Core>
#include <vector>

namespace titop::detail {

/// Rows of the model one below the other, and where they begin among those of a batch.
struct Run {
  Eigen::Index row = 0, size = 0, from = 0;
};

/// The next run; it goes on with the last one where both do.
inline void add_run(std::vector<Run>& runs, const Run& next) {
  if (!runs.empty() && runs.back().row + runs.back().size == next.row &&
      runs.back().from + runs.back().size == next.from)
    runs.back().size += next.size;
  else
    runs.push_back(next);
}

}  // namespace titop::detail
