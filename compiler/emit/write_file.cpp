#include <fmt/format.h>

#include <fstream>
#include <iterator>
#include <system_error>
#include <titop/compiler/emit/write_file.hpp>
#include <titop/graph/error.hpp>

namespace titop::emit {

namespace {

[[noreturn]] void refuse(const std::filesystem::path& path, const char* hint) {
  throw Error(Code::bad_file, fmt::format("{}: cannot be written", path.string()), hint);
}

bool put(const std::filesystem::path& path, const std::string& content) {
  std::ofstream file(path, std::ios::binary);
  file << content;
  file.close();
  return static_cast<bool>(file);
}

}  // namespace

void write_file(const std::filesystem::path& path, const std::string& content) {
  constexpr const char* hint = "check that the folder exists and may be written to";
  std::error_code error;
  const auto status = std::filesystem::status(path, error);
  if (std::filesystem::is_directory(status)) refuse(path, "it is a folder: name a file in it");
  if (std::filesystem::exists(status) && !std::filesystem::is_regular_file(status)) {
    if (!put(path, content)) refuse(path, hint);  // a pipe or a device has no place beside it
    return;
  }
  std::ifstream old(path, std::ios::binary);
  if (old && std::string(std::istreambuf_iterator<char>(old), {}) == content) return;
  old.close();
  std::filesystem::path beside = path;
  beside += ".part";
  const bool whole = put(beside, content);
  if (whole) std::filesystem::rename(beside, path, error);
  if (whole && !error) return;
  std::error_code ignored;
  std::filesystem::remove(beside, ignored);
  refuse(path, hint);
}

}  // namespace titop::emit
