#pragma once

#include <cstddef>
#include <string>
#include <string_view>

/// Compressed data in files, by zlib. For the folder's own files.
namespace titop::fe::detail {

/// False if the library was built without zlib.
bool can_inflate();

/// The first `most` bytes of a zlib stream, or as many as it has; those before its end if it is
/// truncated. False if the stream is damaged, by its structure or its check sum.
bool inflate_up_to(std::size_t most, std::string_view stream, std::string& result);

}  // namespace titop::fe::detail
