#pragma once

#include <optional>
#include <string>
#include <titop/emit/cpp/form.hpp>
#include <titop/emit/cpp/header.hpp>
#include <vector>

namespace titop::emit {

/// Expected values of the generated test, independent of the header's matrices.
struct Expected {
  Points points;
  std::vector<Pole> poles;
  std::optional<Eigen::MatrixXd> static_gain;  ///< none if there is a pole at 0
  Eigen::MatrixXd inputs, outputs;             ///< a trajectory; empty without a sample time
};

/// The text of NAME_test.cpp.
std::string test_text(const Naming& names, const ModelForm& form, const Expected& expected);

}  // namespace titop::emit
