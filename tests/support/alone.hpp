#pragma once

#include <string>
#include <titop/titop.hpp>

namespace titop_test {

/// One Lti between the input "u" and the output "y".
inline titop::Diagram alone(const titop::Lti& lti, const std::string& name = "k") {
  titop::Diagram d{"alone"};
  auto k = d.add(name, lti);
  k.in = d.input("u", static_cast<int>(lti.B.cols()));
  d.output("y", static_cast<int>(lti.C.rows())) = k.out;
  return d;
}

}  // namespace titop_test
