#pragma once

#include <doctest/doctest.h>

#include <string>

#include "support/folder.hpp"

/// The program, run in a folder of its own.
namespace app_test {

struct Run {
  int code = 0;
  std::string out, err;
};

inline bool has(const std::string& text, const std::string& words) {
  return text.find(words) != std::string::npos;
}

class Shell {
 public:
  Run titop(const std::string& words) const {
    const std::string command = "'" TITOP_PROGRAM "' " + words + " >out 2>err; echo $? >code";
    REQUIRE(folder.run(command) == 0);
    return {std::stoi(folder.read("code")), folder.read("out"), folder.read("err")};
  }
  titop_test::Folder folder;
};

}  // namespace app_test
