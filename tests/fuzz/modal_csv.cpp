// Modal data as text; data that can be read are also written and read again.
#include <titop/blocks/fe/modal_csv.hpp>

#include "input_file.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const fuzz::InputFile file(fuzz::text(data, size));
  return fuzz::refuses_or_reads([&] {
    const std::string again = titop::fe::modal_csv(titop::fe::read_modal_csv(file.path()));
    if (again.empty()) std::abort();
  });
}
