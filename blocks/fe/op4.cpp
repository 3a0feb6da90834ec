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
constexpr long long kMostOfMatrix = 25'000'000;

}  // namespace

std::string capitals(std::string_view text) {
  std::string result(text);
  for (char& c : result) c = static_cast<char>(std::toupper(static_cast<unsigned char>(c)));
  return result;
}

std::string too_large(long long rows, long long columns, Op4Taken& taken) {
  if (columns > kMostOfMatrix / rows)
    return fmt::format(
        "has {} rows and {} columns, more than 25 million entries: reduce the model "
        "(Craig-Bampton)",
        rows, columns);
  if (taken.entries + columns * rows > kMostEntries)
    return "comes after 100 million entries of the file: ask for it alone, by its name";
  taken.entries += columns * rows;
  return {};
}

namespace {

/// Why a matrix of this header is not read; empty if it is.
std::string unread(const Op4Header& h, Op4Taken& taken) {
  if (!taken.only.empty() && !taken.only.contains(h.name)) return "was not asked for";
  if (h.type == 3 || h.type == 4)
    return "is complex: write the real stiffness and mass, without structural damping (PARAM,G)";
  return too_large(h.rows, h.columns, taken);
}

}  // namespace

Op4Matrix make_matrix(const Op4Header& h, Op4Taken& taken, const Refuse& refuse) {
  if (h.columns < 1 || h.rows < 1)
    refuse(fmt::format("a matrix of {} rows and {} columns", h.rows, h.columns), "1 or more");
  if (h.type < 1 || h.type > 4)
    refuse(fmt::format("type {}", h.type), "1 (real single), 2 (real double), 3 or 4 (complex)");
  Op4Matrix matrix{
      h.name, static_cast<int>(h.form), {}, h.type == 1 ? 7.0 : 15.0, unread(h, taken)};
  if (!matrix.unread.empty()) return matrix;
  matrix.value.setZero(h.rows, h.columns);
  return matrix;
}

void put_values(Op4Matrix& matrix, long long row, long long column, std::span<const double> values,
                const Refuse& refuse) {
  if (!matrix.unread.empty()) return;
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

std::vector<Op4Matrix> read_op4(const std::filesystem::path& path,
                                const std::vector<std::string>& only) {
  const TextFile file = read_text(path);
  detail::Op4Taken taken;
  for (const std::string& name : only) taken.only.insert(detail::capitals(name));
  // A binary file starts with the length of its first record, 24 or 48 bytes, as four bytes.
  const bool binary = file.content.size() >= 4 &&
                      std::count(file.content.begin(), file.content.begin() + 4, '\0') == 3;
  return binary ? detail::read_op4_binary(file.name, file.content, std::move(taken))
                : detail::read_op4_text(file, std::move(taken));
}

const Op4Matrix& find_matrix(const std::vector<Op4Matrix>& matrices, const std::string& name) {
  const std::string wanted = detail::capitals(name);
  const Op4Matrix* found = nullptr;
  std::string all;
  for (const Op4Matrix& matrix : matrices) {
    all += (all.empty() ? "" : ", ") + matrix.name;
    if (matrix.name != wanted) continue;
    if (!matrix.unread.empty())
      throw Error(Code::bad_file, fmt::format("matrix {} was not read", wanted),
                  "it " + matrix.unread);
    if (found && (found->value.rows() != matrix.value.rows() ||
                  found->value.cols() != matrix.value.cols() || found->value != matrix.value))
      throw Error(Code::bad_file,
                  fmt::format("the file has several matrices {} with different values", wanted),
                  "write one file per run (ASSIGN OUTPUT4=..., DELETE) and loop, or take one of "
                  "the list that read_op4 returns by its place");
    if (!found) found = &matrix;
  }
  if (found) return *found;
  throw Error(Code::unknown_name, fmt::format("the file has no matrix {}", wanted),
              "its matrices are " + all);
}

}  // namespace titop::fe
