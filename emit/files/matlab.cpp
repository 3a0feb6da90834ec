#include <fmt/format.h>

#include <titop/emit/files/files.hpp>
#include <titop/emit/files/lft_files.hpp>
#include <titop/emit/text/identifier.hpp>
#include <titop/emit/text/one_line.hpp>
#include <titop/emit/text/write_file.hpp>
#include <titop/graph/error.hpp>

namespace titop {

namespace {

/// Single quotes: no escapes are read in them by either program.
std::string quoted(const std::string& name) {
  std::string text = "'";
  for (const char c : emit::on_one_line(name)) {
    if (c == '\'') text += '\'';
    text += c;
  }
  return text + "'";
}

std::string names(const char* field, const std::vector<std::string>& list) {
  std::string text = fmt::format("  m.{} = {{\n", field);
  for (const std::string& name : list) text += "    " + quoted(name) + "\n";
  return text + "  };\n";
}

std::string matrix(const char* field, const Eigen::MatrixXd& M) {
  if (M.size() == 0) return fmt::format("  m.{} = zeros ({}, {});\n", field, M.rows(), M.cols());
  std::string text = fmt::format("  m.{} = [\n", field);
  for (Eigen::Index i = 0; i < M.rows(); ++i) {
    for (Eigen::Index j = 0; j < M.cols(); ++j)
      text += fmt::format("{}{}", j > 0 ? ", " : "    ", M(i, j));
    text += "\n";
  }
  return text + "  ];\n";
}

/// The name of the function. Throws bad_value.
std::string function_of(const std::filesystem::path& file) {
  const std::string name = file.stem().string();
  if (!emit::is_identifier(name, emit::Language::matlab) || file.extension() != ".m")
    throw Error(
        Code::bad_value, fmt::format("{} cannot be a MATLAB function", file.string()),
        "give a path whose last part is an identifier, no keyword, and .m, such as satellite.m");
  return name;
}

std::string fields(const StateSpace& model) {
  return fmt::format("  m.n = {};\n", model.order()) + names("states", model.states) +
         names("inputs", model.inputs) + names("outputs", model.outputs) + matrix("A", model.A) +
         matrix("B", model.B) + matrix("C", model.C) + matrix("D", model.D);
}

void write(const StateSpace& model, const std::vector<std::string>& warnings,
           const std::filesystem::path& file) {
  std::string head = fmt::format(
      "function m = {} ()\n"
      "  % Written by titop: xdot = A x + B u, y = C x + D u, with names.\n",
      function_of(file));
  for (const std::string& text : warnings) head += "  % Warning: " + emit::on_one_line(text) + "\n";
  emit::write_file(file, head + fields(model) + "end\n");
}

std::string parameter(const Delta& d) {
  return fmt::format(
      "  m.parameters(end + 1) = struct ('name', {}, 'size', {}, 'at_least', {}, 'minimal', {}, "
      "...\n"
      "    'nominal', {}, 'from', {}, 'to', {}, 'gain', {}, 'shape', {}, 'divisor', {});\n",
      quoted(d.parameter), d.size, d.at_least, d.minimal() ? "true" : "false", d.map.nominal,
      d.map.from, d.map.to, d.map.gain, d.map.shape, d.map.divisor());
}

/// Every delta is one ureal, as often as it occurs.
const char* const kUncertain = R"(  if (nargout > 1)
    blocks = {};
    names = matlab.lang.makeUniqueStrings (matlab.lang.makeValidName ({m.parameters.name}));
    for i = 1:numel (names)
      delta = ureal (names{i}, 0, 'Range', [-1, 1]);
      blocks{end + 1} = delta * eye (m.parameters(i).size);
    end
    M = ss (m.A, m.B, m.C, m.D);
    sys = lft (blkdiag (blocks{:}), M);
  end
end
)";

}  // namespace

void write_matlab(const StateSpace& model, const std::filesystem::path& file) {
  write(model, {}, file);
}

void write_matlab(const System& system, const std::filesystem::path& file) {
  write(system.state_space(), dense_warnings(system), file);
}

void write_matlab(const Lft& f, const std::filesystem::path& file) {
  std::string text = fmt::format(
      "function [m, sys] = {} ()\n"
      "  % Written by titop: xdot = A x + B [w; u], [z; y] = C x + D [w; u], w = Delta z.\n"
      "  % delta = d / (gain - shape d), d = value - nominal, or tan ((value - nominal) / "
      "divisor).\n",
      function_of(file));
  text += fields(f.m()) +
          "  m.parameters = struct ('name', {}, 'size', {}, 'at_least', {}, 'minimal', {}, ...\n"
          "    'nominal', {}, 'from', {}, 'to', {}, 'gain', {}, 'shape', {}, 'divisor', {});\n";
  for (const Delta& d : f.deltas()) text += parameter(d);
  emit::write_file(file, text + kUncertain);
}

}  // namespace titop
