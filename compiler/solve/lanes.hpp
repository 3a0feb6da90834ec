#pragma once

/// Vector registers of a chosen width. A width must be the processor's own: a compiler keeps sums
/// of another width in memory. So each kernel is compiled for all, and the widest that the
/// processor has is called.
namespace titop::solve {

/// N doubles in one register.
template <int N>
using Lanes __attribute__((vector_size(8 * N))) = double;
/// Such numbers at any address. (A struct: clang drops the attributes of an alias template.)
template <class L>
struct __attribute__((packed, may_alias)) Loose {
  L lanes;
};

template <class L>
constexpr int kLanes = static_cast<int>(sizeof(L) / sizeof(double));

// By reference: a vector returned by value has another ABI without AVX. Not by memcpy: g++ 12 then
// takes a register in and out of memory in between.
template <class L>
[[gnu::always_inline]] inline void load(L& to, const double* from) {
  to = reinterpret_cast<const Loose<L>*>(from)->lanes;
}
template <class L>
[[gnu::always_inline]] inline void store(double* to, const L& from) {
  reinterpret_cast<Loose<L>*>(to)->lanes = from;
}

/// The widest registers that this processor has, of at most so many lanes: 8, 4 or 2.
inline int lanes_here([[maybe_unused]] int at_most) {
#if defined(__x86_64__)
  if (at_most >= 8 && __builtin_cpu_supports("avx512f")) return 8;
  if (at_most >= 4 && __builtin_cpu_supports("avx2")) return 4;
#endif
  return 2;
}

}  // namespace titop::solve
