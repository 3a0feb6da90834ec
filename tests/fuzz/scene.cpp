// Diagram files; a diagram that can be read is also written, and then read again as the same text.
#include <titop/blocks/diagram_file/diagram_file.hpp>

#include "input_file.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  return fuzz::refuses_or_reads([&] {
    const std::string written = titop::diagram_json(titop::parse_diagram(fuzz::text(data, size)));
    if (titop::diagram_json(titop::parse_diagram(written)) != written) std::abort();
  });
}
