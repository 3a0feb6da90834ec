#pragma once

#include <cstddef>

/// What memory costs: fresh pages are given by the system one by one, at the price of writing some
/// hundred numbers each. Both functions do nothing where the C library is not glibc.
namespace titop::detail {

/// Makes the C library keep memory that is freed, up to 64 MB, instead of giving it back to the
/// system and asking for it again: at every s a transfer takes and frees a few hundred kB, and the
/// page faults that follow took half of its time. Done once; what the program or its environment
/// has set (mallopt, MALLOC_TRIM_THRESHOLD_ and the like) stays.
void keep_memory();

/// Asks the system to give this memory, which nobody has written to yet, in pages of 2 MB where it
/// has such (transparent huge pages). Only what is large; it is to be written to as a whole.
void take_large_pages(void* begin, std::size_t bytes);

}  // namespace titop::detail
