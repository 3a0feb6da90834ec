#pragma once

#include <string_view>

namespace titop::fe {

/// A real number as Fortran programs write it: "1.5", "-2.1D+03", "3.245226567+6" (no letter),
/// "1.0-100". Blanks around it are skipped. False if the text is anything else or not finite.
bool parse_fortran(std::string_view text, double& value);

}  // namespace titop::fe
