#include <string>
#include <titop/blocks/fe/fortran.hpp>
#include <titop/blocks/fe/text_file.hpp>

namespace titop::fe {

bool parse_fortran(std::string_view text, double& value) {
  std::string plain(trim(text));
  bool has_exponent = false;
  for (char& c : plain)
    if (c == 'D' || c == 'd' || c == 'E' || c == 'e') {
      c = 'e';
      has_exponent = true;
    }
  if (!has_exponent)
    if (const auto sign = plain.find_last_of("+-"); sign != std::string::npos && sign > 0)
      plain.insert(sign, "e");
  return parse(plain, value);
}

}  // namespace titop::fe
