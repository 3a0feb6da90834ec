// Octave and Python (NumPy) load a model's files: the same bits, the same poles, the same transfer.
#include <doctest/doctest.h>
#include <fmt/format.h>

#include <cstring>
#include <titop/blocks/fe/inflate.hpp>
#include <titop/blocks/fe/mat.hpp>
#include <titop/titop.hpp>

#include "support/close.hpp"
#include "support/five_masses.hpp"
#include "support/folder.hpp"
#include "support/skip.hpp"

using namespace titop;
using namespace titop_test;
using Eigen::MatrixXcd;
using Eigen::MatrixXd;

namespace {

/// Damped, with direct terms, more outputs than inputs, and names that need care.
System model() {
  Diagram d{"model"};
  auto u = d.input("it's \"u\", 100 %"), w = d.input("W", 2);
  auto a = d.add("a", SpringMass{.mass = 3, .stiffness = 7, .damping = 0.1 / 3});
  auto b = d.add("b", SpringMass{.mass = 2e5, .stiffness = 5e7});
  auto K = d.add("K", Lti{.A = -MatrixXd::Identity(1, 1) / 3,
                          .B = Eigen::RowVector2d(1, 0.1),
                          .C = MatrixXd::Identity(1, 1)});
  ground(a);
  mount(b, a.child);
  K.in = w;
  a.child.force += u + K.out;
  d.output("xdd, b") = b.child.accel;
  d.output("stretch") = a.stretch;
  d.output("both\\x", 1) = 3.0 * a.stretch + K.out;
  return compile(d);
}

bool runs(const std::string& command) {
  return std::system((command + " >/dev/null 2>&1").c_str()) == 0;
}

/// A Python that has NumPy: the one of the path, or the system's.
std::string python() {
  for (const char* name : {"python3", "/usr/bin/python3"})
    if (runs(std::string(name) + " -c 'import numpy'")) return name;
  return {};
}

/// Doubles of a binary file, one matrix after the other by columns.
std::vector<double> doubles(const std::string& bytes) {
  std::vector<double> values(bytes.size() / sizeof(double));
  if (!values.empty()) std::memcpy(values.data(), bytes.data(), values.size() * sizeof(double));
  return values;
}

/// A, B, C, D of the model in that order.
std::vector<double> entries(const StateSpace& m) {
  std::vector<double> all;
  for (const MatrixXd* M : {&m.A, &m.B, &m.C, &m.D})
    all.insert(all.end(), M->data(), M->data() + M->size());
  return all;
}

/// Results of the other program: poles, then the transfer at 2j, as pairs (re, im).
void check_results(const System& system, const std::vector<double>& found) {
  const StateSpace& m = system.state_space();
  const auto n = static_cast<std::size_t>(m.order());
  const MatrixXcd G = system.transfer({0, 2});
  REQUIRE(found.size() == 2 * n + 2 * static_cast<std::size_t>(G.size()));
  const auto value = [&](std::size_t i) {
    return std::complex<double>(found[2 * i], found[2 * i + 1]);
  };
  std::size_t count = 0;
  for (const Pole& p : system.poles()) {
    count += p.pair ? 2 : 1;
    double nearest = HUGE_VAL;
    for (std::size_t i = 0; i < n; ++i) nearest = std::min(nearest, std::abs(value(i) - p.s));
    CHECK(nearest <= 1e-9 * p.omega);
  }
  CHECK(count == n);
  MatrixXcd theirs(G.rows(), G.cols());
  for (std::size_t i = 0; i < static_cast<std::size_t>(G.size()); ++i)
    theirs.data()[i] = value(n + i);
  CHECK(matrix_error(theirs, G) <= 1e-10);
}

}  // namespace

TEST_CASE("Octave reads the model to the last bit and finds its poles and transfer") {
  if (!runs("command -v octave-cli")) return titop_test::skip("Octave is not installed");
  const System system = model();
  const StateSpace& m = system.state_space();
  const Folder folder;
  write_matlab(m, folder.path / "some_model.m");
  folder.write("check.m", R"(
m = some_model ();
f = fopen ("entries", "w");
for M = {m.A, m.B, m.C, m.D}  fwrite (f, M{1}, "double");  end
fclose (f);
G = m.C * ((2i * eye (m.n) - m.A) \ m.B) + m.D;
all = [eig(m.A)(:); G(:)];
f = fopen ("results", "w");  fwrite (f, [real(all), imag(all)].', "double");  fclose (f);
f = fopen ("names", "w");
fprintf (f, "%s\n", m.states{:}, m.inputs{:}, m.outputs{:});  fclose (f);
)");
  REQUIRE(folder.run("octave-cli --no-init-file check.m") == 0);
  CHECK(doubles(folder.read("entries")) == entries(m));
  check_results(system, doubles(folder.read("results")));
  std::string names;
  for (const auto* list : {&m.states, &m.inputs, &m.outputs})
    for (const std::string& name : *list) names += name + "\n";
  CHECK(folder.read("names") == names);
}

TEST_CASE("Octave loads the MAT-file to the last bit, and writes one with the same matrices") {
  if (!runs("command -v octave-cli")) return titop_test::skip("Octave is not installed");
  const StateSpace& m = model().state_space();
  const Folder folder;
  write_mat(model(), folder.path / "m.mat");
  folder.write("check.m", R"(
load ("m.mat");
f = fopen ("entries", "w");
for M = {A, B, C, D}  fwrite (f, M{1}, "double");  end
fclose (f);
f = fopen ("names", "w");
fprintf (f, "%s\n", states{:}, inputs{:}, outputs{:});  fclose (f);
S = sparse (A);
save ("-v7", "octave.mat", "A", "S");
save ("-v6", "octave6.mat", "A", "S");
)");
  REQUIRE(folder.run("octave-cli --no-init-file check.m") == 0);
  CHECK(doubles(folder.read("entries")) == entries(m));
  std::string names;
  for (const auto* list : {&m.states, &m.inputs, &m.outputs})
    for (const std::string& name : *list) names += name + "\n";
  CHECK(folder.read("names") == names);
  for (const char* file : {"octave6.mat", "octave.mat"}) {
    if (file == std::string("octave.mat") && !fe::detail::can_inflate()) break;
    const auto all = fe::read_mat(folder.path / file);
    CHECK(fe::find_matrix(all, "A").value == m.A);
    CHECK(fe::find_matrix(all, "S").value == m.A);
  }
}

TEST_CASE("NumPy reads the model to the last bit and finds its poles and transfer") {
  const std::string program = python();
  if (program.empty()) return titop_test::skip("Python with NumPy is not installed");
  const System system = model();
  const StateSpace& m = system.state_space();
  const Folder folder;
  write_numpy(m, folder.path, "some_model");
  write_json(system, folder.path / "model.json");
  const std::vector<double> omega = {0.1, 1.0 / 3, 20};
  write_csv(system, omega, folder.path / "response.csv");
  folder.write("check.py", R"py(
import csv, json
import numpy as np
import some_model as m
matrices = [m.A, m.B, m.C, m.D]
np.concatenate([M.flatten("F") for M in matrices]).tofile("entries")
np.concatenate([m.poles().astype(complex), m.transfer(2j).flatten("F")]).tofile("results")
open("names", "w").write("".join(n + "\n" for n in m.states + m.inputs + m.outputs))
whole = json.load(open("model.json"))
assert all((np.array(whole[k]) == M).all() for k, M in zip("ABCD", matrices))
assert whole["states"] == m.states and whole["outputs"] == m.outputs
assert 0 <= whole["certificate"]["residual"] < 1e-10
lines = list(csv.reader(open("response.csv")))
assert lines[0][1] == "re(" + m.outputs[0] + "/" + m.inputs[0] + ")"
np.array([[float(x) for x in line] for line in lines[1:]]).tofile("response")
)py");
  const int failed = folder.run(program + " check.py");
  INFO(folder.read("log.txt"));
  REQUIRE(failed == 0);
  CHECK(doubles(folder.read("entries")) == entries(m));
  check_results(system, doubles(folder.read("results")));
  std::string names;
  for (const auto* list : {&m.states, &m.inputs, &m.outputs})
    for (const std::string& name : *list) names += name + "\n";
  CHECK(folder.read("names") == names);

  std::vector<double> response;
  const std::vector<MatrixXcd> G = system.frequency_response(omega);
  for (std::size_t k = 0; k < omega.size(); ++k) {
    response.push_back(omega[k]);
    for (Eigen::Index i = 0; i < G[k].rows(); ++i)
      for (Eigen::Index j = 0; j < G[k].cols(); ++j)
        response.insert(response.end(), {G[k](i, j).real(), G[k](i, j).imag()});
  }
  CHECK(doubles(folder.read("response")) == response);
}

TEST_CASE("names that other programs cannot take are refused") {
  const StateSpace& m = model().state_space();
  const Folder folder;
  for (const char* name : {"a b.m", "1a.m", "model.txt", "while.m", "end.m"})
    CHECK_THROWS_AS(write_matlab(m, folder.path / name), Error);
  for (const char* name : {"a-b", "lambda", "numpy", "pathlib"})
    CHECK_THROWS_AS(write_numpy(m, folder.path, name), Error);
  CHECK_THROWS_AS(write_numpy(m, folder.path / "none", "a"), Error);
}
