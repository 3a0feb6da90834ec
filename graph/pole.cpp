#include <fmt/format.h>

#include <titop/graph/pole.hpp>

namespace titop {

Error pole_at(std::complex<double> s, std::string_view what) {
  return {Code::singular, fmt::format("{} has a pole at s = {}{:+}j", what, s.real(), s.imag()),
          "evaluate beside the pole"};
}

}  // namespace titop
