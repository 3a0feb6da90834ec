#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <titop/blocks/fe/op4.hpp>
#include <titop/blocks/fe/op4_build.hpp>
#include <titop/blocks/fe/text_file.hpp>

namespace titop::fe {

namespace detail {

Op4Matrix make_matrix(const Op4Header& h, const Refuse& refuse) {
  if (h.columns < 1 || h.rows < 1 || h.columns > 25'000'000 || h.rows > 25'000'000 ||
      h.columns * h.rows > 25'000'000)
    refuse(fmt::format("a matrix of {} rows and {} columns", h.rows, h.columns),
           "1 to 25 million entries: reduce larger models in Nastran (Craig-Bampton)");
  if (h.type == 3 || h.type == 4) refuse("a complex matrix", "a real one, type 1 or 2");
  if (h.type != 1 && h.type != 2)
    refuse(fmt::format("type {}", h.type), "1 (real single) or 2 (real double)");
  return {h.name, static_cast<int>(h.form), Eigen::MatrixXd::Zero(h.rows, h.columns),
          h.type == 1 ? 7.0 : 15.0};
}

void put_values(Op4Matrix& matrix, long long row, long long column, std::span<const double> values,
                const Refuse& refuse) {
  const auto count = static_cast<long long>(values.size());
  if (column < 0 || column >= matrix.value.cols())
    refuse(fmt::format("column {}", column + 1), fmt::format("1 to {}", matrix.value.cols()));
  if (row < 0 || row > matrix.value.rows() || count > matrix.value.rows() - row)
    refuse(fmt::format("{} values from row {} on", count, row + 1),
           fmt::format("rows 1 to {}", matrix.value.rows()));
  for (long long i = 0; i < count; ++i) {
    const double value = values[static_cast<std::size_t>(i)];
    if (!std::isfinite(value))
      refuse(fmt::format("{} in row {}, column {}", value, row + i + 1, column + 1),
             "a finite number");
    matrix.value(row + i, column) = value;
  }
}

namespace {

void require_distinct(const std::string& file, const std::vector<Op4Matrix>& matrices) {
  for (std::size_t i = 0; i < matrices.size(); ++i)
    for (std::size_t j = 0; j < i; ++j)
      if (matrices[i].name == matrices[j].name)
        throw Error(Code::bad_file,
                    fmt::format("{}: matrix {} comes twice", file, matrices[i].name),
                    "write one file per run (ASSIGN OUTPUT4=..., DELETE)");
}

}  // namespace
}  // namespace detail

std::vector<Op4Matrix> read_op4(const std::filesystem::path& path) {
  const TextFile file = read_text(path);
  // A binary file starts with the length of its first record, 24 or 48 bytes, as four bytes.
  const bool binary = file.content.size() >= 4 &&
                      std::count(file.content.begin(), file.content.begin() + 4, '\0') == 3;
  std::vector<Op4Matrix> matrices =
      binary ? detail::read_op4_binary(file.name, file.content) : detail::read_op4_text(path);
  detail::require_distinct(file.name, matrices);
  return matrices;
}

const Op4Matrix& find_matrix(const std::vector<Op4Matrix>& matrices, const std::string& name) {
  std::string capitals = name, all;
  for (char& c : capitals) c = static_cast<char>(std::toupper(static_cast<unsigned char>(c)));
  for (const Op4Matrix& matrix : matrices) {
    if (matrix.name == capitals) return matrix;
    all += (all.empty() ? "" : ", ") + matrix.name;
  }
  throw Error(Code::unknown_name, fmt::format("the file has no matrix {}", capitals),
              "its matrices are " + all);
}

}  // namespace titop::fe
