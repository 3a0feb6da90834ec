#include <fmt/format.h>

#include <cmath>
#include <titop/graph/pole.hpp>

namespace titop {

void check_finite(std::complex<double> s, std::string_view subject) {
  if (std::isfinite(s.real()) && std::isfinite(s.imag())) return;
  throw Error(Code::not_finite,
              fmt::format("{} at s = {}{:+}j: that is no number", subject, s.real(), s.imag()),
              "give a finite s, a finite omega");
}

Error pole_at(std::complex<double> s, std::string_view subject) {
  return {Code::singular, fmt::format("{} has a pole at s = {}{:+}j", subject, s.real(), s.imag()),
          "evaluate beside the pole"};
}

}  // namespace titop
