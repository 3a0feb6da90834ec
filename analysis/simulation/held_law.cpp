#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <titop/analysis/simulation/held_law.hpp>
#include <titop/analysis/simulation/whole_steps.hpp>
#include <titop/graph/linalg/index.hpp>

namespace titop::detail {
namespace {

using Eigen::Index;
using linalg::at;

/// Places of the law's signals among those of the system.
std::vector<int> places_of(const std::vector<std::string>& of_law,
                           const std::vector<std::string>& of_system, const char* kind) {
  std::vector<int> places;
  for (const std::string& name : of_law) {
    const auto found = std::find(of_system.begin(), of_system.end(), name);
    if (found == of_system.end())
      throw Error(Code::unknown_name,
                  fmt::format("the sampled law: the system has no {} {}", kind, name),
                  fmt::format("its {}s are {}: name the law's signals like them", kind,
                              fmt::join(of_system, ", ")));
    places.push_back(static_cast<int>(found - of_system.begin()));
  }
  return places;
}

/// Steps of a period.
Index steps_of_period(double period, double step) {
  const double steps = whole_steps(period, step).value_or(0);
  if (!(steps >= 1 && steps <= kMostSteps))
    throw Error(
        Code::bad_value,
        fmt::format("the sampled law has a period of {} s, and the step is {} s", period, step),
        fmt::format("take Simulation::step = {} over a whole number", period));
  return static_cast<Index>(steps);
}

}  // namespace

HeldLaw::HeldLaw(const System& system, const Excitation& excitation, double step)
    : inputs_(Eigen::VectorXd::Zero(std::ssize(system.inputs()))) {
  if (!excitation.law()) return;
  law_ = &excitation.law()->model;
  every_ = steps_of_period(excitation.law()->period, step);
  reads_ = places_of(law_->inputs, system.outputs(), "output");
  drives_ = places_of(law_->outputs, system.inputs(), "input");
  x_ = Eigen::VectorXd::Zero(law_->order());
}

void HeldLaw::sample(const Eigen::VectorXd& y) {
  const Eigen::VectorXd read = y(reads_), u = law_->C * x_ + law_->D * read;
  x_ = (law_->A * x_ + law_->B * read).eval();
  inputs_.setZero();
  for (Index i = 0; i < u.size(); ++i) inputs_(drives_[at(i)]) += u(i);
}

void HeldLaw::add_to(Excitation::Ends& ends) const {
  if (!law_) return;
  ends.first += inputs_;
  if (ends.second.size() > 0) ends.second += inputs_;
}

}  // namespace titop::detail
