// Uses a generated model, and nothing of titop: half a period after a push it is on the other side.
#include "oscillator.hpp"

int main() {
  oscillator::State x{};
  oscillator::Input push{};
  push[oscillator::in::u] = 1;
  x = oscillator::step(x, push);
  const double before = oscillator::output(x, {})[oscillator::out::x];
  for (int k = 0; k < 16; ++k) x = oscillator::step(x, {});  // omega = 2 rad/s: 1.6 s of 3.14 s
  const double after = oscillator::output(x, {})[oscillator::out::x];
  return before > 0 && after < 0 ? 0 : 1;
}
