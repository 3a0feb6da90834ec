#pragma once

#include <titop/titop.hpp>

#include "app/shell.hpp"
#include "support/five_masses.hpp"

namespace app_test {

/// The program in a folder with masses.json, the five masses.
class MassesShell : public Shell {
 public:
  MassesShell() { titop::write_diagram(diagram(), folder.path / "masses.json"); }
  static titop::Diagram diagram() {
    return titop_test::five_masses_scene({1, 2, 3, 4, 5}, {10, 26, 33, 20, 95});
  }
};

}  // namespace app_test
