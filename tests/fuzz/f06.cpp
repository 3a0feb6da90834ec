// f06: tables, the grids of its echo, and the body of the first of them.
#include <titop/blocks/fe/f06.hpp>

#include "input_file.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const fuzz::InputFile input(fuzz::text(data, size));
  return fuzz::refuses_or_reads([&] {
    const titop::fe::F06File file = titop::fe::read_f06(input.path());
    const std::vector<titop::fe::Grid> grids = titop::fe::f06_grids(file);
    titop::fe::f06_modal_data(file, grids, std::to_string(grids.front().id),
                              {std::to_string(grids.back().id)});
  });
}
