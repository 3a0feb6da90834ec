#pragma once

#include <titop/blocks/fe/beam.hpp>

namespace fe_test {

/// A beam of aluminium, 2 m long: grids 1, 2, ... from its root, evenly spaced.
inline titop::fe::Mesh boom(int elements) {
  return titop::beam_mesh({.length = 2.0,
                           .section = titop::rectangle(0.06, 0.04),
                           .material = {.E = 70e9, .nu = 0.33, .rho = 2700},
                           .elements = elements});
}

}  // namespace fe_test
