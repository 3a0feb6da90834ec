#include <titop/compiler/realization/write_model.hpp>
#include <titop/compiler/system/steps.hpp>

namespace titop::steps {

detail::Realization dense(const detail::SystemData& data) {
  StateSpace m;
  detail::write_dense(data, m, 0);
  for (const Eigen::MatrixXd* matrix : {&m.A, &m.B, &m.C, &m.D})
    if (!matrix->allFinite()) detail::refuse_overflow("the dense model of " + data.graph().name);
  detail::Realization r;
  r.against_factors = detail::dense_difference(data, m);
  r.error = detail::dense_error(data, m);
  detail::warn_of_lost_digits(data, r.error, r.notes);
  r.model = std::make_shared<const StateSpace>(std::move(m));
  return r;
}

}  // namespace titop::steps

void titop::detail::refuse_overflow(const std::string& subject) {
  throw Error(Code::not_finite, subject + " overflows",
              "take other units, or smaller gains: all numbers must stay below 1e308");
}
