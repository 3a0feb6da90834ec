#include <doctest/doctest.h>
#include <sys/resource.h>

#include <optional>
#include <string>
#include <titop/titop.hpp>

/// What is taken and freed at every s stays in the process.

using namespace titop;

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

/// Other libraries and sanitizers have a way of their own with memory.
#if defined(__GLIBC__) && !defined(__SANITIZE_ADDRESS__)
constexpr bool kKeeps = true;
#else
constexpr bool kKeeps = false;
#endif

long page_faults() {
  rusage usage{};
  REQUIRE(getrusage(RUSAGE_SELF, &usage) == 0);
  return usage.ru_minflt;
}

}  // namespace

TEST_CASE("memory: another s takes what the one before has freed") {
  const System system = compile(chain(1000), {.minimize_up_to = 0});
  const auto responses = [&](int count) {
    for (int i = 0; i < count; ++i) CHECK(system.transfer({0.1, 1.0 + i}).allFinite());
  };
  responses(10);
  const long before = page_faults();
  responses(50);
  // One transfer takes 100 pages and more.
  if (kKeeps) CHECK(page_faults() - before <= 50);
}
