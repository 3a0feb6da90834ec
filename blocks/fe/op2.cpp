#include <fmt/format.h>

#include <algorithm>
#include <optional>
#include <titop/blocks/fe/op2.hpp>
#include <titop/blocks/fe/op4_build.hpp>
#include <titop/blocks/fe/text_file.hpp>

namespace titop::fe {

namespace {

using detail::FortranRecords;

/// A file is records of one word, the markers, and records of data. The marker before data is its
/// number of words; -1, -2, ... number the parts of a data block; 0 ends one, and the file.
class Op2Reader {
 public:
  explicit Op2Reader(const TextFile& file)
      : records_(file.name, file.content, 4, "OP2"), result_{file.name, {}, {}, {}} {}

  Op2File read() {
    long long next = marker();
    if (next == 3) next = skip_header();
    while (next > 0) {
      read_block(next);
      if (records_.at_end()) break;
      next = marker();
    }
    result_.layout = records_.layout;
    return std::move(result_);
  }

 private:
  long long marker() {
    const auto record = records_.next();
    if (record.size() != records_.layout.word)
      records_.refuse(fmt::format("{} bytes", record.size()), "a marker of one word");
    return records_.layout.integer(record.data());
  }
  void expect(long long value) {
    if (const long long found = marker(); found != value)
      records_.refuse(fmt::format("marker {}", found), fmt::format("{}", value));
  }
  /// A record of so many words.
  std::span<const char> data(long long words, long long more = 0) {
    const auto record = records_.next();
    const std::size_t word = records_.layout.word;
    if (words < 0 || words > 1'000'000'000 || record.size() % word != 0 ||
        record.size() / word != static_cast<std::size_t>(words + more))
      records_.refuse(fmt::format("{} bytes", record.size()),
                      fmt::format("{} words of {} bytes", words, word));
    return record;
  }

  /// Date, label and version of PARAM,POST,-1.
  long long skip_header() {
    data(3);
    data(marker());
    data(marker());
    expect(-1), expect(0);
    return marker();
  }

  void read_block(long long words) {
    const std::string name = detail::capitals(detail::name_in(data(words)));
    records_.part = "data block " + name;
    expect(-1);
    const long long count = marker();
    const auto trailer = data(count);
    if (count < 7) records_.refuse(fmt::format("a trailer of {} words", count), "7");
    const auto entry = [&](std::size_t i) {
      return records_.layout.integer(&trailer[i * records_.layout.word]);
    };
    const detail::Op4Header header{name, entry(1), entry(2), entry(3), entry(4), false};
    expect(-2), expect(1), expect(0);
    Op2Table table{name, {}};
    const long long next = append(marker(), table);
    read_parts(header, next, std::move(table));
    records_.part.clear();
  }

  /// Data in one or more records becomes one; returns the marker behind it.
  long long append(long long words, Op2Table& table) {
    std::string& all = table.records.emplace_back();
    while (words > 0) {
      const auto bytes = data(words);
      all.append(bytes.begin(), bytes.end());
      words = marker();
    }
    return words;
  }

  /// Parts of a data block behind its header. The third marker of a part is 1 for a column of a
  /// matrix.
  void read_parts(const detail::Op4Header& header, long long next, Op2Table table) {
    const detail::Refuse refuse = [&](const std::string& found, const std::string& expected) {
      records_.refuse(found, expected);
    };
    std::optional<Op4Matrix> matrix;
    long long column = 0;
    for (long long part = -3;; --part) {
      if (next != part) records_.refuse(fmt::format("marker {}", next), fmt::format("{}", part));
      expect(1);
      if (const long long kind = marker(); kind == 1) {
        if (!matrix) matrix = detail::make_matrix(header, taken_, refuse);
        if (records_.layout.word == 8) matrix->digits = 15;
        next = read_column(*matrix, header, column++, refuse);
      } else if (const long long words = marker(); words == 0) {
        break;
      } else {
        next = append(words, table);
      }
    }
    if (matrix)
      result_.matrices.push_back(std::move(*matrix));
    else
      result_.tables.push_back(std::move(table));
  }

  /// Strings of values, each with its first row; returns the marker behind them.
  long long read_column(Op4Matrix& matrix, const detail::Op4Header& header, long long column,
                        const detail::Refuse& refuse) {
    const detail::WordLayout& layout = records_.layout;
    for (;;) {
      const long long words = marker();
      if (words <= 0) return words;
      const auto string = data(words, 1);
      const std::size_t size =
          layout.word == 8 || detail::words_per_number(header.type) == 2 ? 8 : 4;
      const auto values = string.subspan(layout.word);
      if (values.size() % size != 0)
        records_.refuse(fmt::format("{} words", words),
                        fmt::format("whole values of type {}", header.type));
      const long long row = std::max(layout.integer(string.data()), 0LL) - 1;
      detail::put_values(matrix, row, column, detail::reals(values, size, layout), refuse);
    }
  }

  FortranRecords records_;
  detail::Op4Taken taken_;
  Op2File result_;
};

}  // namespace

Op2File read_op2(const std::filesystem::path& path) {
  const TextFile file = read_text(path);
  return Op2Reader(file).read();
}

}  // namespace titop::fe
