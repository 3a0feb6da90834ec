#include <titop/compiler/realization/write_model.hpp>
#include <titop/compiler/system/steps.hpp>

namespace titop::steps {

detail::DenseModel dense(const detail::SystemData& data, detail::DenseModel m) {
  detail::write_dense(data, m.model, 0);
  for (const Eigen::MatrixXd* matrix : {&m.model.A, &m.model.B, &m.model.C, &m.model.D})
    if (!matrix->allFinite()) detail::refuse_overflow("the dense model of " + data.graph().name);
  m.against_factors = detail::dense_difference(data, m.model);
  m.error = detail::dense_error(data, m.model);
  detail::warn_of_lost_digits(data, m.error, m.notes);
  return m;
}

}  // namespace titop::steps

void titop::detail::refuse_overflow(const std::string& subject) {
  throw Error(Code::not_finite, subject + " overflows",
              "take other units, or smaller gains: all numbers must stay below 1e308");
}
