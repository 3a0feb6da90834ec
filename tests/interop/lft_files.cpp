// Octave and Python (NumPy) load a linear fractional transformation and close it at other values.
#include <doctest/doctest.h>
#include <fmt/format.h>

#include <cstring>
#include <nlohmann/json.hpp>
#include <titop/titop.hpp>

#include "support/close.hpp"
#include "support/folder.hpp"
#include "support/skip.hpp"

using namespace titop;
using namespace titop_test;
using Eigen::MatrixXcd;

namespace {

/// A tilted body on a hub, its mass and tilt unknown.
System tilted() {
  Diagram d{"tilted"};
  const Param m = d.param("it's m", 3), tilt = d.param("tilt", 0.3);
  auto hub = d.add("hub", RigidBody{.mass = 9, .children = {{"C", {0.5, 0.2, 0}}}});
  auto tip = d.add("tip", RigidBody{.mass = m, .PA = {0.1, 0.4, 0}});
  auto z = d.add("z", SpringMass{.mass = 0.5, .stiffness = 2, .damping = 0.1});
  hub.parent.force = -d.input("U", 6);
  mount(tip, hub.child, Rotation::about({1, 0, 0}, tilt));
  mount(z, hub.child.along({0, 0, 1}));
  d.output("y", 6) = hub.parent.accel;
  return compile(d);
}

const ParameterRanges kRanges = {{"it's m", percent(50)}, {"tilt", between(-1, 2)}};

/// The other program's transfer at 2j with m = 4 and tilt = 1.2, as pairs (re, im).
void check_transfer(const System& system, const std::string& bytes) {
  const MatrixXcd G = system.update({{"it's m", 4}, {"tilt", 1.2}}).transfer({0, 2});
  MatrixXcd theirs(6, 6);
  REQUIRE(bytes.size() == 72 * sizeof(double));
  std::memcpy(static_cast<void*>(theirs.data()), bytes.data(), bytes.size());
  CHECK(matrix_error(theirs, G) <= 1e-11);
}

bool has_numpy(const std::string& name) {
  return std::system((name + " -c 'import numpy' >/dev/null 2>&1").c_str()) == 0;
}

}  // namespace

TEST_CASE("Octave closes the LFT that it reads") {
  if (std::system("command -v octave-cli >/dev/null 2>&1") != 0)
    return skip("Octave is not installed");
  const System system = tilted();
  const Folder folder;
  write_matlab(lft(system, kRanges), folder.path / "some_lft.m");
  folder.write("check.m", R"(
m = some_lft ();
values = [4, 1.2];  deltas = [];
for i = 1:2
  p = m.parameters(i);  d = values(i) - p.nominal;
  if (p.divisor)  d = tan (d / p.divisor);  end
  deltas = [deltas, repmat(d / (p.gain - p.shape * d), 1, p.size)];
end
r = numel (deltas);  Delta = diag (deltas);
M = m.C * ((2i * eye (m.n) - m.A) \ m.B) + m.D;
w = 1:r;  u = r+1:columns (M);  y = r+1:rows (M);
G = M(y, u) + M(y, w) * Delta * ((eye (r) - M(w, w) * Delta) \ M(w, u));
f = fopen ("results", "w");  fwrite (f, [real(G(:)), imag(G(:))].', "double");  fclose (f);
assert (strcmp (m.parameters(1).name, "it's m"));
)");
  const int failed = folder.run("octave-cli --no-init-file check.m");
  INFO(folder.read("log.txt"));
  REQUIRE(failed == 0);
  check_transfer(system, folder.read("results"));
}

TEST_CASE("NumPy closes the LFT that it reads, and JSON has the same numbers") {
  const char* const program = has_numpy("python3") ? "python3" : "/usr/bin/python3";
  if (!has_numpy(program)) return skip("Python with NumPy is not installed");
  const System system = tilted();
  const Lft f = lft(system, kRanges);
  const Folder folder;
  write_numpy(f, folder.path, "some_lft");
  write_json(f, folder.path / "lft.json");
  folder.write("check.py", R"py(
import json
import numpy as np
import some_lft as f
A, B, C, D = f.at(**{"it's m": 4, "tilt": 1.2})
G = C @ np.linalg.solve(2j * np.eye(len(A)) - A, B) + D
G.flatten("F").tofile("results")
whole = json.load(open("lft.json"))
assert all((np.array(whole[k]) == M).all() for k, M in zip("ABCD", (f.A, f.B, f.C, f.D)))
assert [p["size"] for p in whole["parameters"]] == [p["size"] for p in f.parameters]
try:
    f.at(mass=3)
    raise SystemExit(1)
except KeyError:
    pass
)py");
  const int failed = folder.run(std::string(program) + " check.py");
  INFO(folder.read("log.txt"));
  REQUIRE(failed == 0);
  check_transfer(system, folder.read("results"));
  const auto json = nlohmann::json::parse(lft_json(f));
  CHECK(json["format"] == "titop lft 1");
  CHECK(json["not_decided"].is_null());
  CHECK(json["parameters"][1]["at_least"] == 8);
  CHECK_THROWS_AS(write_matlab(f, folder.path / "a b.m"), Error);
  CHECK_THROWS_AS(write_numpy(f, folder.path, "lambda"), Error);
}
