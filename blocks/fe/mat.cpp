#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cstdint>
#include <span>
#include <titop/blocks/fe/fortran_records.hpp>
#include <titop/blocks/fe/inflate.hpp>
#include <titop/blocks/fe/mat.hpp>
#include <titop/blocks/fe/op4_build.hpp>
#include <titop/blocks/fe/text_file.hpp>

namespace titop::fe {

namespace {

using detail::WordLayout;
using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

/// Types of elements, and classes of variables, by their numbers in the file.
enum Type : std::uint32_t { kInt8 = 1, kInt32 = 5, kMatrix = 14, kCompressed = 15 };
enum Class : std::uint32_t { kSparse = 5, kDouble = 6, kSingle = 7 };
constexpr std::uint32_t kComplex = 0x0800;

/// Beyond 25 million entries of 16 bytes, as sparse matrices have them, no data are wanted.
constexpr std::size_t kMostBytes = 401'000'000;

struct Element {
  std::uint32_t type = 0;
  std::string_view data = {};
};

/// Elements one behind another: type, length, data.
class Elements {
 public:
  Elements(std::string_view bytes, const WordLayout& layout) : rest_(bytes), layout_(layout) {}

  bool at_end() const { return rest_.empty(); }

  /// False if it ends early.
  bool next(Element& element) {
    if (rest_.size() < 8) return false;
    const auto first = layout_.value<std::uint32_t>(rest_.data());
    std::size_t head = 8, length = first >> 16U;
    element.type = first & 0xffffU;
    if (length > 0)  // up to four bytes in the place of the length
      head = 4;
    else
      length = layout_.value<std::uint32_t>(rest_.data() + 4);
    if (length > (head == 4 ? 4 : rest_.size() - 8)) return false;
    element.data = rest_.substr(head, length);
    const std::size_t padding = head == 4                     ? 4 - length
                                : element.type == kCompressed ? 0
                                                              : (8 - length % 8) % 8;
    rest_.remove_prefix(std::min(head + length + padding, rest_.size()));
    return true;
  }

 private:
  std::string_view rest_;
  WordLayout layout_;
};

/// Elements of a variable before its data.
struct Head {
  std::uint32_t kind = 0;
  bool complex = false;
  std::vector<long long> dims = {};
  std::string name = {};
};

/// Not by libmatio, which allocates by the sizes in a damaged file (bench/programs/mat.cpp).
class MatReader {
 public:
  explicit MatReader(const TextFile& file) : file_(file) {
    const std::string_view head = std::string_view(file.content).substr(0, 128);
    const std::string_view order = head.size() < 128 ? "" : head.substr(126);
    if (!head.starts_with("MATLAB 5.0") || (order != "IM" && order != "MI"))
      refuse_file(file.name, "no MAT-file of version 5",
                  "write it by save -v6 or -v7 (MATLAB: save('FILE.mat', 'K', 'M', '-v7'))");
    layout_.swapped = (order == "IM") != (std::endian::native == std::endian::little);
  }

  std::vector<Op4Matrix> read() {
    std::vector<Op4Matrix> all;
    Elements variables(std::string_view(file_.content).substr(128), layout_);
    for (std::string inflated; !variables.at_end();) {
      ++number_, name_.clear();
      Element element = next(variables);
      if (element.type == kCompressed) element = first_of(inflated = inflate(element.data));
      if (element.type != kMatrix)
        refuse(fmt::format("is an element of type {}", element.type), "write the file again");
      // MATLAB keeps data of its objects in a variable without a name.
      if (Op4Matrix m = variable(element.data); !m.name.empty()) all.push_back(std::move(m));
    }
    return all;
  }

 private:
  [[noreturn]] void refuse(const std::string& found, const char* hint) const {
    const std::string name = name_.empty() ? "" : fmt::format(", {},", name_);
    refuse_file(file_.name, fmt::format("variable {}{} {}", number_, name, found), hint);
  }
  [[noreturn]] void ends_early() const {
    refuse("ends early", "let the program that wrote it run to its end");
  }
  [[noreturn]] void broken(const char* part) const {
    refuse(fmt::format("has broken {}", part), "write the file again");
  }

  Element next(Elements& elements) const {
    Element element;
    if (!elements.next(element)) ends_early();
    return element;
  }

  std::string inflate(std::string_view stream) const {
    std::string bytes;
    if (!detail::can_inflate())
      refuse("is compressed, and this titop was built without zlib",
             "save -v6, or install zlib (Debian package zlib1g-dev) and build titop again");
    if (!detail::inflate_up_to(kMostBytes, stream, bytes)) broken("compressed data");
    return bytes;
  }

  /// Of inflated bytes, which may be the first ones only.
  Element first_of(std::string_view bytes) const {
    if (bytes.size() < 8) ends_early();
    const std::size_t length = layout_.value<std::uint32_t>(bytes.data() + 4);
    if (length > bytes.size() - 8 && bytes.size() < kMostBytes) ends_early();
    return {layout_.value<std::uint32_t>(bytes.data()), bytes.substr(8, length)};
  }

  Head head(Elements& parts) const {
    const Element flags = next(parts);
    if (flags.data.size() != 8) broken("flags");
    const auto bits = layout_.value<std::uint32_t>(flags.data.data());
    Head result{.kind = bits & 0xffU, .complex = (bits & kComplex) != 0};
    Element part = next(parts);
    if (part.type == kInt32) {
      for (std::size_t at = 0; at + 4 <= part.data.size(); at += 4)
        result.dims.push_back(layout_.integer(&part.data[at]));
      part = next(parts);
    }
    if (part.type == kInt8) result.name = part.data;  // objects have no dimensions before it
    return result;
  }

  Op4Matrix variable(std::string_view bytes) {
    if (bytes.empty()) return {};
    Elements parts(bytes, layout_);
    const Head h = head(parts);
    name_ = h.name;
    Op4Matrix result{.name = detail::capitals(h.name),
                     .form = 0,
                     .value = {},
                     .digits = h.kind == kSingle ? 7.0 : 15.0,
                     .unread = unread(h)};
    if (!result.unread.empty()) return result;
    const auto rows = static_cast<Index>(h.dims[0]), cols = static_cast<Index>(h.dims[1]);
    result.value = h.kind == kSparse ? sparse(parts, rows, cols) : dense(parts, rows, cols);
    if (!result.value.allFinite())
      refuse("has an entry that is no finite number", "write finite numbers");
    return result;
  }

  std::string unread(const Head& h) {
    if (h.kind != kSparse && h.kind != kDouble && h.kind != kSingle)
      return "is no matrix of floating-point numbers: write double(...) of it";
    if (h.dims.size() != 2)
      return fmt::format("has {} dimensions, a matrix has two", h.dims.size());
    if (h.complex) return "is complex: write its real part";
    if (h.dims[0] < 0 || h.dims[1] < 0) broken("dimensions");
    if (h.dims[0] == 0 || h.dims[1] == 0) return "is empty";
    return detail::too_large(h.dims[0], h.dims[1], taken_);
  }

  /// Numbers in an element; programs may write whole ones as integers.
  Index count(const Element& e) const {
    static constexpr std::array<Index, 10> bytes = {0, 1, 1, 2, 2, 4, 4, 4, 0, 8};  // by type
    if (e.type >= bytes.size() || bytes.at(e.type) == 0) broken("data: of no type of numbers");
    return std::ssize(e.data) / bytes.at(e.type);
  }

  template <class T>
  VectorXd values(const Element& e, Index n) const {
    VectorXd result(n);
    for (Index i = 0; i < n; ++i)
      result(i) = static_cast<double>(
          layout_.value<T>(e.data.data() + static_cast<std::size_t>(i) * sizeof(T)));
    return result;
  }
  /// The first n, which must be there.
  VectorXd numbers(const Element& e, Index n) const {
    switch (e.type) {
      case 1: return values<std::int8_t>(e, n);
      case 2: return values<std::uint8_t>(e, n);
      case 3: return values<std::int16_t>(e, n);
      case 4: return values<std::uint16_t>(e, n);
      case 5: return values<std::int32_t>(e, n);
      case 6: return values<std::uint32_t>(e, n);
      case 7: return values<float>(e, n);
      default: return values<double>(e, n);
    }
  }

  MatrixXd dense(Elements& parts, Index rows, Index cols) const {
    const Element all = next(parts);
    if (count(all) != rows * cols)
      refuse(fmt::format("has {} entries for {} rows and {} columns", count(all), rows, cols),
             "write the file again");
    return numbers(all, rows * cols).reshaped(rows, cols);
  }

  /// By columns: rows of the entries, ascending; the first entry of each column; the entries.
  MatrixXd sparse(Elements& parts, Index rows, Index cols) const {
    const Element row_part = next(parts), first_part = next(parts), entry_part = next(parts);
    if (count(first_part) != cols + 1) broken("indices");
    const VectorXd first = numbers(first_part, cols + 1);
    const Index there = std::min({count(row_part), count(entry_part), rows * cols});
    if (first(0) != 0 || !(first(cols) >= 0 && first(cols) <= static_cast<double>(there)))
      broken("indices");
    const auto n = static_cast<Index>(first(cols));
    const VectorXd row = numbers(row_part, n), entry = numbers(entry_part, n);
    MatrixXd result = MatrixXd::Zero(rows, cols);
    for (Index j = 0; j < cols; ++j) {
      if (!(first(j) <= first(j + 1)) || !(first(j + 1) <= first(cols))) broken("indices");
      const auto begin = static_cast<Index>(first(j)), end = static_cast<Index>(first(j + 1));
      for (Index k = begin; k < end; ++k) {
        if (!(row(k) >= 0 && row(k) < static_cast<double>(rows)) ||
            (k > begin && row(k) <= row(k - 1)))
          broken("indices");
        result(static_cast<Index>(row(k)), j) = entry(k);
      }
    }
    return result;
  }

  const TextFile& file_;
  WordLayout layout_;
  detail::Op4Taken taken_;
  int number_ = 0;
  std::string name_;
};

}  // namespace

std::vector<Op4Matrix> read_mat(const std::filesystem::path& path) {
  const TextFile file = read_text(path);
  return MatReader(file).read();
}

}  // namespace titop::fe
