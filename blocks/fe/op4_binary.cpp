#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <cstdint>
#include <cstring>
#include <titop/blocks/fe/op4_build.hpp>
#include <titop/blocks/fe/text_file.hpp>

namespace titop::fe::detail {

namespace {

/// Integers and reals of a byte order.
struct Op4Layout {
  bool swapped = false;  ///< against this machine
  std::size_t word = 4;  ///< bytes of an integer

  template <class T>
  T value(const char* at) const {
    char bytes[sizeof(T)];
    std::memcpy(bytes, at, sizeof(T));
    if (swapped) std::reverse(bytes, bytes + sizeof(T));
    T result;
    std::memcpy(&result, bytes, sizeof(T));
    return result;
  }
  long long integer(const char* at) const {
    return word == 4 ? value<std::int32_t>(at) : value<std::int64_t>(at);
  }
};

/// A Fortran record: its length before and behind it, four bytes each.
class Records {
 public:
  Records(std::string name, std::span<const char> bytes) : name_(std::move(name)), bytes_(bytes) {
    const auto native = Op4Layout{}.value<std::int32_t>(bytes.data());
    layout.swapped = native < 0 || native > 0xffff;
    const auto length = layout.value<std::int32_t>(bytes.data());
    if (length != 24 && length != 48)
      refuse(fmt::format("a first record of {} bytes", length), "24 or 48: is this an OP4 file?");
    layout.word = length == 24 ? 4 : 8;
  }

  bool at_end() const { return next_ == bytes_.size(); }

  std::span<const char> next() {
    at_ = next_;
    ++number_;
    const std::size_t left = bytes_.size() - next_;
    if (left < 8) refuse(fmt::format("{} bytes", left), "a record: the file may be truncated");
    const auto length = static_cast<std::size_t>(layout.value<std::uint32_t>(&bytes_[next_]));
    if (length > left - 8)
      refuse(fmt::format("a record of {} bytes where {} are left", length, left - 8),
             "a whole record: the file may be truncated");
    const auto record = bytes_.subspan(next_ + 4, length);
    if (layout.value<std::uint32_t>(&bytes_[next_ + 4 + length]) != length)
      refuse("a record whose lengths before and behind it differ",
             "a Fortran record: was the file copied as text?");
    next_ += length + 8;
    return record;
  }

  [[noreturn]] void refuse(const std::string& found, const std::string& expected) const {
    throw Error(
        Code::bad_file,
        fmt::format("{}: {}record {} (byte {}): found {}, expected {}", name_,
                    matrix.empty() ? "" : "matrix " + matrix + ", ", number_, at_, found, expected),
        {});
  }

  Op4Layout layout;
  std::string matrix;  ///< for messages

 private:
  std::string name_;
  std::span<const char> bytes_;
  std::size_t next_ = 0, at_ = 0;
  int number_ = 0;
};

std::string name_in(std::span<const char> bytes) {
  std::string name;
  for (const char c : bytes)
    if (c > ' ' && c < 0x7f) name += c;
  return name;
}

Op4Header header_in(Records& records) {
  const auto record = records.next();
  const Op4Layout& l = records.layout;
  if (record.size() != 6 * l.word)
    records.refuse(fmt::format("{} bytes", record.size()),
                   fmt::format("the {} bytes that start a matrix", 6 * l.word));
  Op4Header h;
  h.columns = l.integer(&record[0]);
  h.rows = l.integer(&record[l.word]);
  h.form = l.integer(&record[2 * l.word]);
  h.type = l.integer(&record[3 * l.word]);
  h.name = records.matrix = capitals(name_in(record.subspan(4 * l.word)));
  h.bigmat = h.rows < 0 || h.rows >= 65536;
  if (h.rows < 0 && h.rows > -1'000'000'000) h.rows = -h.rows;
  return h;
}

/// The values in so many words: of 4 bytes, single or double; of 8, always double.
std::vector<double> values_in(std::span<const char> bytes, const Op4Header& h, const Op4Layout& l) {
  const std::size_t size = l.word == 8 || h.type == 2 ? 8 : 4;
  std::vector<double> values(bytes.size() / size);
  for (std::size_t i = 0; i < values.size(); ++i)
    values[i] = size == 8 ? l.value<double>(&bytes[size * i])
                          : static_cast<double>(l.value<float>(&bytes[size * i]));
  return values;
}

/// Strings of values, one after the other.
void read_sparse_column(Records& records, const Op4Header& h, long long column,
                        std::span<const char> data, Op4Matrix& matrix, const Refuse& refuse) {
  const Op4Layout& l = records.layout;
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

Op4Matrix read_matrix(Records& records, Op4Taken& taken) {
  const Refuse refuse = [&](const std::string& found, const std::string& expected) {
    records.refuse(found, expected);
  };
  const Op4Header h = header_in(records);
  Op4Matrix matrix = make_matrix(h, taken, refuse);
  if (records.layout.word == 8) matrix.digits = 15;
  for (long long last = 0;;) {
    const auto record = records.next();
    const Op4Layout& l = records.layout;
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
             "as many as it says");
    if (row != 0 && l.word == 4 && words % words_per_value(h.type) != 0)
      refuse(fmt::format("a column of {} words", words), "two for each value of type 2");
    if (row == 0)
      read_sparse_column(records, h, column - 1, data, matrix, refuse);
    else
      put_values(matrix, row - 1, column - 1, values_in(data, h, l), refuse);
  }
}

}  // namespace

std::vector<Op4Matrix> read_op4_binary(const std::string& name, std::span<const char> bytes) {
  Records records(name, bytes);
  std::vector<Op4Matrix> matrices;
  Op4Taken taken;
  while (!records.at_end()) matrices.push_back(read_matrix(records, taken));
  return matrices;
}

}  // namespace titop::fe::detail
