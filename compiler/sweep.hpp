#pragma once

#include <functional>
#include <span>
#include <titop/compiler/system.hpp>

namespace titop {

struct SweepOptions {
  int threads = 0;  ///< 0: all cores
  /// Called with (done, all) after each point, by one thread at a time: print it, or draw a bar.
  std::function<void(std::size_t, std::size_t)> progress = {};
};

/// system.update(points[i]) for every i, each handed to visit(i, updated) on one of the threads:
/// `visit` must only touch what belongs to i. What it sees does not depend on the number of
/// threads, to the last bit. Of several errors that of the first point is thrown, with the point's
/// number.
///
///     std::vector<double> hz(points.size());
///     sweep(s, points, [&](std::size_t i, const System& at) { hz[i] = at.poles()[0].hertz; });
void sweep(const System& system, std::span<const ParameterList> points,
           const std::function<void(std::size_t, const System&)>& visit,
           const SweepOptions& options = {});

}  // namespace titop
