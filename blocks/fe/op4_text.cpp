#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <titop/blocks/fe/fortran.hpp>
#include <titop/blocks/fe/op4_build.hpp>
#include <titop/blocks/fe/text_file.hpp>

namespace titop::fe::detail {

namespace {

/// "1P,3E23.16": so many values to a line, so wide, so many digits behind the point.
struct Format {
  std::size_t per_line = 5, width = 16;
  int decimals = 9;
};

/// Lines one after the other, with their numbers.
class Lines {
 public:
  explicit Lines(const TextFile& file) : file_(file), lines_(lines_of(file)) {}

  bool at_end() const {
    return std::all_of(lines_.begin() + static_cast<std::ptrdiff_t>(next_), lines_.end(),
                       [](const TextLine& line) { return trim(line.text).empty(); });
  }
  std::string_view next() {
    if (next_ == lines_.size()) refuse("the end of the file", "more lines: it may be truncated");
    return lines_[next_++].text;
  }
  [[noreturn]] void refuse(const std::string& found, const std::string& expected) const {
    const int line = next_ > 0 ? lines_[next_ - 1].number : 0;
    throw Error(
        bad_line(file_, line, (matrix.empty() ? "" : "matrix " + matrix + ": ") + found, expected));
  }

  std::string matrix;  ///< for messages

 private:
  const TextFile& file_;
  std::vector<TextLine> lines_;
  std::size_t next_ = 0;
};

/// Integers in fields of eight columns.
std::vector<long long> integers(const Lines& lines, std::string_view text, std::size_t count) {
  std::vector<long long> result;
  for (std::size_t i = 0; i < count; ++i) {
    int value = 0;
    if (text.size() <= 8 * i || !parse(trim(text.substr(8 * i, 8)), value))
      lines.refuse(fmt::format("'{}'", text),
                   fmt::format("an integer in columns {} to {}", 8 * i + 1, 8 * i + 8));
    result.push_back(value);
  }
  return result;
}

Format format_in(const Lines& lines, std::string_view text) {
  Format f;
  std::string word;
  for (const char c : trim(text))
    word += static_cast<char>(std::toupper(static_cast<unsigned char>(c)));
  if (word.empty()) return f;
  if (word.rfind("1P,", 0) == 0) word.erase(0, 3);
  const auto letter = word.find_first_of("ED"), point = word.find('.');
  int count = 0, width = 0;
  if (letter == std::string::npos || point == std::string::npos || letter > point ||
      !parse(std::string_view(word).substr(0, letter), count) ||
      !parse(std::string_view(word).substr(letter + 1, point - letter - 1), width) ||
      !parse(std::string_view(word).substr(point + 1), f.decimals) || count < 1 || count > 100 ||
      width < 3 || width > 100 || f.decimals < 0 || f.decimals > 100)
    lines.refuse(fmt::format("the format '{}'", trim(text)), "such as 1P,3E23.16");
  f.per_line = static_cast<std::size_t>(count);
  f.width = static_cast<std::size_t>(width);
  return f;
}

std::vector<double> values_in(Lines& lines, long long count, const Format& f) {
  std::vector<double> values;
  while (static_cast<long long>(values.size()) < count) {
    const std::string_view text = lines.next();
    for (std::size_t i = 0; i < f.per_line && static_cast<long long>(values.size()) < count; ++i) {
      double value = 0;
      if (text.size() <= i * f.width || !parse_fortran(text.substr(i * f.width, f.width), value))
        lines.refuse(fmt::format("'{}'", text), fmt::format("a finite number in columns {} to {}",
                                                            i * f.width + 1, (i + 1) * f.width));
      values.push_back(value);
    }
  }
  return values;
}

Op4String string_in(Lines& lines, bool bigmat) {
  const std::string_view text = lines.next();
  if (bigmat) {
    const auto head = integers(lines, text, 2);
    return {head[1] - 1, head[0] - 1};
  }
  int packed = 0;
  if (!parse(trim(text), packed))
    lines.refuse(fmt::format("'{}'", text), "an integer that starts a string of values");
  return unpacked(packed);
}

void read_sparse_column(Lines& lines, const Op4Header& h, long long column, long long words,
                        const Format& f, Op4Matrix& matrix, const Refuse& refuse) {
  const int per_value = words_per_value(h.type);
  while (words > 0) {
    const Op4String s = string_in(lines, h.bigmat);
    words -= s.words + (h.bigmat ? 2 : 1);
    if (s.words < 1 || s.words % per_value != 0 || words < 0)
      refuse(fmt::format("a string of {} words", s.words), "as many as the column has left");
    if (s.words / per_value > h.rows)
      refuse(fmt::format("a string of {} values", s.words / per_value), "at most one per row");
    put_values(matrix, s.row, column, values_in(lines, s.words / words_per_number(h.type), f),
               refuse);
  }
}

Op4Header header_in(Lines& lines, Format& f) {
  const std::string_view text = lines.next();
  const auto head = integers(lines, text, 4);
  const std::string_view name = text.size() > 32 ? trim(text.substr(32, 8)) : std::string_view();
  if (name.empty())
    lines.refuse(fmt::format("'{}'", text), "the matrix's name in columns 33 to 40");
  Op4Header h{capitals(name), head[0], head[1], head[2], head[3], false};
  lines.matrix = h.name;
  h.bigmat = h.rows < 0 || h.rows >= 65536;
  h.rows = std::abs(h.rows);
  f = format_in(lines, text.size() > 40 ? text.substr(40) : std::string_view());
  return h;
}

/// Digits of the format, those of single precision for type 1. Its format is 5E16.9; a wider one
/// holds doubles if any number is none of single precision.
double digits_of(const Op4Matrix& matrix, long long type, const Format& f) {
  const double printed = std::min(15.0, 1.0 + f.decimals);
  const double unit = std::pow(10.0, -f.decimals);
  const auto is_single = [&](double x) {
    return std::abs(x - static_cast<double>(static_cast<float>(x))) <= unit * std::abs(x);
  };
  if (type != 1) return printed;
  if (f.decimals <= 9 || std::ranges::all_of(matrix.value.reshaped(), is_single))
    return std::min(7.0, printed);
  return printed;
}

Op4Matrix read_matrix(Lines& lines, Op4Taken& taken) {
  const Refuse refuse = [&](const std::string& found, const std::string& expected) {
    lines.refuse(found, expected);
  };
  Format f;
  const Op4Header h = header_in(lines, f);
  Op4Matrix matrix = make_matrix(h, taken, refuse);
  for (long long last = 0;;) {
    const auto head = integers(lines, lines.next(), 3);
    if (head[0] > h.columns) {
      values_in(lines, 1, f);  // follows the last column, without meaning
      matrix.digits = digits_of(matrix, h.type, f);
      return matrix;
    }
    require_ascending(head[0], last, refuse);
    if (head[2] < 0) refuse(fmt::format("a column of {} words", head[2]), "0 or more");
    if (head[1] == 0) {
      read_sparse_column(lines, h, head[0] - 1, head[2], f, matrix, refuse);
    } else {
      if (head[2] > h.rows * numbers_per_value(h.type))
        refuse(fmt::format("a column of {} values", head[2]), "one per row");
      put_values(matrix, head[1] - 1, head[0] - 1, values_in(lines, head[2], f), refuse);
    }
  }
}

}  // namespace

std::vector<Op4Matrix> read_op4_text(const TextFile& file, Op4Taken taken) {
  Lines lines(file);
  std::vector<Op4Matrix> matrices;
  while (!lines.at_end()) matrices.push_back(read_matrix(lines, taken));
  return matrices;
}

}  // namespace titop::fe::detail
