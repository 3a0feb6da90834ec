// OP4 in all its forms: text files of another program, and the real binary file written again in
// every byte order, word size, precision and storage. Expected figures:
// examples/data/.../README.md.
#include <doctest/doctest.h>

#include <cstdint>
#include <cstring>
#include <functional>
#include <titop/blocks/fe/op4.hpp>
#include <titop/blocks/fe/op4_build.hpp>
#include <titop/graph/error.hpp>
#include <tuple>

#include "raw.hpp"
#include "support/folder.hpp"
#include "support/refused.hpp"

using namespace titop;
using titop_test::Folder;
using titop_test::replaced;

namespace {

const std::string kText = TITOP_TEST_DATA "/op4/";
const std::string kReal = TITOP_DATA_DIR "/nastran_op4_superelement/outboard.op4";

/// Format of a binary file.
struct Style {
  bool big_endian = false;
  bool long_words = false;  ///< integers of 8 bytes
  bool single = false;
  enum Storage { dense, sparse, bigmat } storage = dense;
};

/// As the Nastran manual describes OUTPUT4, one record after the other.
class Writer {
 public:
  explicit Writer(Style style) : style_(style) {}
  std::string bytes;

  void add(const std::string& name, const Eigen::MatrixXd& M) {
    std::string head = integer(M.cols()) +
                       integer(style_.storage == Style::bigmat ? -M.rows() : M.rows()) +
                       integer(2) + integer(style_.single ? 1 : 2);
    std::string padded = name;
    padded.resize(style_.long_words ? 16 : 8, ' ');
    record(head + padded);
    for (Eigen::Index j = 0; j < M.cols(); ++j) column(M, j);
    record(integer(M.cols() + 1) + integer(1) + integer(1) + real(1));
  }

 private:
  void column(const Eigen::MatrixXd& M, Eigen::Index j) {
    if ((M.col(j).array() == 0).all()) return;
    std::string data;
    for (Eigen::Index i = 0; i < M.rows();) {
      if (style_.storage == Style::dense) {
        for (; i < M.rows(); ++i) data += real(M(i, j));
      } else if (M(i, j) == 0) {
        ++i;
      } else {
        std::string values;
        const Eigen::Index first = i + 1;
        for (; i < M.rows() && M(i, j) != 0; ++i) values += real(M(i, j));
        const auto length = static_cast<std::int64_t>(values.size() / word()) + 1;
        data += style_.storage == Style::bigmat ? integer(length) + integer(first)
                                                : integer(first + 65536 * length);
        data += values;
      }
    }
    record(integer(j + 1) + integer(style_.storage == Style::dense ? 1 : 0) +
           integer(static_cast<std::int64_t>(data.size() / word())) + data);
  }
  std::size_t word() const { return style_.long_words ? 8 : 4; }
  template <class T>
  std::string raw(T value) const {
    return fe_test::raw(value, style_.big_endian);
  }
  std::string integer(std::int64_t value) const {
    return style_.long_words ? raw(value) : raw(static_cast<std::int32_t>(value));
  }
  std::string real(double value) const {
    return style_.single && !style_.long_words ? raw(static_cast<float>(value)) : raw(value);
  }
  void record(const std::string& data) {
    const std::string length = raw(static_cast<std::int32_t>(data.size()));
    bytes += length + data + length;
  }

  Style style_;
};

std::vector<fe::Op4Matrix> read(const std::string& bytes) {
  const Folder folder;
  folder.write("m.op4", bytes);
  return fe::read_op4(folder.path / "m.op4");
}

Error refusal(const std::string& bytes) {
  return titop_test::error_of([&] { read(bytes); });
}

void says(const Error& error, std::initializer_list<std::string_view> names) {
  INFO(error.what());
  CHECK(titop_test::has_mistake(error, Code::bad_file, names));
}

std::string text_file(const char* name) {
  std::ifstream file(kText + name);
  return {std::istreambuf_iterator<char>(file), {}};
}

const Eigen::MatrixXd kSmall =
    (Eigen::MatrixXd(4, 3) << 1.5, 0, 0, -2.25, 0, 3, 0, 0, 0, 0.1, 0, 1e30).finished();

}  // namespace

TEST_CASE("text OP4, dense, double and single") {
  const auto exact = fe::read_op4(kText + "dense_double.op4");
  REQUIRE(exact.size() == 3);
  const Eigen::MatrixXd& R1 = fe::find_matrix(exact, "r1").value;
  CHECK(R1.rows() == 5);
  CHECK(R1.cols() == 6);
  CHECK(R1(0, 0) == 1.23314083328218890);
  CHECK(R1(4, 0) == 0.660163437000680140);
  CHECK(R1.col(1).isZero(0));
  CHECK(R1(1, 3) == 0);
  CHECK(R1(2, 3) == -0.198510352161182870);
  CHECK(R1(4, 5) == -7.92238234758003420e-02);
  CHECK(exact[1].value.isZero(0));
  CHECK(exact[1].value.rows() == 10);
  CHECK(exact[1].value.cols() == 19);
  CHECK(exact[2].form == 6);
  CHECK(exact[2].value(0, 0) == 3);
  CHECK(exact[0].digits == 15);

  const auto rounded = fe::read_op4(kText + "dense_single.op4");  // no format: 5E16.9
  CHECK(rounded[0].digits == 7);
  CHECK((rounded[0].value - R1).cwiseAbs().maxCoeff() <= 6e-8 * 2);
  CHECK(rounded[0].value(0, 0) == 1.233140833);
}

TEST_CASE("text OP4, sparse, with and without BIGMAT") {
  const auto sparse = fe::read_op4(kText + "sparse_double.op4");
  const Eigen::MatrixXd& S = fe::find_matrix(sparse, "RMAT").value;
  CHECK(S.rows() == 25);
  CHECK(S.cols() == 31);
  CHECK((S.array() != 0).count() == 8);
  CHECK(S(6, 1) == -406.203500751366);
  CHECK(S(22, 1) == 714.929347637789);
  CHECK(S(4, 8) == 335.549465492233);
  CHECK(S(5, 8) == 290.087956257395);
  CHECK(S(24, 29) == -344.472948143492);
  const Eigen::MatrixXd big = fe::read_op4(kText + "bigmat_single.op4")[0].value;
  CHECK((big - S).cwiseAbs().maxCoeff() <= 6e-8 * 2200);
}

TEST_CASE("text OP4 with D exponents, with none, and with line ends of Windows") {
  std::string text = text_file("dense_double.op4");
  const auto plain = read(text);
  std::string d = text, none = text, windows;
  for (char& c : d)
    if (c == 'E') c = 'D';
  for (std::size_t at; (at = none.find("E-0")) != std::string::npos;) none.replace(at, 2, "-0");
  for (const char c : text) windows += c == '\n' ? "\r\n" : std::string(1, c);
  for (const std::string& same : {d, none, windows}) CHECK(read(same)[0].value == plain[0].value);
}

TEST_CASE("the real file, and the same in every other form") {
  const auto real = fe::read_op4(kReal);
  const Eigen::MatrixXd& K = fe::find_matrix(real, "KXX").value;
  const Eigen::MatrixXd& M = fe::find_matrix(real, "MXX").value;
  CHECK(K.rows() == 46);
  CHECK(M.cols() == 46);
  CHECK(fe::find_matrix(real, "KXX").digits == 15);
  CHECK((K - K.transpose()).cwiseAbs().maxCoeff() <= 1e-12 * K.cwiseAbs().maxCoeff());
  // Fixed-interface modes are mass-normalised, and uncoupled in K.
  CHECK((M.bottomRightCorner(22, 22) - Eigen::MatrixXd::Identity(22, 22)).cwiseAbs().maxCoeff() <=
        1e-12);
  const Eigen::MatrixXd modes = K.bottomRightCorner(22, 22);
  CHECK((modes - Eigen::MatrixXd(modes.diagonal().asDiagonal())).cwiseAbs().maxCoeff() <=
        1e-9 * modes.maxCoeff());
  CHECK(K.topRightCorner(24, 22).cwiseAbs().maxCoeff() <= 1e-9 * K.cwiseAbs().maxCoeff());

  for (const bool big_endian : {false, true})
    for (const bool long_words : {false, true})
      for (const bool single : {false, true})
        for (const auto storage : {Style::dense, Style::sparse, Style::bigmat}) {
          INFO(big_endian, long_words, single, storage);
          Writer writer({big_endian, long_words, single, storage});
          writer.add("KXX", K);
          writer.add("ZERO", Eigen::MatrixXd::Zero(2, 3));
          writer.add("SMALL", kSmall);
          const auto again = read(writer.bytes);
          REQUIRE(again.size() == 3);
          const bool rounded = single && !long_words;
          const Eigen::MatrixXd expected =
              rounded ? Eigen::MatrixXd(K.cast<float>().cast<double>()) : K;
          CHECK(again[0].value == expected);
          CHECK(again[0].digits == (rounded ? 7 : 15));
          CHECK(again[1].value == Eigen::MatrixXd::Zero(2, 3));
          CHECK(again[2].name == "SMALL");
          CHECK(again[2].value(1, 2) == 3);
        }
}

TEST_CASE("broken binary files are refused with matrix, record and byte") {
  Writer writer({});
  writer.add("SMALL", kSmall);
  const std::string good = writer.bytes;
  REQUIRE(read(good)[0].value == kSmall);
  // First column: record 2 at byte 32, integers at 36, 40, 44.
  const auto with = [&](std::size_t at, std::int32_t value) {
    std::string bytes = good;
    std::memcpy(&bytes[at], &value, 4);
    return refusal(bytes);
  };
  says(with(0, 25), {"m.op4", "record 0", "byte 0", "25", "24", "48"});
  says(with(16, 5), {"m.op4", "SMALL", "record 1", "byte 0", "type 5"});
  says(with(16, 9), {"SMALL", "type 9"});
  says(with(8, 0), {"SMALL", "0 rows", "3 columns"});
  says(with(4, 90000000), {"SMALL", "1 words"});  // 4 is no longer its last column
  says(with(28, 20), {"m.op4", "record 1", "byte 0"});
  says(with(32, 4000), {"record 2", "byte 32", "4000"});
  says(with(36, -3), {"record 2", "byte 32", "column -3", "1", "3"});
  says(with(40, 3), {"record 2", "4 values", "row 3", "1", "4"});
  says(with(40, -7), {"record 2", "row -7", "1", "4"});
  says(with(44, 3), {"record 2", "3 words", "32 bytes"});
  says(with(52, 0x7ff00000), {"record 2", "inf", "row 1", "column 1"});
  // The second column is 0, and the third one at byte 84; the last record at 136. Of each record
  // that is cut, the bytes behind its length of four and before that behind it.
  for (const auto& [length, record, byte, left] :
       {std::tuple(30u, "record 1", "byte 0", "22"), std::tuple(40u, "record 2", "byte 32", "0"),
        std::tuple(100u, "record 3", "byte 84", "8"),
        std::tuple(150u, "record 4", "byte 136", "6")})
    says(refusal(good.substr(0, length)), {record, byte, left});

  Writer sparse({.storage = Style::sparse});
  sparse.add("S", kSmall);
  std::string bytes = sparse.bytes;
  const std::int32_t string = 1 + 65536 * 100;
  std::memcpy(&bytes[48], &string, 4);
  says(refusal(bytes), {"S", "99 words"});
}

TEST_CASE("columns twice or out of order, half a value: refused; names in small letters: found") {
  Writer writer({});
  writer.add("small", kSmall);
  const std::string good = writer.bytes;
  CHECK(fe::find_matrix(read(good), "Small").value == kSmall);
  CHECK(read(good)[0].name == "SMALL");
  // Columns of 52 bytes and 12 more: the second starts at byte 84, the third at 136.
  const auto with = [&](std::size_t at, std::int32_t value) {
    std::string bytes = good;
    std::memcpy(&bytes[at], &value, 4);
    return refusal(bytes);
  };
  says(with(88, 1), {"SMALL", "record 3", "byte 84", "column 1"});
  says(with(36, 3), {"record 3", "byte 84", "column 3"});

  // One word more than the values need, stated and present: half a double.
  std::string half = good.substr(0, 32);
  const auto put = [&](std::int32_t value) {
    half.append(reinterpret_cast<const char*>(&value), 4);
  };
  for (const std::int32_t value : {24, 1, 1, 3, 0, 0, 0, 24}) put(value);
  says(refusal(half), {"3 words", "type 2"});
  half = good.substr(0, 32);
  for (const std::int32_t value : {22, 1, 1, 2, 0, 0, 0}) put(value);
  half.resize(half.size() - 2);
  put(22);
  says(refusal(half), {"2 words", "10 bytes"});

  const std::string text = text_file("dense_double.op4");
  says(refusal(replaced(text, "       3       1       5", "       1       1       5")),
       {"m.op4:5", "R1", "column 1"});
}

TEST_CASE("a file takes memory for 100 million entries at most, and looks before it takes it") {
  const fe::detail::Refuse refuse = [](const std::string& found, const std::string&) {
    throw Error(Code::bad_file, found, {});
  };
  fe::detail::Op4Taken taken{{"B", "C", "D"}, 99'999'990};
  CHECK(fe::detail::make_matrix({"B", 5, 2, 2, 2, false}, taken, refuse).value.size() == 10);
  const auto unread = [&](const char* name, long long rows) {
    const auto matrix = fe::detail::make_matrix({name, 1, rows, 2, 2, false}, taken, refuse);
    CHECK(matrix.value.size() == 0);
    return matrix.unread;
  };
  CHECK(titop_test::has_name(unread("C", 1), "100"));
  CHECK(titop_test::has_names(unread("D", 25'000'001), {"25000001", "25"}));
  CHECK(!unread("A", 1).empty());
  CHECK(taken.entries == 100'000'000);
}

TEST_CASE("broken text files are refused with matrix and line") {
  const std::string good = text_file("dense_double.op4"), sparse = text_file("sparse_double.op4");
  says(refusal(replaced(good, "-4.16792344640735500E-01", "-4.1679234x640735500E-01")),
       {"m.op4:4", "R1", "'-4.1679234x640735500E-01 6.60163437000680140E-01'", "1", "24"});
  says(refusal(replaced(good, "       3       1       5", "       3       x       5")),
       {"m.op4:5", "R1", "'       3       x       5'", "9", "16"});
  says(refusal(replaced(good, "       3       1       5", "       3       4       5")),
       {"R1", "5 values", "row 4", "1", "5"});
  says(refusal(replaced(good, "       3       1       5", "       3       1       9")),
       {"m.op4:5", "R1", "9 values"});
  says(refusal(replaced(good, "1P,3E24.17", "1P,3G24.17")), {"m.op4:1", "R1", "'1P,3G24.17'"});
  says(refusal(replaced(good, "       2R1 ", "       7R1 ")), {"m.op4:1", "R1", "type 7"});
  says(refusal(replaced(good, "R2 ", "   ")), {"m.op4:17", "33", "40"});
  says(refusal(good.substr(0, 400)), {"m.op4", "R1"});
  says(refusal(good.substr(0, good.find("       7"))), {"m.op4:14", "R1"});
  says(refusal(replaced(sparse, "  196615", "  986615")), {"m.op4:3", "RMAT", "14 words"});
  says(refusal(replaced(sparse, "  196615", "  x")), {"m.op4:3", "RMAT", "'  x'"});
  says(refusal("nonsense\n"), {"m.op4:1", "'nonsense'"});
  // Headers that end before the name; columns 25 to 32 still contain a type.
  const std::string header = "       1       1       2       2";
  for (std::size_t length = 25; length <= 31; ++length)
    says(refusal(header.substr(0, 24) + "2" + std::string(length - 25, ' ') + "\n"),
         {"m.op4:1", "33", "40"});
  says(refusal(header + "\n"), {"m.op4:1", "33", "40"});
  says(refusal(header + "R1      \xff\x80P,3E23.16\n"), {"m.op4:1", "R1", "P,3E23.16"});
  CHECK_THROWS_AS(fe::find_matrix(read(good), "KXX"), Error);
}
