#pragma once

#include <Eigen/Core>
#include <span>
#include <titop/graph/graph.hpp>
#include <vector>

namespace titop {

/// Drives of a channel: the equations on its two signals and their directions.
struct Drive {
  std::span<const int> accel, force, added;  ///< equations: `accel =`, `force =`, `force +=`
  int size = 0;                              ///< of the channel
  int free = 0;               ///< directions in which no acceleration is driven, but the force
  Eigen::MatrixXd some = {};  ///< N if some directions are free and others not; else empty

  bool all_free() const { return free == size; }
  /// Orthonormal rows of these directions, free x size (unit vectors if none is oblique).
  Eigen::MatrixXd N() const {
    return some.size() ? some : Eigen::MatrixXd(Eigen::MatrixXd::Identity(free, size));
  }
};

/// The drives of all channels, from the user's equations (not from the blocks' rows). O(equations).
class Drives {
 public:
  explicit Drives(const Graph& graph);
  Drives(Drives&&) = default;  // a copy's lists would be those of the original

  std::size_t size() const { return drives_.size(); }
  const Drive& operator[](std::size_t channel) const { return drives_[channel]; }

 private:
  std::vector<int> equations_;  ///< of all lists
  std::vector<Drive> drives_;
};

/// Orthonormal rows spanning the complement of the orthonormal rows of S (m x n).
Eigen::MatrixXd complement(const Eigen::MatrixXd& S, int n);

}  // namespace titop
