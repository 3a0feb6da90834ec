// OP4, text and binary, dense and sparse.
#include <titop/blocks/fe/op4.hpp>

#include "input_file.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const fuzz::InputFile file(fuzz::text(data, size));
  return fuzz::refuses_or_reads([&] { titop::fe::read_op4(file.path()); });
}
