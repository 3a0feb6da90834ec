#include <titop/compiler/system/elimination_terms.hpp>

namespace titop::detail {
namespace {

using Eigen::Index;
using Eigen::MatrixXcd;
using Eigen::MatrixXd;

}  // namespace

MatrixXd terms(const System& system, const std::vector<std::complex<double>>& points) {
  MatrixXd result = MatrixXd::Zero(static_cast<Index>(system.outputs().size()),
                                   static_cast<Index>(system.inputs().size()));
  for (const std::complex<double> s : points) try {
      const MatrixXcd off = system.transfer(s, Precision::standard) - in_long_double(system, s);
      result = result.cwiseMax(kTermsPerRounding * off.cwiseAbs());
    } catch (const Error&) {
      // No digit there in one of the two: other points must suffice.
    }
  return result;
}

Difference difference(const std::vector<MatrixXcd>& a, const std::vector<MatrixXcd>& exact,
                      Measure& measure, const System& system,
                      const std::vector<std::complex<double>>& points) {
  const Difference first = difference(a, exact, measure);
  if (first.relative <= kClose) return first;
  add_rounding(measure, exact, terms(system, some_of(points)));
  return difference(a, exact, measure);
}

}  // namespace titop::detail
