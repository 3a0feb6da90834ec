// OP2: data blocks, and the results read from them.
#include <titop/blocks/fe/op2_results.hpp>

#include "input_file.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const fuzz::InputFile input(fuzz::text(data, size));
  return fuzz::refuses_or_reads([&] {
    const titop::fe::Op2File file = titop::fe::read_op2(input.path());
    fuzz::refuses_or_reads([&] { titop::fe::op2_modes(file); });
    fuzz::refuses_or_reads([&] { titop::fe::op2_grids(file); });
    fuzz::refuses_or_reads([&] { titop::fe::op2_matrices(file, "KAA", "MAA"); });
    fuzz::refuses_or_reads([&] { titop::fe::op2_modal_data(file, "1", {"3"}); });
  });
}
