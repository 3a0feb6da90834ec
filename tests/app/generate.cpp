// titop generate: a planted mistake finds the family that has a place for it; otherwise the error
// names the options that bring one.
#include <doctest/doctest.h>

#include "app/shell.hpp"

using app_test::has;
using app_test::Run;
using app_test::Shell;

TEST_CASE("every mistake can be planted without a word about the family") {
  const Shell shell;
  for (const std::string code :
       {"no-equation", "two-equations", "size", "quantity", "frame", "structure", "ill-posed",
        "improper", "kinematic-loop", "bad-inertia", "bad-modes", "bad-value", "not-a-rotation",
        "not-finite", "duplicate-name", "bad-file"}) {
    CAPTURE(code);
    CHECK(shell.titop("generate a.json --mistake " + code).code == 0);
    const Run r = shell.titop("check a.json");
    CHECK(r.code == 1);
    CHECK(has(r.err, "error[" + code + "]"));
  }
}

TEST_CASE("a family without a place for the mistake: the error names the option") {
  const Shell shell;
  for (const std::string code : {"frame", "bad-modes", "not-a-rotation"}) {
    CAPTURE(code);
    const Run r = shell.titop("generate a.json --family scalar --mistake " + code);
    CHECK(r.code == 2);
    CHECK(has(r.err, "'" + code + "'"));
    CHECK(has(r.err, "--family spatial"));
  }
  Run r = shell.titop("generate a.json --mistake no-equation --bodies 1");
  CHECK(r.code == 2);
  CHECK(has(r.err, "--bodies"));
  r = shell.titop("generate a.json --mistake bad-value --family spatial --twins");
  CHECK(r.code == 2);
  CHECK(has(r.err, "--family scalar"));
}
