#include <fmt/format.h>

#include <titop/compiler/minreal/order_of_stage.hpp>

namespace titop::minreal {

ExactOrder order_of_stage(const Stage& stage, int states, const ExactOptions& options,
                          ParameterValues values) {
  ExactOrder exact = exact_order(*stage.source, options, values);
  if (!exact.decided || exact.order <= states || !stage.chained) return exact;
  return {.why_not = fmt::format(
              "the numbers close the chains only but for their last places: taken exactly, {} "
              "states where {} are free to move",
              exact.order, states)};
}

}  // namespace titop::minreal
