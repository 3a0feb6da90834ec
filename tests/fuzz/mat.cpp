// MAT-files: all variables.
#include <titop/blocks/fe/mat.hpp>

#include "input_file.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const fuzz::InputFile input(fuzz::text(data, size));
  return fuzz::refuses_or_reads([&] { titop::fe::read_mat(input.path()); });
}
