#pragma once

#include <functional>
#include <string>
#include <titop/titop.hpp>
#include <vector>

/// Small scenes that together cover all special cases of the passes.
namespace titop_test {

struct NamedScene {
  std::string name;
  std::function<titop::Diagram()> make;
  int states = 0;                     ///< of the compiled system, before `minimize`
  std::vector<std::string> inverted;  ///< channels, forced by the equations, in natural order
};

const std::vector<NamedScene>& scenes();

}  // namespace titop_test
