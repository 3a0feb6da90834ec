#include <fmt/format.h>

#include <titop/analysis/simulation/steppers.hpp>
#include <titop/compiler/solve/evaluate.hpp>
#include <titop/compiler/solve/factored.hpp>
#include <titop/graph/error.hpp>

namespace titop::detail {
namespace {

using Eigen::VectorXd;
using Columns = solve::RowMatrix<double>;

class Midpoint : public StepRule {
 public:
  Midpoint(const Factored& d, double h)
      : d_(d),
        s_(2 / h),
        inputs_(static_cast<Eigen::Index>(d.layout().inputs.size())),
        point_(d, s_, Columns::Identity(inputs_, inputs_), solve::Refinement::settled),
        by_inputs_(d.states.model_states(Columns(point_.states()),
                                         Columns(Columns::Identity(inputs_, inputs_)), s_)) {
    if (!point_.holds())
      throw Error(Code::singular,
                  fmt::format("{}: the equations of midpoint steps of {:.6g} s, at s = {:.6g}, are "
                              "not solved to the rounding of their terms",
                              d.graph().name, h, s_),
                  "take another step, Stepper::exact or Stepper::rk4");
  }

  VectorXd step(const VectorXd& x, const VectorXd& u0, const VectorXd& u1) const override {
    const Columns forced = s_ * d_.states.expanded(x);
    VectorXd middle = d_.states.kept_rows(Columns(point_.forced_states(forced)));
    middle.noalias() += by_inputs_ * (0.5 * (u0 + u1));
    return 2 * middle - x;
  }

 private:
  const Factored& d_;
  double s_;
  Eigen::Index inputs_;
  Evaluation<double> point_;
  Eigen::MatrixXd by_inputs_;  ///< the model's states x inputs
};

}  // namespace

std::unique_ptr<StepRule> midpoint_rule(const Factored& data, double h) {
  return std::make_unique<Midpoint>(data, h);
}

}  // namespace titop::detail
