#pragma once

#include <cstddef>

/// Cost of memory: the system supplies fresh pages one by one, each at the cost of writing some
/// hundred numbers. Both functions do nothing if the C library is not glibc.
namespace titop::detail {

/// Makes the C library keep freed memory, up to 64 MB, instead of returning it to the system: at
/// every s a transfer allocates and frees a few hundred kB, and the page faults took half of its
/// time. Done once; settings of the program or its environment (mallopt, MALLOC_TRIM_THRESHOLD_ and
/// the like) are not changed.
void keep_memory();

/// Requests pages of 2 MB (transparent huge pages) for this memory, which must not have been
/// written to yet. Only for large blocks that will be written to as a whole.
void take_large_pages(void* begin, std::size_t bytes);

}  // namespace titop::detail
