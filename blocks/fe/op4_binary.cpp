#include <fmt/format.h>

#include <titop/blocks/fe/fortran_records.hpp>
#include <titop/blocks/fe/op4_build.hpp>

namespace titop::fe::detail {

namespace {

Op4Header header_in(FortranRecords& records) {
  const auto record = records.next();
  const WordLayout& l = records.layout;
  if (record.size() != 6 * l.word)
    records.refuse(fmt::format("{} bytes", record.size()),
                   fmt::format("the {} bytes that start a matrix", 6 * l.word));
  Op4Header h;
  h.columns = l.integer(&record[0]);
  h.rows = l.integer(&record[l.word]);
  h.form = l.integer(&record[2 * l.word]);
  h.type = l.integer(&record[3 * l.word]);
  h.name = capitals(name_in(record.subspan(4 * l.word)));
  records.part = "matrix " + h.name;
  h.bigmat = h.rows < 0 || h.rows >= 65536;
  if (h.rows < 0 && h.rows > -1'000'000'000) h.rows = -h.rows;
  return h;
}

/// The values in so many words: of 4 bytes, single or double; of 8, always double.
std::vector<double> values_in(std::span<const char> bytes, const Op4Header& h,
                              const WordLayout& l) {
  return reals(bytes, l.word == 8 || words_per_number(h.type) == 2 ? 8 : 4, l);
}

/// Strings of values, one after the other.
void read_sparse_column(FortranRecords& records, const Op4Header& h, long long column,
                        std::span<const char> data, Op4Matrix& matrix, const Refuse& refuse) {
  const WordLayout& l = records.layout;
  const std::size_t head = (h.bigmat ? 2 : 1) * l.word;
  while (!data.empty()) {
    if (data.size() < head) refuse("half a string of values", "a whole one");
    const Op4String s = h.bigmat ? Op4String{l.integer(&data[l.word]) - 1, l.integer(&data[0]) - 1}
                                 : unpacked(l.integer(&data[0]));
    data = data.subspan(head);
    const auto left = static_cast<long long>(data.size() / l.word);
    if (s.words < 1 || s.words > left || (l.word == 4 && s.words % words_per_value(h.type) != 0))
      refuse(fmt::format("a string of {} words", s.words), fmt::format("1 to {}", left));
    const std::size_t bytes = static_cast<std::size_t>(s.words) * l.word;
    put_values(matrix, s.row, column, values_in(data.first(bytes), h, l), refuse);
    data = data.subspan(bytes);
  }
}

Op4Matrix read_matrix(FortranRecords& records, Op4Taken& taken) {
  const Refuse refuse = [&](const std::string& found, const std::string& expected) {
    records.refuse(found, expected);
  };
  const Op4Header h = header_in(records);
  Op4Matrix matrix = make_matrix(h, taken, refuse);
  if (records.layout.word == 8) matrix.digits = 15;
  for (long long last = 0;;) {
    const auto record = records.next();
    const WordLayout& l = records.layout;
    if (record.size() < 3 * l.word)
      refuse(fmt::format("{} bytes", record.size()), "a column: its number, first row and length");
    const long long column = l.integer(&record[0]), row = l.integer(&record[l.word]);
    const long long words = l.integer(&record[2 * l.word]);
    if (column > h.columns) return matrix;
    require_ascending(column, last, refuse);
    const auto data = record.subspan(3 * l.word);
    if (words < 0 || data.size() % l.word != 0 ||
        static_cast<std::size_t>(words) != data.size() / l.word)
      refuse(fmt::format("a column of {} words in {} bytes", words, data.size()),
             "as many bytes as its words take");
    if (row != 0 && l.word == 4 && words % words_per_value(h.type) != 0)
      refuse(fmt::format("a column of {} words", words),
             fmt::format("whole values of type {}", h.type));
    if (row == 0)
      read_sparse_column(records, h, column - 1, data, matrix, refuse);
    else
      put_values(matrix, row - 1, column - 1, values_in(data, h, l), refuse);
  }
}

}  // namespace

std::vector<Op4Matrix> read_op4_binary(const std::string& name, std::span<const char> bytes,
                                       Op4Taken taken) {
  FortranRecords records(name, bytes, 24, "OP4");
  std::vector<Op4Matrix> matrices;
  while (!records.at_end()) matrices.push_back(read_matrix(records, taken));
  return matrices;
}

}  // namespace titop::fe::detail
