#pragma once

namespace titop::detail {

/// Makes the C library keep memory that is freed, up to 64 MB, instead of giving it back to the
/// system and asking for it again: at every s a transfer takes and frees a few hundred kB, and the
/// page faults that follow took half of its time. Done once; what the program or its environment
/// has set (mallopt, MALLOC_TRIM_THRESHOLD_ and the like) stays. Nothing where the library is not
/// glibc.
void keep_memory();

}  // namespace titop::detail
