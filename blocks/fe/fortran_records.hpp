#pragma once

#include <algorithm>
#include <cstdint>
#include <cstring>
#include <span>
#include <string>
#include <vector>

/// Binary files of Nastran (OUTPUT4, OUTPUT2): Fortran records of words. For the folder's own
/// files.
namespace titop::fe::detail {

/// Integers and reals of a byte order and word size.
struct WordLayout {
  bool swapped = false;  ///< against this machine
  std::size_t word = 4;  ///< bytes of an integer

  template <class T>
  T value(const char* at) const {
    char bytes[sizeof(T)];
    std::memcpy(bytes, at, sizeof(T));
    if (swapped) std::reverse(bytes, bytes + sizeof(T));
    T result;
    std::memcpy(&result, bytes, sizeof(T));
    return result;
  }
  long long integer(const char* at) const {
    return word == 4 ? value<std::int32_t>(at) : value<std::int64_t>(at);
  }
};

/// Reals of 4 or 8 bytes, as many as there are.
std::vector<double> reals(std::span<const char> bytes, std::size_t size, const WordLayout& layout);

/// Characters without blanks: a name in words of 4 or 8 bytes.
std::string name_in(std::span<const char> bytes);

/// A file's records: the length of each before and behind it, four bytes each.
class FortranRecords {
 public:
  /// Words have 4 bytes if the first record has `short_record` bytes, 8 if it has twice as many, in
  /// the byte order that makes it so. Throws bad_file for any other; `kind` is for that message.
  FortranRecords(std::string name, std::span<const char> bytes, int short_record, const char* kind);

  bool at_end() const { return next_ == bytes_.size(); }
  std::span<const char> next();

  /// Throws bad_file with the file, `part`, the record and its byte.
  [[noreturn]] void refuse(const std::string& found, const std::string& expected) const;

  WordLayout layout;
  std::string part;  ///< "matrix KAA", for messages

 private:
  std::string name_;
  std::span<const char> bytes_;
  std::size_t next_ = 0, at_ = 0;
  int number_ = 0;
};

}  // namespace titop::fe::detail
