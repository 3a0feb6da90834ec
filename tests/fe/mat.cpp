// MAT-files: bytes as MATLAB's description of version 5 has them, in both byte orders, dense and
// sparse; an import of a pair of matrices; refused files.
#include <doctest/doctest.h>

#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <titop/blocks/fe/inflate.hpp>
#include <titop/blocks/fe/mat.hpp>
#include <titop/titop.hpp>

#include "support/folder.hpp"
#include "support/refused.hpp"
#include "support/skip.hpp"

using namespace titop;
using Eigen::MatrixXd;
using titop_test::check_refused;
using titop_test::Folder;
using titop_test::has_line;

namespace {

/// Data elements: type, bytes, data padded to 8 bytes.
class MatWriter {
 public:
  explicit MatWriter(bool big_endian = false) : big_endian_(big_endian) {
    bytes = "MATLAB 5.0 MAT-file";
    bytes.resize(124, ' ');
    bytes += raw(std::uint16_t{0x0100}) + raw(std::uint16_t{('M' << 8) + 'I'});
  }
  std::string bytes;

  enum Class : std::uint32_t { sparse = 5, real = 6, single = 7, int32 = 12 };

  void matrix(const std::string& name, const MatrixXd& M) {
    add(name, real, M, element(9, values<double>(M)));
  }
  void singles(const std::string& name, const MatrixXd& M) {
    add(name, single, M, element(7, values<float>(M)));
  }
  void integers(const std::string& name, const MatrixXd& M) {
    add(name, int32, M, element(5, values<std::int32_t>(M)));
  }
  /// Whole numbers of a matrix of doubles in the least bytes; up to four of them in the tag.
  void whole(const std::string& name, const MatrixXd& M) {
    add(name, real, M, element(2, values<std::uint8_t>(M)));
  }
  /// All so far as one compressed element: a zlib stream of one stored block.
  void compress() {
    const std::string data = bytes.substr(128);
    std::uint32_t a = 1, b = 0;  // Adler's check sum
    for (const char c : data) a = (a + static_cast<unsigned char>(c)) % 65521, b = (b + a) % 65521;
    std::string stream = "\x78\x01\x01";
    for (const std::size_t n : {data.size(), data.size() ^ 0xffffU})
      stream += {static_cast<char>(n & 0xffU), static_cast<char>(n >> 8U & 0xffU)};
    stream += data;
    for (const std::uint32_t sum : {b >> 8U, b, a >> 8U, a})
      stream += static_cast<char>(sum & 0xffU);
    bytes.resize(128);
    bytes += raw(std::uint32_t{15}) + raw(static_cast<std::uint32_t>(stream.size())) + stream;
  }
  void complex(const std::string& name, const MatrixXd& M) {
    const std::string part = element(9, values<double>(M));
    add(name, real, M, part + part, 0x0800);
  }
  /// By columns: rows of the entries, first entry of each column, entries.
  void sparse_matrix(const std::string& name, const MatrixXd& M) {
    std::string rows, columns, entries;
    std::int32_t count = 0;
    for (Eigen::Index j = 0; j < M.cols(); ++j) {
      columns += raw(count);
      for (Eigen::Index i = 0; i < M.rows(); ++i) {
        if (M(i, j) == 0) continue;
        rows += raw(static_cast<std::int32_t>(i));
        entries += raw(M(i, j));
        ++count;
      }
    }
    columns += raw(count);
    add(name, sparse, M, element(5, rows) + element(5, columns) + element(9, entries), 0, count);
  }

 private:
  template <class T>
  std::string raw(T value) const {
    std::string text(sizeof(T), '\0');
    std::memcpy(text.data(), &value, sizeof(T));
    if (big_endian_ != (std::endian::native == std::endian::big))
      text = {text.rbegin(), text.rend()};
    return text;
  }
  template <class T>
  std::string values(const MatrixXd& M) const {
    std::string all;
    for (const double x : M.reshaped()) all += raw(static_cast<T>(x));
    return all;
  }
  std::string element(std::uint32_t type, const std::string& data) const {
    if (!data.empty() && data.size() <= 4) {  // in the place of the length
      std::string all = raw(static_cast<std::uint32_t>(data.size() << 16U | type)) + data;
      all.resize(8, '\0');
      return all;
    }
    std::string all = raw(type) + raw(static_cast<std::uint32_t>(data.size())) + data;
    all.resize((all.size() + 7) / 8 * 8, '\0');
    return all;
  }
  void add(const std::string& name, Class kind, const MatrixXd& M, const std::string& data,
           std::uint32_t flags = 0, int entries = 0) {
    const std::string head = element(6, raw(static_cast<std::uint32_t>(kind | flags)) +
                                            raw(static_cast<std::uint32_t>(entries))) +
                             element(5, raw(static_cast<std::int32_t>(M.rows())) +
                                            raw(static_cast<std::int32_t>(M.cols()))) +
                             element(1, name);
    bytes += element(14, head + data);
  }
  bool big_endian_;
};

const MatrixXd kK = (MatrixXd(2, 3) << 1, 0, -1.0 / 3, 0, 1e-300, 7).finished();

std::vector<fe::Op4Matrix> read(const std::string& bytes) {
  const Folder folder;
  folder.write("m.mat", bytes);
  return fe::read_mat(folder.path / "m.mat");
}

}  // namespace

TEST_CASE("matrices in both byte orders, dense and sparse, double and single") {
  for (const bool big_endian : {false, true}) {
    CAPTURE(big_endian);
    MatWriter w(big_endian);
    const MatrixXd whole = MatrixXd::Identity(2, 2) * 200;
    w.matrix("K", kK), w.singles("m_s", kK), w.sparse_matrix("D", kK), w.whole("few", whole);
    w.whole("many", MatrixXd::Constant(7, 3, 255));
    const auto all = read(w.bytes);
    REQUIRE(all.size() == 5);
    CHECK(fe::find_matrix(all, "few").value == whole);
    CHECK(fe::find_matrix(all, "few").digits == 15);
    CHECK(fe::find_matrix(all, "many").value == MatrixXd::Constant(7, 3, 255));
    CHECK(fe::find_matrix(all, "K").value == kK);
    CHECK(fe::find_matrix(all, "k").digits == 15);
    CHECK(fe::find_matrix(all, "M_S").value == kK.cast<float>().cast<double>());
    CHECK(fe::find_matrix(all, "M_S").digits == 7);
    CHECK(fe::find_matrix(all, "D").value == kK);
  }
}

TEST_CASE("other variables are listed with the reason") {
  MatWriter w;
  w.integers("count", kK), w.complex("K", kK), w.matrix("none", MatrixXd(0, 2)), w.matrix("M", kK);
  const auto all = read(w.bytes);
  REQUIRE(all.size() == 4);
  CHECK(all[0].unread.find("double") != std::string::npos);
  check_refused([&] { fe::find_matrix(all, "K"); }, Code::bad_file, {"K", "complex"});
  CHECK(all[2].unread == "is empty");
  CHECK(fe::find_matrix(all, "M").value == kK);
}

TEST_CASE("other files, and data that end early") {
  check_refused([] { read("MATLAB 7.3 MAT-file, HDF5"); }, Code::bad_file,
                {"m.mat", "version 5", "-v7"});
  MatWriter w;
  w.matrix("K", MatrixXd::Ones(9, 9));
  check_refused([&] { read(w.bytes.substr(0, w.bytes.size() - 200)); }, Code::bad_file,
                {"m.mat", "variable 1", "early"});
  w = MatWriter();
  MatrixXd K = kK;
  K(0) = NAN;
  w.matrix("K", K);
  check_refused([&] { read(w.bytes); }, Code::bad_file, {"K", "finite"});
}

TEST_CASE("compressed variables; damage to them is found by the check sum") {
  if (!fe::detail::can_inflate()) return titop_test::skip("the library was built without zlib");
  for (const bool big_endian : {false, true}) {
    MatWriter w(big_endian);
    w.matrix("K", kK);
    w.compress();
    CHECK(fe::find_matrix(read(w.bytes), "K").value == kK);
    std::string damaged = w.bytes;
    damaged[damaged.size() - 20] = static_cast<char>(damaged[damaged.size() - 20] ^ 1);
    check_refused([&] { read(damaged); }, Code::bad_file, {"m.mat", "variable 1", "compressed"});
  }
  // The variable inside ends early, its stream does not.
  MatWriter w;
  w.matrix("K", MatrixXd::Ones(9, 9));
  w.bytes.resize(w.bytes.size() - 200);
  w.compress();
  check_refused([&] { read(w.bytes); }, Code::bad_file, {"m.mat", "variable 1", "early"});
}

TEST_CASE("sizes of a damaged file take no memory") {
  MatWriter w;
  w.matrix("K", kK);
  // Length of the dimensions, of the name, of the data; dimensions; any byte.
  const auto with = [&](std::size_t at, char value) {
    std::string bytes = w.bytes;
    bytes[at] = value;
    return bytes;
  };
  check_refused([&] { read(with(128 + 31, '\x7a')); }, Code::bad_file, {"variable 1", "early"});
  const auto large = read(with(128 + 35, '\x10'));
  CHECK(large[0].unread.find("25 million") != std::string::npos);
  check_refused([&] { read(with(128 + 35, '\xff')); }, Code::bad_file, {"dimensions"});
  check_refused([&] { read(with(128 + 32, 9)); }, Code::bad_file, {"K", "6 entries", "9 rows"});
  for (std::size_t at = 128; at < w.bytes.size(); ++at)
    for (const char value : {'\0', '\1', '\x7f', '\xff'}) try {
        read(with(at, value));
      } catch (const Error& e) {
        CHECK(e.mistakes().front().code == Code::bad_file);
      }
}

TEST_CASE("sparse matrices with indices that are none") {
  MatWriter w;
  w.sparse_matrix("D", kK);
  // Behind flags, dimensions and name: rows 0 0 1 1 of 4 entries, columns 0 1 2 4.
  const std::size_t rows = 128 + 8 + 16 + 16 + 8 + 8, columns = rows + 16 + 8;
  const std::vector<std::pair<std::size_t, char>> damage = {
      {rows, '\2'},        {rows + 3, '\xff'},   {rows + 8, '\1'},     {columns, '\1'},
      {columns + 4, '\5'}, {columns + 12, '\5'}, {columns + 12, '\0'}, {columns + 15, '\xff'}};
  for (const auto& [at, value] : damage) {
    CAPTURE(at);
    std::string bytes = w.bytes;
    bytes[at] = value;
    check_refused([&] { read(bytes); }, Code::bad_file, {"m.mat", "variable 1, D,", "indices"});
  }
}

TEST_CASE("write_mat and read_mat: the same matrices") {
  const Folder folder;
  StateSpace m;
  m.A = kK.leftCols(2), m.B = kK, m.C = MatrixXd(0, 2), m.D = MatrixXd(0, 3);
  m.states = {"x", "\xc3\xa9t\xc3\xa9"}, m.inputs = {"u", "v", ""};
  write_mat(m, folder.path / "model.mat");
  const auto all = fe::read_mat(folder.path / "model.mat");
  REQUIRE(all.size() == 8);
  CHECK(all[0].value == m.A);
  CHECK(all[1].value == m.B);
  CHECK(all[2].unread == "is empty");
  CHECK(all[4].name == "STATES");
  CHECK(folder.read("model.mat").find(std::string("\xe9\0t\0\xe9\0", 6)) != std::string::npos);
}

TEST_CASE("import of K and M of a rod, its rows by bulk data") {
  // A beam of length 2 along x, EA = 2, GJ = 1, EI = 12, and at each end a unit mass with unit
  // inertia.
  const Folder folder;
  MatrixXd K = MatrixXd::Zero(12, 12);
  const auto spring = [&](int a, double k) {
    K(a, a) += k, K(a + 6, a + 6) += k, K(a, a + 6) -= k, K(a + 6, a) -= k;
  };
  spring(0, 1), spring(3, 0.5);
  // Bending in x-y: v1, rz1, v2, rz2; in x-z the rotations have the other sign.
  const double L = 2, EI = 12;
  Eigen::Matrix4d B;
  B << 12, 6 * L, -12, 6 * L, 6 * L, 4 * L * L, -6 * L, 2 * L * L, -12, -6 * L, 12, -6 * L, 6 * L,
      2 * L * L, -6 * L, 4 * L * L;
  B *= EI / (L * L * L);
  const std::array<int, 4> y = {1, 5, 7, 11}, z = {2, 4, 8, 10};
  for (std::size_t i = 0; i < 4; ++i)
    for (std::size_t j = 0; j < 4; ++j) {
      const auto I = static_cast<Eigen::Index>(i), J = static_cast<Eigen::Index>(j);
      K(y[i], y[j]) += B(I, J);
      K(z[i], z[j]) += B(I, J) * (i % 2 == j % 2 ? 1 : -1);
    }
  MatWriter w;
  w.matrix("K", K), w.matrix("M", MatrixXd::Identity(12, 12)), w.matrix("D", 0.01 * K);
  folder.write("rod.mat", w.bytes);
  check_refused([&] { fe::import_body(folder.path / "rod.mat"); }, Code::bad_file,
                {"rod.mat", "--grids"});
  folder.write("rod.asm", "GRID,1,,0.\nGRID,2,,2.\n");
  const fe::Import found = fe::import_body(folder.path / "rod.mat", {.parent = "1"});
  CHECK(has_line(found.text, {"D: 12 x 12"}));
  CHECK(found.ports == std::vector<std::string>{"1", "2"});
  REQUIRE(found.body);
  CHECK(std::abs(found.body->omega(0) - std::sqrt(0.5)) <= 1e-14);  // torsion
  CHECK(std::abs(found.body->omega(1) - 1) <= 1e-14);               // extension
  CHECK((found.body->D_P - (Matrix6(rigid_mass(1, Matrix3d::Identity(), Vector3d::Zero()) +
                                    rigid_mass(1, Matrix3d::Identity(), Vector3d(-2, 0, 0)))))
            .cwiseAbs()
            .maxCoeff() <= 1e-14);
}
