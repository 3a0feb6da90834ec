#pragma once

#include <bit>
#include <cstring>
#include <string>

namespace fe_test {

/// The bytes of a number in a file of this byte order.
template <class T>
std::string raw(T value, bool big_endian) {
  std::string text(sizeof(T), '\0');
  std::memcpy(text.data(), &value, sizeof(T));
  if (big_endian != (std::endian::native == std::endian::big)) text = {text.rbegin(), text.rend()};
  return text;
}

}  // namespace fe_test
