#include <doctest/doctest.h>

#include <complex>
#include <cstdint>
#include <fstream>
#include <sstream>
#include <string>
#include <titop/compiler/solve/storage.hpp>

/// Large blocks of memory have large pages.

using namespace titop;

namespace {

/// The kernel's flags of the memory at an address (VmFlags of proc(5)); empty if there are none.
std::string flags_of(const void* address) {
  std::ifstream maps("/proc/self/smaps");
  const auto place = reinterpret_cast<std::uintptr_t>(address);
  bool here = false;
  for (std::string line; std::getline(maps, line);) {
    std::istringstream words(line);
    std::uintptr_t first = 0, end = 0;
    char dash = 0;
    if (words >> std::hex >> first >> dash >> end && dash == '-')
      here = first <= place && place < end;
    if (here && line.starts_with("VmFlags:")) return line + " ";
  }
  return {};
}

}  // namespace

TEST_CASE("memory: large blocks have large pages, if the system has them") {
  const bool has = std::ifstream("/sys/kernel/mm/transparent_hugepage/enabled").good();
  const auto large = [&](const void* address) {
    const std::string flags = flags_of(address);
    return flags.empty() || flags.find(" hg ") != std::string::npos;
  };
  constexpr std::size_t kCount = std::size_t{4} << 20;  // 64 MB
  const solve::Storage<std::complex<double>> numbers(kCount);
  const auto matrix = solve::unwritten<double>(kCount, 2);
#if defined(__GLIBC__)
  if (has) {
    CHECK(large(numbers.data() + kCount / 2));
    CHECK(large(matrix.data() + kCount));
  }
#endif
  CHECK(numbers.size() == kCount);
}
