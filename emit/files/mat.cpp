#include <fmt/format.h>

#include <cstdint>
#include <cstring>
#include <initializer_list>
#include <span>
#include <titop/compiler/diagram/text.hpp>
#include <titop/emit/files/files.hpp>
#include <titop/emit/text/one_line.hpp>
#include <titop/emit/text/write_file.hpp>
#include <titop/graph/error.hpp>

namespace titop {

namespace {

/// Types of elements, and classes of variables, by their numbers in the file.
enum Type : std::uint32_t {
  kInt8 = 1,
  kInt32 = 5,
  kUint32 = 6,
  kReal = 9,
  kMatrix = 14,
  kUtf16 = 17
};
enum Class : std::uint32_t { kCell = 1, kText = 4, kDouble = 6 };

/// In this machine's byte order, which the head of the file tells.
template <class T>
std::string raw(std::span<const T> values) {
  std::string bytes(values.size_bytes(), '\0');
  if (!bytes.empty()) std::memcpy(bytes.data(), values.data(), bytes.size());
  return bytes;
}
template <class T>
std::string raw(std::initializer_list<T> values) {
  return raw(std::span<const T>(values.begin(), values.size()));
}

/// Type, length, and data padded to 8 bytes.
std::string element(Type type, const std::string& data) {
  std::string all =
      raw({static_cast<std::uint32_t>(type), static_cast<std::uint32_t>(data.size())});
  all += data;
  all.resize((all.size() + 7) / 8 * 8, '\0');
  return all;
}

std::string variable(Class kind, const std::string& name, std::size_t rows, std::size_t cols,
                     const std::string& data) {
  return element(
      kMatrix,
      element(kUint32, raw({static_cast<std::uint32_t>(kind), std::uint32_t{0}})) +
          element(kInt32, raw({static_cast<std::int32_t>(rows), static_cast<std::int32_t>(cols)})) +
          element(kInt8, name) + data);
}

std::string matrix(const std::string& name, const Eigen::MatrixXd& M) {
  // MATLAB's limit of a variable; lengths have 32 bits.
  if (M.size() >= (1 << 28) - 16)
    throw Error(Code::size,
                fmt::format("{} is {} x {}: a MAT-file of version 5 takes 2 GB a matrix", name,
                            M.rows(), M.cols()),
                "write NumPy's files (write_numpy), or reduce the model");
  const std::span<const double> entries(M.data(), static_cast<std::size_t>(M.size()));
  return variable(kDouble, name, static_cast<std::size_t>(M.rows()),
                  static_cast<std::size_t>(M.cols()), element(kReal, raw(entries)));
}

/// Control characters become blanks, as in write_matlab, and bytes that are no UTF-8 U+FFFD. A path
/// converts between texts.
std::u16string utf16(const std::string& text) {
  const std::string clean = diagram::clean(emit::on_one_line(text));
  return std::filesystem::path(std::u8string(clean.begin(), clean.end())).u16string();
}

/// A cell array, a column.
std::string texts(const std::string& name, const std::vector<std::string>& list) {
  std::string cells;
  for (const std::string& text : list) {
    const std::u16string wide = utf16(text);
    cells += variable(kText, "", wide.empty() ? 0 : 1, wide.size(),
                      element(kUtf16, raw(std::span<const char16_t>(wide))));
  }
  return variable(kCell, name, list.size(), 1, cells);
}

void write_mat(const StateSpace& m, const std::vector<std::string>& warnings,
               const std::filesystem::path& file) {
  std::string content = "MATLAB 5.0 MAT-file, written by titop";
  content.resize(124, ' ');
  content += raw({std::uint16_t{0x0100}, std::uint16_t{'M' << 8 | 'I'}});
  content += matrix("A", m.A);
  content += matrix("B", m.B);
  content += matrix("C", m.C);
  content += matrix("D", m.D);
  content += texts("states", m.states);
  content += texts("inputs", m.inputs);
  content += texts("outputs", m.outputs);
  content += texts("warnings", warnings);
  emit::write_file(file, content);
}

}  // namespace

void write_mat(const StateSpace& model, const std::filesystem::path& file) {
  write_mat(model, {}, file);
}

void write_mat(const System& system, const std::filesystem::path& file) {
  write_mat(system.state_space(), dense_warnings(system), file);
}

}  // namespace titop
