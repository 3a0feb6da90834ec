#pragma once

#include <cstddef>

namespace titop::detail {

/// Requests pages of 2 MB (transparent huge pages) for this memory, which must not have been
/// written to yet: the system supplies fresh pages one by one, each at the cost of writing some
/// hundred numbers. Only for large blocks that will be written to as a whole. Does nothing if the C
/// library is not glibc.
void take_large_pages(void* begin, std::size_t bytes);

}  // namespace titop::detail
