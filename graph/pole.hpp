#pragma once

#include <complex>
#include <string_view>
#include <titop/graph/error.hpp>

namespace titop {

/// singular: at s there is no response. `what`: "a SpringMass", "mode 2 of a FlexibleBody".
Error pole_at(std::complex<double> s, std::string_view what);

}  // namespace titop
