// Files are written whole or not at all.
#include <doctest/doctest.h>

#include <titop/compiler/emit/write_file.hpp>
#include <titop/graph/error.hpp>

#include "support/folder.hpp"

using namespace titop;
using titop_test::Folder;

TEST_CASE("a file is replaced whole; one that says the same is left alone") {
  const Folder folder;
  const auto file = folder.path / "a.txt";
  emit::write_file(file, "one");
  CHECK(folder.read("a.txt") == "one");
  const auto old = std::filesystem::file_time_type::clock::now() - std::chrono::hours(1);
  std::filesystem::last_write_time(file, old);
  emit::write_file(file, "one");
  CHECK(std::filesystem::last_write_time(file) == old);
  emit::write_file(file, "two");
  CHECK(folder.read("a.txt") == "two");
  CHECK(!std::filesystem::exists(folder.path / "a.txt.part"));
}

TEST_CASE("a folder, or a folder that is not there, is no file to write: bad_file") {
  const Folder folder;
  std::filesystem::create_directory(folder.path / "sub");
  CHECK_THROWS_WITH_AS(emit::write_file(folder.path / "sub", "x"),
                       doctest::Contains("it is a folder"), Error);
  CHECK_THROWS_WITH_AS(emit::write_file(folder.path / "none" / "a", "x"),
                       doctest::Contains("cannot be written"), Error);
}

TEST_CASE("where the new file cannot be written whole, the old one stays") {
  const Folder folder;
  emit::write_file(folder.path / "a.txt", "old");
  std::filesystem::create_directory(folder.path / "a.txt.part");  // in its way
  CHECK_THROWS_AS(emit::write_file(folder.path / "a.txt", "new"), Error);
  CHECK(folder.read("a.txt") == "old");
}
