#include <fmt/format.h>

#include <titop/blocks/fe/fortran_records.hpp>
#include <titop/graph/error.hpp>

namespace titop::fe::detail {

std::vector<double> reals(std::span<const char> bytes, std::size_t size, const WordLayout& layout) {
  std::vector<double> values(bytes.size() / size);
  for (std::size_t i = 0; i < values.size(); ++i)
    values[i] = size == 8 ? layout.value<double>(&bytes[size * i])
                          : static_cast<double>(layout.value<float>(&bytes[size * i]));
  return values;
}

std::string name_in(std::span<const char> bytes) {
  std::string name;
  for (const char c : bytes)
    if (c > ' ' && c < 0x7f) name += c;
  return name;
}

FortranRecords::FortranRecords(std::string name, std::span<const char> bytes, int short_record,
                               const char* kind)
    : name_(std::move(name)), bytes_(bytes) {
  if (bytes.size() < 4) refuse(fmt::format("{} bytes", bytes.size()), kind);
  const auto native = WordLayout{}.value<std::int32_t>(bytes.data());
  layout.swapped = native < 0 || native > 0xffff;
  const auto length = layout.value<std::int32_t>(bytes.data());
  if (length != short_record && length != 2 * short_record)
    refuse(fmt::format("a first record of {} bytes", length),
           fmt::format("{} or {}: is this an {} file?", short_record, 2 * short_record, kind));
  layout.word = length == short_record ? 4 : 8;
}

std::span<const char> FortranRecords::next() {
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

void FortranRecords::refuse(const std::string& found, const std::string& expected) const {
  throw Error(Code::bad_file,
              fmt::format("{}: {}record {} (byte {}): found {}, expected {}", name_,
                          part.empty() ? "" : part + ", ", number_, at_, found, expected),
              {});
}

}  // namespace titop::fe::detail
