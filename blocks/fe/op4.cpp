#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <titop/blocks/fe/op4.hpp>
#include <titop/blocks/fe/op4_build.hpp>
#include <titop/blocks/fe/text_file.hpp>

namespace titop::fe {

namespace detail {

namespace {

constexpr long long kMostEntries = 100'000'000;  // of a file: 800 MB

}  // namespace

std::string capitals(std::string_view text) {
  std::string result(text);
  for (char& c : result) c = static_cast<char>(std::toupper(static_cast<unsigned char>(c)));
  return result;
}

Op4Matrix make_matrix(const Op4Header& h, Op4Taken& taken, const Refuse& refuse) {
  if (h.columns < 1 || h.rows < 1 || h.columns > 25'000'000 || h.rows > 25'000'000 ||
      h.columns * h.rows > 25'000'000)
    refuse(fmt::format("a matrix of {} rows and {} columns", h.rows, h.columns),
           "1 to 25 million entries: reduce larger models in Nastran (Craig-Bampton)");
  if (h.type == 3 || h.type == 4) refuse("a complex matrix", "a real one, type 1 or 2");
  if (h.type != 1 && h.type != 2)
    refuse(fmt::format("type {}", h.type), "1 (real single) or 2 (real double)");
  if (!taken.names.insert(h.name).second)
    refuse(fmt::format("matrix {} a second time", h.name),
           "each once: write one file per run (ASSIGN OUTPUT4=..., DELETE)");
  taken.entries += h.columns * h.rows;
  if (taken.entries > kMostEntries)
    refuse(fmt::format("{} entries in all matrices together", taken.entries),
           "at most 100 million: write them to several files");
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

void require_ascending(long long column, long long& last, const Refuse& refuse) {
  if (column > 0 && column <= last)
    refuse(fmt::format("column {} behind column {}", column, last), "ascending ones, each once");
  last = column;
}

}  // namespace detail

std::vector<Op4Matrix> read_op4(const std::filesystem::path& path) {
  const TextFile file = read_text(path);
  // A binary file starts with the length of its first record, 24 or 48 bytes, as four bytes.
  const bool binary = file.content.size() >= 4 &&
                      std::count(file.content.begin(), file.content.begin() + 4, '\0') == 3;
  return binary ? detail::read_op4_binary(file.name, file.content) : detail::read_op4_text(path);
}

const Op4Matrix& find_matrix(const std::vector<Op4Matrix>& matrices, const std::string& name) {
  const std::string wanted = detail::capitals(name);
  std::string all;
  for (const Op4Matrix& matrix : matrices) {
    if (matrix.name == wanted) return matrix;
    all += (all.empty() ? "" : ", ") + matrix.name;
  }
  throw Error(Code::unknown_name, fmt::format("the file has no matrix {}", wanted),
              "its matrices are " + all);
}

}  // namespace titop::fe
