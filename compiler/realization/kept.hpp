#pragma once

#include <memory>
#include <titop/compiler/realization/writing.hpp>
#include <titop/compiler/solve/products.hpp>
#include <titop/compiler/solve/propagation.hpp>
#include <vector>

namespace titop::detail {

/// Room for the solutions of one thread.
struct Room {
  solve::Propagation::Space space;
  std::vector<double> values;             ///< of the columns of a batch, row by row
  std::vector<const double*> reads;       ///< rows of unknowns that a target reads
  std::vector<solve::Destination> state,  ///< where the columns of a batch go in A or B,
      output;                             ///< and in C or D
  std::shared_ptr<const Writing> of;      ///< plan to which `values` belong

  /// Values that no target has are 0, and stay so from model to model.
  void clear_for(const std::shared_ptr<const Writing>& writing, std::size_t size);
};

/// Buffers that a thread that writes models keeps from one to the next while they are small, for
/// itself and for its helper threads: fresh memory would cost as much as the work. At most 32 MB of
/// numbers from call to call; a call that throws leaves them to the next.
struct Kept {
  std::vector<double> coefficients, products;  ///< all threads read them
  std::vector<Room> rooms;

  bool is_large() const;
};
Kept& kept_by_thread();

}  // namespace titop::detail
