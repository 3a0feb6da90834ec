#include <fmt/format.h>

#include <titop/emit/files/files.hpp>
#include <titop/emit/text/identifier.hpp>
#include <titop/emit/text/write_file.hpp>
#include <titop/graph/error.hpp>

namespace titop {

namespace {

/// Control characters are blanks, since a line or the file ends at some of them.
std::string on_one_line(std::string text) {
  for (char& c : text)
    if (const auto byte = static_cast<unsigned char>(c); byte < 0x20 || byte == 0x7f) c = ' ';
  return text;
}

/// Single quotes: no escapes are read in them by either program.
std::string quoted(const std::string& name) {
  std::string text = "'";
  for (const char c : on_one_line(name)) {
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

void write(const StateSpace& model, const std::vector<std::string>& warnings,
           const std::filesystem::path& file) {
  const std::string name = file.stem().string();
  if (!emit::is_identifier(name, emit::Language::matlab) || file.extension() != ".m")
    throw Error(
        Code::bad_value, fmt::format("{} cannot be a MATLAB function", file.string()),
        "give a path whose last part is an identifier, no keyword, and .m, such as satellite.m");
  std::string head = fmt::format(
      "function m = {} ()\n"
      "  % Written by titop: xdot = A x + B u, y = C x + D u, with names.\n",
      name);
  for (const std::string& text : warnings) head += "  % Warning: " + on_one_line(text) + "\n";
  emit::write_file(file, head + fmt::format("  m.n = {};\n", model.order()) +
                             names("states", model.states) + names("inputs", model.inputs) +
                             names("outputs", model.outputs) + matrix("A", model.A) +
                             matrix("B", model.B) + matrix("C", model.C) + matrix("D", model.D) +
                             "end\n");
}

}  // namespace

void write_matlab(const StateSpace& model, const std::filesystem::path& file) {
  write(model, {}, file);
}

void write_matlab(const System& system, const std::filesystem::path& file) {
  write(system.state_space(), dense_warnings(system), file);
}

}  // namespace titop
