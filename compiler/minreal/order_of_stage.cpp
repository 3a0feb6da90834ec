#include <fmt/format.h>

#include <titop/compiler/minreal/order_of_stage.hpp>

namespace titop::minreal {

ExactOrder order_of_stage(const Stage& stage, int states, const ExactOptions& options,
                          ParameterValues values) {
  if (!stage.opened.empty()) return {.why_not = "parameters are opened"};
  ExactOrder exact = exact_order(*stage.source, options, values);
  if (!exact.decided || exact.order <= states || !stage.chained) return exact;
  return {.why_not = fmt::format("the chains close only up to rounding of their data: exactly, {} "
                                 "states are independent, and {} within rounding",
                                 exact.order, states)};
}

}  // namespace titop::minreal
