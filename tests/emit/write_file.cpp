// Files are written whole or not at all.
#include <doctest/doctest.h>

#include <titop/emit/text/write_file.hpp>
#include <titop/graph/error.hpp>

#include "support/folder.hpp"
#include "support/mistakes.hpp"

using namespace titop;
using titop_test::Folder;

TEST_CASE("a file is replaced as a whole; one of the same content keeps its time") {
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
  for (const auto& file : {folder.path / "sub", folder.path / "none" / "a"})
    CHECK(titop_test::says(titop_test::error_of([&] { emit::write_file(file, "x"); }),
                           Code::bad_file, {file.string()}));
}

TEST_CASE("where the new file cannot be written whole, the old one stays") {
  const Folder folder;
  const std::string longest(255, 'a');  // too long for the name of the temporary file
  folder.write(longest, "old");
  CHECK_THROWS_AS(emit::write_file(folder.path / longest, "new"), Error);
  CHECK(folder.read(longest) == "old");
}

TEST_CASE("a file called NAME.part is not written over") {
  const Folder folder;
  folder.write("a.txt", "old");
  folder.write("a.txt.part", "notes");
  std::filesystem::create_directory(folder.path / "a.txt.part2");
  emit::write_file(folder.path / "a.txt", "new");
  CHECK(folder.read("a.txt") == "new");
  CHECK(folder.read("a.txt.part") == "notes");
  CHECK(std::distance(std::filesystem::directory_iterator(folder.path), {}) == 3);
}

TEST_CASE("a link stays, and its target is written") {
  const Folder folder;
  namespace fs = std::filesystem;
  fs::create_directory(folder.path / "sub");
  folder.write("sub/real", "old");
  fs::create_symlink("real", folder.path / "sub" / "near");
  fs::create_symlink("sub/near", folder.path / "far");
  emit::write_file(folder.path / "far", "new");
  CHECK(fs::is_symlink(folder.path / "far"));
  CHECK(fs::is_symlink(folder.path / "sub" / "near"));
  CHECK(!fs::is_symlink(folder.path / "sub" / "real"));
  CHECK(folder.read("sub/real") == "new");
  fs::create_symlink("sub/none", folder.path / "to come");
  emit::write_file(folder.path / "to come", "new");
  CHECK(folder.read("sub/none") == "new");
  fs::create_symlink("circle", folder.path / "circle");
  CHECK_THROWS_AS(emit::write_file(folder.path / "circle", "x"), Error);
  CHECK(fs::is_symlink(folder.path / "circle"));
}
