#pragma once

#include <sys/mman.h>
#include <unistd.h>

#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <exception>
#include <filesystem>
#include <string>
#include <string_view>
#include <titop/graph/error.hpp>

/// Common to the fuzzers. Each gives a reader arbitrary bytes of libFuzzer; a titop::Error with a
/// mistake in it is a valid result, anything else (a crash, another exception, a report of the
/// sanitizers, 10 s, 2 GB) is a finding.
namespace fuzz {

/// Bytes as a file in memory, under a path that the readers can open.
class InputFile {
 public:
  explicit InputFile(std::string_view bytes) : descriptor_(memfd_create("fuzz", 0)) {
    while (!bytes.empty()) {
      const ssize_t written = write(descriptor_, bytes.data(), bytes.size());
      if (written <= 0) std::abort();
      bytes.remove_prefix(static_cast<std::size_t>(written));
    }
  }
  ~InputFile() { close(descriptor_); }
  InputFile(const InputFile&) = delete;
  InputFile& operator=(const InputFile&) = delete;

  std::filesystem::path path() const { return "/proc/self/fd/" + std::to_string(descriptor_); }

 private:
  int descriptor_;
};

inline std::string_view text(const std::uint8_t* data, std::size_t size) {
  return {reinterpret_cast<const char*>(data), size};
}

/// Runs the reader.
template <class Read>
int refuses_or_reads(Read read) {
  try {
    read();
  } catch (const titop::Error& error) {
    if (error.mistakes().empty()) std::abort();
  }
  return 0;
}

}  // namespace fuzz
