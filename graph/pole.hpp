#pragma once

#include <complex>
#include <string_view>
#include <titop/graph/error.hpp>

namespace titop {

/// Throws not_finite if s is not finite. `subject`: the evaluated object, "demo" or "the model".
void check_finite(std::complex<double> s, std::string_view subject);

/// singular: at s there is no response. `subject`: "a SpringMass", "mode 2 of a FlexibleBody".
Error pole_at(std::complex<double> s, std::string_view subject);

}  // namespace titop
