#include <string>
#include <titop/blocks/fe/fortran.hpp>
#include <titop/blocks/fe/text_file.hpp>

namespace titop::fe {

bool parse_fortran(std::string_view text, double& value) {
  std::string plain;
  for (const char c : trim(text)) {
    const bool letter = c == 'D' || c == 'd' || c == 'E' || c == 'e';
    const bool sign = c == '+' || c == '-';
    if (sign && !plain.empty() && plain.back() != 'e') plain += 'e';
    plain += letter ? 'e' : c;
  }
  return parse(plain, value);
}

}  // namespace titop::fe
