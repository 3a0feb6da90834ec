#pragma once

#include <cstdio>
#include <functional>
#include <span>
#include <titop/compiler/system/system.hpp>

namespace titop {

/// Options of `sweep`.
struct SweepOptions {
  int threads = 0;  ///< 0: all cores
  /// Called with (done, all) after each point, by one thread at a time: `progress_line()` draws it.
  std::function<void(std::size_t, std::size_t)> progress = {};
};

/// Calls visit(i, system.update(points[i])) for every i, each on one of the threads: `visit` must
/// only touch data of i. Its arguments are the same to the last bit for any number of threads. Of
/// several errors of `update` or `visit` that of the first point is thrown, with the point's
/// number. Cost: one update and visit per point. Threads but the caller's are kept for later calls,
/// with their thread_local objects.
///
///     std::vector<double> hz(points.size());
///     sweep(s, points, [&](std::size_t i, const System& at) { hz[i] = at.poles()[0].hertz; });
void sweep(const System& system, std::span<const ParameterList> points,
           const std::function<void(std::size_t, const System&)>& visit,
           const SweepOptions& options = {});

/// Where `progress_line` draws.
enum class DrawLine {
  on_terminals,  ///< nothing if the file is no terminal: logs stay short
  always,
};

/// A line for SweepOptions::progress and Simulation::progress, drawn over itself at most five times
/// a second; its last state has a newline.
///
///     sweep(s, points, visit, {.progress = progress_line()});
///
///     117 of 400 points, 29 %, 12 s left
///
/// The time left is extrapolated from the points done, counted from the construction of the line:
/// one for each sweep. `to` must stay open. `counted`: "points", "steps".
std::function<void(std::size_t, std::size_t)> progress_line(std::FILE* to = stderr,
                                                            DrawLine draw = DrawLine::on_terminals,
                                                            std::string counted = "points");

}  // namespace titop
