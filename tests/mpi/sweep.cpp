// sweep over the processes of mpirun: the results and errors of one process, in the same order.
#include <doctest/doctest.h>

#include <string>
#include <titop/titop.hpp>

#include "app/shell.hpp"

using namespace titop;
using app_test::has;
using app_test::Run;

namespace {

/// Test machines run as root, with fewer cores than processes; MPI itself leaks at its end.
std::string run_by(int processes) {
  return "OMPI_ALLOW_RUN_AS_ROOT=1 OMPI_ALLOW_RUN_AS_ROOT_CONFIRM=1 ASAN_OPTIONS=detect_leaks=0 "
         "'" TITOP_MPIRUN "' --oversubscribe -n " +
         std::to_string(processes);
}

class Shell : public app_test::Shell {
 public:
  Shell() {
    Diagram d{"mass"};
    auto u = d.input("u");
    auto k = d.param("k", 8);
    auto z = d.add("z", SpringMass{.mass = 2, .stiffness = k});
    ground(z);
    z.child.force = u;
    d.output("x") = z.stretch;
    write_diagram(d, folder.path / "mass.json");
  }
  /// titop sweep by so many processes.
  Run sweep(int processes, const std::string& words) const {
    const std::string command =
        run_by(processes) + " '" TITOP_PROGRAM "' sweep " + words + " >out 2>err; echo $? >code";
    REQUIRE(folder.run(command) == 0);
    return {std::stoi(folder.read("code")), folder.read("out"), folder.read("err")};
  }
};

}  // namespace

TEST_CASE("sweep over the processes of mpirun: the same file as of one process") {
  const Shell shell;
  std::string points = "k\n";
  for (int i = 1; i <= 7; ++i) points += std::to_string(3 * i) + "\n";
  shell.folder.write("points.csv", points);
  for (const std::string options : {"", " --omega 0.1 10 5", " --part 2/3"}) {
    CAPTURE(options);
    CHECK(shell.sweep(1, "mass.json points.csv one.csv" + options).code == 0);
    for (const int processes : {2, 3, 5}) {  // of --part 2/3, two rows, three of five have none
      CAPTURE(processes);
      CHECK(shell.sweep(processes, "mass.json points.csv all.csv" + options).code == 0);
      CHECK(shell.folder.read("all.csv") == shell.folder.read("one.csv"));
    }
  }
}

TEST_CASE("sweep over the processes of mpirun: a refused row, and a wrong file, once each") {
  const Shell shell;
  // 2 rad/s is the pole of k = 8, in the second half.
  shell.folder.write("points.csv", "k\n18\n32\n50\n8\n");
  Run r = shell.sweep(2, "mass.json points.csv all.csv --omega 2 3 2");
  CHECK(r.code != 0);
  CHECK(has(r.err, "points.csv:5"));
  CHECK(shell.sweep(1, "mass.json points.csv one.csv --omega 2 3 2").code == 1);
  CHECK(shell.folder.read("all.csv") == shell.folder.read("one.csv"));
  r = shell.sweep(2, "mass.json none.csv all.csv");
  CHECK(r.code != 0);
  const std::size_t first = r.err.find("error[bad-file]");
  CHECK(first != std::string::npos);
  CHECK(r.err.find("error[bad-file]", first + 1) == std::string::npos);
}
