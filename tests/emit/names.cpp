// Names of any kind in the files for Python and Octave: both can read them.
#include <doctest/doctest.h>

#include <cstring>
#include <titop/compiler/diagram/text.hpp>
#include <titop/titop.hpp>

#include "support/folder.hpp"

using namespace titop;
using namespace titop_test;

namespace {

StateSpace model(const std::vector<std::string>& inputs) {
  StateSpace m;
  const auto n = static_cast<Eigen::Index>(inputs.size());
  m.A.resize(0, 0), m.B.resize(0, n), m.C.resize(1, 0), m.D = Eigen::MatrixXd::Ones(1, n);
  m.inputs = inputs, m.outputs = {"y"};
  return m;
}

bool has(const std::string& text, const std::string& part) {
  return text.find(part) != std::string::npos;
}

bool is_utf8(std::string_view text) {
  while (!text.empty()) {
    const std::size_t n = diagram::utf8_length(text);
    if (n == 0) return false;
    text.remove_prefix(n);
  }
  return true;
}

}  // namespace

TEST_CASE("a Python module is UTF-8 throughout, whatever its names are made of") {
  const Folder folder;
  write_numpy(model({"κ 机 \xC2\x85", "broken \xC3( \xFF", "cut \xE6\x9C", "\"\\\n",
                     std::string("a\0b", 3)}),
              folder.path, "m");
  const std::string text = folder.read("m.py");
  CHECK(is_utf8(text));
  CHECK(has(text, "\"κ 机 \xC2\x85\","));  // valid UTF-8 is unchanged
  CHECK(has(text, R"("broken \xc3( \xff",)"));
  CHECK(has(text, R"("cut \xe6\x9c",)"));
  CHECK(has(text, R"("\"\\\x0a",)"));
  CHECK(has(text, R"("a\x00b",)"));
}

TEST_CASE("a MAT-file has blanks for control characters, and U+FFFD for bytes that are no UTF-8") {
  const Folder folder;
  write_mat(model({"c\td", "e\r\n\x7F", "f\xFF"}), folder.path / "m.mat");
  const std::string file = folder.read("m.mat");
  for (const std::u16string text : {u"c d", u"e   ", u"f\uFFFD"}) {
    std::string bytes(2 * text.size(), ' ');
    std::memcpy(bytes.data(), text.data(), bytes.size());
    CHECK(has(file, bytes));
  }
}

TEST_CASE("a MATLAB function has no control characters but its own line ends") {
  const Folder folder;
  write_matlab(model({std::string("a\0b", 3), "c\x01\x1A\x7F\td", "it's\r\nκ"}),
               folder.path / "m.m");
  const std::string text = folder.read("m.m");
  CHECK(has(text, "'a b'\n"));
  CHECK(has(text, "'c    d'\n"));
  CHECK(has(text, "'it''s  κ'\n"));
  for (const char c : text)
    CHECK((c == '\n' || (static_cast<unsigned char>(c) >= 0x20 && c != 0x7F)));
}
