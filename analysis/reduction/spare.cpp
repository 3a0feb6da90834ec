#include <algorithm>
#include <cmath>
#include <optional>
#include <titop/analysis/reduction/spare.hpp>
#include <utility>

namespace titop::detail {
namespace {

using Eigen::Index;

/// Without coordinate i: modes first, then vectors.
Sequence::Choice without(Sequence::Choice choice, std::size_t i) {
  if (i < choice.kept.size()) {
    choice.kept.erase(choice.kept.begin() + static_cast<std::ptrdiff_t>(i));
    return choice;
  }
  const auto first = static_cast<Index>(i - choice.kept.size());
  const Index after = choice.vectors.cols() - first - 1;
  choice.vectors.middleCols(first, after) = choice.vectors.rightCols(after).eval();
  choice.vectors.conservativeResize(Eigen::NoChange, choice.vectors.cols() - 1);
  return choice;
}

/// Largest error on the samples, relative to the peaks; some error above `most`, if it is larger.
double largest_error(const Samples& samples, const Small& small, double most) {
  double worst = 0;
  for (std::size_t k = 0; k < samples.s.size() && worst <= most; ++k) {
    const double error =
        difference(samples, small, k).cwiseAbs().cwiseQuotient(samples.peak).maxCoeff();
    if (!(error <= worst)) worst = std::isnan(error) ? HUGE_VAL : error;
  }
  return worst;
}

}  // namespace

std::vector<Sequence::Choice> spared(const Sequence& sequence, const Samples& samples,
                                     Sequence::Choice choice, double target) {
  std::vector<Sequence::Choice> result;
  while (true) {
    double least = target;
    std::optional<Sequence::Choice> best;
    for (std::size_t i = 0; i < choice.size(); ++i) {
      Sequence::Choice fewer = without(choice, i);
      const double error = largest_error(samples, sequence.model(fewer), least);
      if (error <= least) least = error, best = std::move(fewer);
    }
    if (!best) return result;
    result.push_back(choice = *std::move(best));
  }
}

}  // namespace titop::detail
