#include <titop/emit/text/one_line.hpp>

namespace titop::emit {

std::string on_one_line(std::string text) {
  for (char& c : text)
    if (const auto byte = static_cast<unsigned char>(c); byte < 0x20 || byte == 0x7f) c = ' ';
  return text;
}

}  // namespace titop::emit
