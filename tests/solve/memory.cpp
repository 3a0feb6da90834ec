#include <doctest/doctest.h>
#include <sys/resource.h>

#include <complex>
#include <cstdint>
#include <fstream>
#include <optional>
#include <sstream>
#include <string>
#include <titop/compiler/solve/storage.hpp>
#include <titop/titop.hpp>

/// Memory allocated and freed at every s is kept by the process; large blocks have large pages.

using namespace titop;

/// Its address is null unless the address sanitizer, which manages memory itself, is linked.
extern "C" [[gnu::weak]] void __asan_init();

namespace {

Diagram chain(int n) {
  Diagram d{"chain"};
  std::optional<SpringMass::Handle> before;
  for (int i = 0; i < n; ++i) {
    auto z = d.add("z" + std::to_string(i), SpringMass{.mass = 1.0, .stiffness = 100.0});
    before ? mount(z, before->child) : ground(z);
    before = z;
  }
  before->child.force = d.input("u");
  d.output("a") = before->child.accel;
  return d;
}

bool keeps_memory() {
#if defined(__GLIBC__)
  return __asan_init == nullptr;
#else
  return false;
#endif
}

long page_faults() {
  rusage usage{};
  REQUIRE(getrusage(RUSAGE_SELF, &usage) == 0);
  return usage.ru_minflt;
}

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

TEST_CASE("memory: another s reuses the memory of the one before") {
  const System system = compile(chain(1000), {.minimize_up_to = 0});
  const auto responses = [&](int count) {
    for (int i = 0; i < count; ++i) CHECK(system.transfer({0.1, 1.0 + i}).allFinite());
  };
  responses(10);
  const long before = page_faults();
  responses(50);
  // One transfer takes 100 pages and more.
  if (keeps_memory()) CHECK(page_faults() - before <= 50);
}
