#include <algorithm>
#include <cmath>
#include <iterator>
#include <titop/compiler/certificate/surroundings.hpp>
#include <titop/graph/linalg/index.hpp>

namespace titop::detail {

namespace {
using linalg::at;
}

double Surroundings::of_front(const solve::Front& front) const {
  const solve::Plan& plan = *d_.skeleton->as_written().plan;
  const std::vector<std::int16_t>& scale = d_.scale()->in_fronts;
  double own = 0, passed_on = 0;
  bool stands_out = front.parent < 0;
  int column = front.first_column;
  const auto take = [&](int variable, int in_parent) {
    for (int i = 0; i < plan.structure.variable_size[at(variable)]; ++i, ++column) {
      const double x = std::abs(unknowns_(plan.first[at(variable)] + i));
      own = std::max(own, std::ldexp(x, -scale[at(column)]));
      if (in_parent < 0) continue;
      const double there =
          std::ldexp(sizes_[at(front.parent)], scale[at(in_parent + i)]);  // in its own unit
      stands_out = stands_out || x > kLeftOfZero * there;
      passed_on = std::max(passed_on, std::ldexp(there, -scale[at(column)]));
    }
  };
  for (const int v : plan.list(front.pivots)) take(v, -1);
  for (int k = front.border.begin; k < front.border.begin + front.border.count; ++k)
    take(plan.lists[at(k)],
         front.parent < 0 ? -1
                          : plan.fronts[at(front.parent)].first_column + plan.parent_column[at(k)]);
  return stands_out ? own : std::max(own, passed_on);
}

double Surroundings::of_variable(int variable, Eigen::Index entry) {
  const solve::Plan& plan = *d_.skeleton->as_written().plan;
  if (sizes_.empty()) {
    sizes_.resize(plan.fronts.size());
    for (std::size_t f = sizes_.size(); f-- > 0;) sizes_[f] = of_front(plan.fronts[f]);
  }
  const int unknown = plan.first[at(variable)] + static_cast<int>(entry);
  const auto front = std::prev(
      std::upper_bound(plan.fronts.begin(), plan.fronts.end(), unknown,
                       [](int place, const solve::Front& f) { return place < f.first_unknown; }));
  const int column = front->first_column + unknown - front->first_unknown;
  return std::ldexp(sizes_[at(front - plan.fronts.begin())], d_.scale()->in_fronts[at(column)]);
}

double Surroundings::size(int signal, Eigen::Index entry) {
  const solve::JointSystem& joint = d_.skeleton->as_written();
  double result = 0;
  for (const solve::SignalTerm& m : joint.meaning(signal)) {
    const int v = joint.variable_of[at(m.signal)];
    if (v < 0) continue;
    if (m.coefficient < 0) {
      result = std::max(result, of_variable(v, entry));
      continue;
    }
    const solve::RowMatrix<double>& c = *d_.numbers.coefficients[at(m.coefficient)];
    for (Eigen::Index j = 0; j < c.cols(); ++j)
      if (c(entry, j) != 0) result = std::max(result, std::abs(c(entry, j)) * of_variable(v, j));
  }
  return result;
}

}  // namespace titop::detail
