#pragma once

#include <doctest/doctest.h>
#include <stdlib.h>

#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>

namespace titop_test {

/// A scratch folder of its own, gone at the end.
struct Folder {
  std::filesystem::path path;
  Folder() {
    std::string name = (std::filesystem::temp_directory_path() / "titop-XXXXXX").string();
    REQUIRE(mkdtemp(name.data()) != nullptr);
    path = name;
  }
  ~Folder() { std::filesystem::remove_all(path); }
  Folder(const Folder&) = delete;
  Folder& operator=(const Folder&) = delete;

  void write(const std::string& name, const std::string& text) const {
    std::ofstream(path / name, std::ios::binary) << text;
  }
  std::string read(const std::string& name) const {
    std::ifstream file(path / name, std::ios::binary);
    return {std::istreambuf_iterator<char>(file), {}};
  }
  /// Exit code of a shell command run here; its output goes to `log`.
  int run(const std::string& command, const std::string& log = "log.txt") const {
    const std::string all = "cd '" + path.string() + "' && { " + command + "; } > " + log + " 2>&1";
    const int status = std::system(all.c_str());
    return status == 0 ? 0 : 1;
  }
};

}  // namespace titop_test
