#include <titop/compiler/certificate/residual.hpp>
#include <titop/compiler/system/elimination_terms.hpp>
#include <titop/compiler/system/system_data.hpp>
#include <titop/compiler/system/transfer_part.hpp>

namespace titop::detail {
namespace {

using Eigen::MatrixXcd;
using Eigen::MatrixXd;

}  // namespace

MatrixXd terms(const SystemData& d, const std::vector<std::complex<double>>& points) {
  MatrixXd result = MatrixXd::Zero(std::ssize(d.layout().outputs), std::ssize(d.layout().inputs));
  for (const std::complex<double> s : points) try {
      const MatrixXcd off = transfer_of(d, s, Precision::standard) - in_long_double(d, s);
      result = result.cwiseMax(kTermsPerRounding * off.cwiseAbs());
    } catch (const Error&) {
      // No digit there in one of the two: other points must suffice.
    }
  return result;
}

Difference difference(const std::vector<MatrixXcd>& a, const std::vector<MatrixXcd>& exact,
                      Measure& measure, const SystemData& d,
                      const std::vector<std::complex<double>>& points) {
  const Difference first = difference(a, exact, measure);
  if (first.relative <= kWarn) return first;
  add_rounding(measure, exact, terms(d, some_of(points)));
  return difference(a, exact, measure);
}

}  // namespace titop::detail
