#pragma once

/// On x86-64 Linux a function with TITOP_WIDE is compiled for wider vectors, too, and these are
/// taken if the processor has them. Sums of doubles that are not regrouped get the same bits
/// either way.
#if defined(__x86_64__) && defined(__linux__) && defined(__GNUC__) && !defined(__clang__)
#define TITOP_WIDE __attribute__((target_clones("avx512f", "avx2", "default")))
#else
#define TITOP_WIDE
#endif
