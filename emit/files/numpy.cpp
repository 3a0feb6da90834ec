#include <fmt/format.h>

#include <bit>
#include <cstring>
#include <titop/compiler/diagram/text.hpp>
#include <titop/emit/files/files.hpp>
#include <titop/emit/files/lft_files.hpp>
#include <titop/emit/text/identifier.hpp>
#include <titop/emit/text/literals.hpp>
#include <titop/emit/text/write_file.hpp>
#include <titop/graph/error.hpp>

namespace titop {

namespace {

/// NumPy's format 1.0: magic, a Python dictionary padded to 64 bytes, the entries by columns.
std::string npy(const Eigen::MatrixXd& M) {
  std::string header =
      fmt::format("{{'descr': '{}f8', 'fortran_order': True, 'shape': ({}, {}), }}",
                  std::endian::native == std::endian::little ? '<' : '>', M.rows(), M.cols());
  constexpr std::size_t before = 10;  // magic, version, length of the header
  header += std::string(63 - (before + header.size()) % 64, ' ') + "\n";
  std::string text("\x93NUMPY\x01\x00", 8);
  text += static_cast<char>(header.size() & 0xff);
  text += static_cast<char>(header.size() >> 8);
  text += header;
  const std::size_t at = text.size(), bytes = sizeof(double) * static_cast<std::size_t>(M.size());
  text.resize(at + bytes);
  if (bytes > 0) std::memcpy(text.data() + at, M.data(), bytes);
  return text;
}

/// Python refuses files that are not valid UTF-8: invalid bytes are escaped, as control characters
/// are.
std::string escaped(const std::string& name) {
  std::string text;
  for (std::string_view rest = name; !rest.empty();) {
    const std::size_t n = diagram::utf8_length(rest);
    const char c = rest.front();
    if (c == '"' || c == '\\') text += '\\';
    if (n == 0 || (n == 1 && static_cast<unsigned char>(c) < 0x20))
      text += fmt::format("\\x{:02x}", static_cast<unsigned char>(c));
    else
      text += rest.substr(0, n);
    rest.remove_prefix(n == 0 ? 1 : n);
  }
  return text;
}

std::string list_of_names(const char* variable, const std::vector<std::string>& list) {
  std::string text = fmt::format("{} = [\n", variable);
  for (const std::string& name : list) text += "    \"" + escaped(name) + "\",\n";
  return text + "]\n";
}

const char* const kModule = R"("""Written by titop: xdot = A x + B u, y = C x + D u, with names."""
@WARNINGS@
import pathlib

import numpy as np

_folder = pathlib.Path(__file__).resolve().parent
A, B, C, D = (np.load(_folder / f"@NAME@_{_matrix}.npy") for _matrix in "ABCD")
@NAMES@

def transfer(s):
    """C (s - A)^-1 B + D, outputs x inputs."""
    return C.dot(np.linalg.solve(s * np.eye(len(A)) - A, B)) + D


def poles():
    """Eigenvalues of A [rad/s]."""
    return np.linalg.eigvals(A)
@MORE@)";

const char* const kClose = R"(

# delta = d / (gain - shape d), d = value - nominal, or tan((value - nominal) / divisor)
parameters = [
@PARAMETERS@]


def at(**values):
    """A, B, C, D with w = Delta z closed at these values, the other parameters at nominal ones."""
    deltas = []
    for p in parameters:
        d = values.pop(p["name"], p["nominal"]) - p["nominal"]
        d = np.tan(d / p["divisor"]) if p["divisor"] else d
        deltas += [d / (p["gain"] - p["shape"] * d)] * p["size"]
    if values:
        raise KeyError(f"no such parameter: {', '.join(values)}")
    r = len(deltas)
    Delta = np.diag(deltas) if r else np.zeros((0, 0))
    K = Delta.dot(np.linalg.inv(np.eye(r) - D[:r, :r].dot(Delta)))
    return (A + B[:, :r].dot(K).dot(C[:r]), B[:, r:] + B[:, :r].dot(K).dot(D[:r, r:]),
            C[r:] + D[r:, :r].dot(K).dot(C[:r]), D[r:, r:] + D[r:, :r].dot(K).dot(D[:r, r:]))
)";

std::string parameter_line(const Delta& d) {
  return fmt::format(
      "    {{\"name\": \"{}\", \"size\": {}, \"at_least\": {}, \"minimal\": {}, \"nominal\": {}, "
      "\"from\": {},\n     \"to\": {}, \"gain\": {}, \"shape\": {}, \"divisor\": {}}},\n",
      escaped(d.parameter), d.size, d.at_least, d.minimal() ? "True" : "False", d.map.nominal,
      d.map.from, d.map.to, d.map.gain, d.map.shape, d.map.divisor());
}

/// `more`: at the end of the module.
void write(const StateSpace& model, const std::vector<std::string>& warnings,
           const std::filesystem::path& folder, const std::string& name,
           const std::string& more = {}) {
  if (!emit::is_identifier(name, emit::Language::python))
    throw Error(Code::bad_value, fmt::format("\"{}\" cannot be the name of a Python module", name),
                "give an identifier that is no keyword and no module that numpy imports, such as "
                "satellite_2");
  const std::pair<char, const Eigen::MatrixXd*> matrices[] = {
      {'A', &model.A}, {'B', &model.B}, {'C', &model.C}, {'D', &model.D}};
  for (const auto& [letter, matrix] : matrices)
    emit::write_file(folder / fmt::format("{}_{}.npy", name, letter), npy(*matrix));
  std::string comments;
  for (const std::string& text : warnings) comments += "# Warning: " + escaped(text) + "\n";
  emit::write_file(folder / (name + ".py"),
                   emit::filled(kModule, {{"NAME", name},
                                          {"WARNINGS", comments},
                                          {"MORE", more},
                                          {"NAMES", list_of_names("states", model.states) +
                                                        list_of_names("inputs", model.inputs) +
                                                        list_of_names("outputs", model.outputs)}}));
}

}  // namespace

void write_numpy(const StateSpace& model, const std::filesystem::path& folder,
                 const std::string& name) {
  write(model, {}, folder, name);
}

void write_numpy(const System& system, const std::filesystem::path& folder,
                 const std::string& name) {
  write(system.state_space(), dense_warnings(system), folder, name);
}

void write_numpy(const Lft& f, const std::filesystem::path& folder, const std::string& name) {
  std::string lines;
  for (const Delta& d : f.deltas()) lines += parameter_line(d);
  write(f.m(), {}, folder, name, emit::filled(kClose, {{"PARAMETERS", lines}}));
}

}  // namespace titop
