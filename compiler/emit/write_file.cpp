#include <fmt/format.h>

#include <fstream>
#include <iterator>
#include <titop/compiler/emit/write_file.hpp>
#include <titop/graph/error.hpp>

namespace titop::emit {

void write_file(const std::filesystem::path& path, const std::string& content) {
  std::ifstream old(path, std::ios::binary);
  if (old && std::string(std::istreambuf_iterator<char>(old), {}) == content) return;
  old.close();
  std::ofstream file(path, std::ios::binary);
  file << content;
  file.flush();
  if (!file)
    throw Error(Code::bad_file, fmt::format("{}: cannot be written", path.string()),
                "check that the folder exists and may be written to");
}

}  // namespace titop::emit
