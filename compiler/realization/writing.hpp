#pragma once

#include <Eigen/Core>
#include <memory>
#include <utility>
#include <vector>

namespace titop::detail {

struct Skeleton;
struct Factored;

/// Plan of the dense model by structure alone: made once for all values. Every column of A and B is
/// the response to one state or input that acts on some rows of the joint system (a source); every
/// row of xdot and y reads some unknowns (a target). A body with N modes acts through its N modal
/// forces, not its 2 N states: half the columns.
struct Writing {
  static constexpr Eigen::Index kBatch = 48;  ///< columns at a time

  explicit Writing(const Factored& data);

  /// A state or input that acts on the rows of the joint system.
  struct Source {
    int node = -1;             ///< of a state; -1: external inputs
    Eigen::Index first = 0;    ///< first column in [x; u]
    Eigen::Index columns = 0;  ///< modes if it acts through its modes, else states or inputs
    bool modal = false;
    std::vector<std::pair<int, int>> acts = {};  ///< row group, piece
    int front = 0;                               ///< the first front it enters
  };

  /// Factor of a target times its meaning: B of a node or a coefficient, times another.
  struct TargetTerm {
    int node = -1, coefficient = -1;  ///< one of the two
    Eigen::Index column = 0, size = 0;
    int times = -1;  ///< a coefficient; -1: identity
    bool known = false;
    Eigen::Index to = 0;  ///< column in [x; u], or first column among the coefficients
  };

  /// Adjacent unknowns or rows.
  struct IndexRange {
    Eigen::Index first = 0, size = 0;
  };
  /// Appends the next range; merges it with the last one if they are adjacent.
  static void add_range(std::vector<IndexRange>& ranges, const IndexRange& next);

  /// Rows of xdot or y: sum of coefficients times unknowns and of known terms.
  struct Target {
    Eigen::Index row = 0;  ///< first row of [xdot; y]
    Eigen::Index rows = 0;
    Eigen::Index inner = 0;  ///< unknowns that it reads
    Eigen::Index still = 0;  ///< rows of the node above: coordinates move with their rates
    std::vector<TargetTerm> terms = {};
    std::vector<IndexRange> unknowns = {};
    Eigen::Index coefficients = 0;  ///< where they begin: rows x inner, row-major
  };

  std::vector<Source> sources;              ///< fronts ascend from batch to batch
  std::vector<Target> targets;              ///< rows ascend
  std::vector<std::size_t> batches;         ///< first sources, and the end
  std::vector<std::pair<int, bool>> modal;  ///< nodes with states: by their modes?
  Eigen::Index coefficients = 0;            ///< of all targets

  /// False if blocks have got or lost their modal form.
  bool fits(const Factored& data) const;
  /// Columns of a batch, up to a multiple of 8: no sum depends on their number.
  Eigen::Index width(std::size_t batch) const;
};

/// The skeleton's cached plan, made at the first call; a new one if it is stale.
std::shared_ptr<const Writing> writing_of(const Factored& data);

}  // namespace titop::detail
