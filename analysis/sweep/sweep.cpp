#include <fmt/format.h>

#include <mutex>
#include <titop/analysis/sweep/sweep.hpp>
#include <titop/graph/support/parallel.hpp>

namespace titop {

void sweep(const System& system, std::span<const ParameterList> points,
           const std::function<void(std::size_t, const System&)>& visit,
           const SweepOptions& options) {
  std::mutex reporting;
  std::size_t done = 0;
  detail::parallel(points.size(), options.threads, [&] {
    return [&](std::size_t i) {
      try {
        visit(i, system.update(points[i]));
      } catch (const Error& error) {
        std::vector<Mistake> mistakes = error.mistakes();
        for (Mistake& m : mistakes) m.details.push_back(fmt::format("at point {} of the sweep", i));
        throw Error(std::move(mistakes));
      }
      const std::scoped_lock lock(reporting);
      ++done;
      if (options.progress) options.progress(done, points.size());
    };
  });
}

}  // namespace titop
