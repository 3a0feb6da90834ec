#pragma once

#include <map>
#include <titop/analysis/reduction/small.hpp>
#include <titop/titop.hpp>

#include "support/fine_grid.hpp"

/// Reference without a choice: truncation by frequency.
namespace titop_bench {

/// The lowest modes of the whole, by frequency, without static-like vectors.
class Truncation {
 public:
  Truncation(const titop::Diagram& diagram, const titop::Scene& scene);

  /// Frequencies of all elastic modes [rad/s], ascending.
  Eigen::VectorXd omega() const;

  /// Number of modes that these errors need: doubled, then bisected to 5 %. All, if fewer do not.
  long needed(double accuracy, const FineGrid& grid);

  /// The model of the lowest `count` modes, cached.
  const titop::detail::Small& model(long count);
  double error(long count, const FineGrid& grid);

 private:
  titop::detail::Whole whole_;
  std::map<long, titop::detail::Small> models_;
  std::map<long, double> errors_;
};

}  // namespace titop_bench
