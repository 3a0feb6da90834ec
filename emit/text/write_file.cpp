#include <fmt/format.h>

#include <cerrno>
#include <cstdio>
#include <fstream>
#include <iterator>
#include <system_error>
#include <titop/emit/text/write_file.hpp>
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

/// A new, empty file in the same folder: NAME.part, or NAME.part2 ... if that exists.
std::filesystem::path new_beside(const std::filesystem::path& path) {
  constexpr int most = 100;
  for (int i = 1; i <= most; ++i) {
    std::filesystem::path beside = path;
    beside += i == 1 ? ".part" : fmt::format(".part{}", i);
    if (std::FILE* made = std::fopen(beside.c_str(), "wx")) {  // x: fails if there is one
      std::fclose(made);
      return beside;
    }
    if (errno != EEXIST) break;
  }
  return {};
}

/// The target of a chain of links; the path itself if it is none.
std::filesystem::path target_of(std::filesystem::path path) {
  constexpr int most = 40;  // as the system: more go round in a circle
  std::error_code error;
  for (int i = 0; i < most && std::filesystem::is_symlink(path, error); ++i)
    path = path.parent_path() / std::filesystem::read_symlink(path, error);
  return path;
}

}  // namespace

void write_file(const std::filesystem::path& path, const std::string& content) {
  constexpr const char* hint = "check that the folder exists and may be written to";
  std::error_code error;
  const auto status = std::filesystem::status(path, error);
  if (status.type() == std::filesystem::file_type::none) refuse(path, hint);  // links in a circle
  if (std::filesystem::is_directory(status)) refuse(path, "it is a folder: name a file in it");
  if (std::filesystem::exists(status) && !std::filesystem::is_regular_file(status)) {
    if (!put(path, content))
      refuse(path, hint);  // a pipe or a device has no room for a file next to it
    return;
  }
  std::ifstream old(path, std::ios::binary);
  if (old && std::string(std::istreambuf_iterator<char>(old), {}) == content) return;
  old.close();
  const std::filesystem::path target = target_of(path), beside = new_beside(target);
  if (beside.empty()) refuse(path, hint);
  const bool whole = put(beside, content);
  if (whole) std::filesystem::rename(beside, target, error);
  if (whole && !error) return;
  std::error_code ignored;
  std::filesystem::remove(beside, ignored);
  refuse(path, hint);
}

}  // namespace titop::emit
