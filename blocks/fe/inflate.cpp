#include <titop/blocks/fe/inflate.hpp>

#ifdef TITOP_ZLIB
#include <zlib.h>

#include <algorithm>
#endif

namespace titop::fe::detail {

#ifdef TITOP_ZLIB

bool can_inflate() { return true; }

bool inflate_up_to(std::size_t most, std::string_view stream, std::string& result) {
  result.clear();
  z_stream z{};
  z.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(stream.data()));
  z.avail_in = static_cast<uInt>(stream.size());
  if (inflateInit(&z) != Z_OK) return false;
  int state = Z_OK;
  while (state == Z_OK && result.size() < most) {
    // As much again: a stream may be a thousandth of its data.
    constexpr std::size_t least = 1U << 16U, largest = 1U << 30U;
    const std::size_t done = result.size();
    const std::size_t room = std::min(most - done, std::clamp(done, least, largest));
    result.resize(done + room);
    z.next_out = reinterpret_cast<Bytef*>(&result[done]);
    z.avail_out = static_cast<uInt>(room);
    state = inflate(&z, Z_NO_FLUSH);
    result.resize(done + room - z.avail_out);
  }
  inflateEnd(&z);
  return state == Z_OK || state == Z_STREAM_END || state == Z_BUF_ERROR;  // no more input
}

#else

bool can_inflate() { return false; }

bool inflate_up_to(std::size_t, std::string_view, std::string&) { return false; }

#endif

}  // namespace titop::fe::detail
