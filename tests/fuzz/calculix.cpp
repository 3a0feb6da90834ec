// CalculiX: stiffness, mass, degrees of freedom and deck, one after the other, a line of = between.
#include <array>
#include <titop/blocks/fe/calculix.hpp>

#include "input_file.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  std::string_view rest = fuzz::text(data, size);
  std::array<std::string_view, 4> parts;
  for (std::string_view& part : parts) {
    const auto end = rest.find("====\n");
    part = rest.substr(0, end);
    rest.remove_prefix(end == std::string_view::npos ? rest.size() : end + 5);
  }
  const fuzz::InputFile sti(parts[0]), mas(parts[1]), dof(parts[2]), inp(parts[3]);
  return fuzz::refuses_or_reads([&] {
    titop::fe::read_calculix({sti.path(), mas.path(), dof.path(), inp.path()},
                             {{"P", 2}, {"C", 1}});
  });
}
