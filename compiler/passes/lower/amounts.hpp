#pragma once

#include <titop/compiler/passes/stage.hpp>

/// Sums of signals with one numeric coefficient each.
namespace titop::passes {

/// A signal with its coefficient and declared structure.
struct Summand {
  int signal;
  Eigen::MatrixXd c;
  Pattern p;  ///< where c may be nonzero for any numbers; 0 x 0 if not needed
};
using Amount = std::vector<Summand>;

/// One summand per signal, in canonical order: the sum does not depend on how it was written.
Amount summed(Amount sum);
/// The same as terms.
std::vector<Term> merged(Amount sum);
/// The pattern of a product; empty if that of a factor is empty.
Pattern product(const Pattern& a, const Pattern& b);
Pattern product(const Eigen::MatrixXd& m, const Pattern& p);
/// m * sum.
Amount times(const Eigen::MatrixXd& m, Amount sum);
/// The same with the declared structure of m: an entry that is 0 now need not stay 0.
Amount times(const Eigen::MatrixXd& m, const Pattern& declared, Amount sum);

}  // namespace titop::passes
