// Bulk data: grids and their coordinate systems.
#include <titop/blocks/fe/bulk_data.hpp>

#include "input_file.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const fuzz::InputFile file(fuzz::text(data, size));
  return fuzz::refuses_or_reads([&] { titop::fe::read_grids(file.path()); });
}
