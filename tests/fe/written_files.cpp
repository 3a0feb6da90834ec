// Matrices as programs write them: asymmetric in their last digits, among complex and repeated
// ones, single in name only. Small files of a beam, whose
// matrices are known without the file.
#include <doctest/doctest.h>
#include <fmt/format.h>

#include <titop/blocks/fe/beam.hpp>
#include <titop/blocks/fe/grids.hpp>
#include <titop/blocks/fe/mesh_checks.hpp>
#include <titop/blocks/fe/op4.hpp>
#include <titop/graph/error.hpp>

#include "boom.hpp"
#include "dynamics.hpp"
#include "support/folder.hpp"
#include "support/names.hpp"
#include "support/refused.hpp"

using namespace titop;
using Eigen::Index;
using Eigen::MatrixXd;
using fe_test::boom;
using fe_test::relative;
using titop_test::check_refused;
using titop_test::Folder;

namespace {

/// One matrix of a text OP4, dense, in the format 1P,3E22.15.
std::string op4(const std::string& name, const MatrixXd& S, int type = 2) {
  std::string text =
      fmt::format("{:8}{:8}{:8}{:8}{:8}1P,3E22.15\n", S.cols(), S.rows(), 6, type, name);
  for (Index j = 0; j < S.cols(); ++j) {
    text += fmt::format("{:8}{:8}{:8}\n", j + 1, 1, S.rows());
    for (Index i = 0; i < S.rows(); ++i)
      text += fmt::format("{:22.15E}{}", S(i, j), i % 3 == 2 || i + 1 == S.rows() ? "\n" : "");
  }
  return text + fmt::format("{:8}{:8}{:8}\n{:22.15E}\n", S.cols() + 1, 1, 1, 1.0);
}

fe::GridMatrices read(const std::string& text) {
  const Folder folder;
  folder.write("beam.op4", text);
  const auto all = fe::read_op4(folder.path / "beam.op4");
  const fe::Op4Matrix& K = fe::find_matrix(all, "KAA");
  return fe::grid_matrices("beam", K.value, fe::find_matrix(all, "MAA").value, {1, 2, 3}, K.digits);
}

const std::vector<fe::Grid> kGrids = {
    {1, {0, 0, 0}, {}, "P"}, {2, {1, 0, 0}, {}, ""}, {3, {2, 0, 0}, {}, "C"}};

}  // namespace

TEST_CASE("matrices asymmetric by a reduction's rounding are symmetrised, with fewer digits") {
  const fe::Mesh exact = boom(2);
  MatrixXd K = exact.K;
  const double off = 1e-12 * std::sqrt(K(1, 1) * K(11, 11));
  K(1, 11) += off;
  const fe::Mesh mesh = fe::to_mesh(read(op4("KAA", K) + op4("MAA", exact.M)), kGrids);
  CHECK(mesh.K == mesh.K.transpose());
  CHECK(std::abs(mesh.K(1, 11) - exact.K(1, 11) - off / 2) <= 1e-3 * off);
  CHECK(mesh.digits <= 13.001);
  CHECK(mesh.digits >= 12.9);
  const ModalData data = fe::modal_data(mesh, "P", {"C"}),
                  right = fe::modal_data(exact, "P", {"C"});
  CHECK(data.digits == mesh.digits);
  for (Index k = 0; k < 12; ++k) CHECK(relative(data.omega(k), right.omega(k)) <= 1e-9);

  // A mesh made by hand: the same, and its report has the asymmetry.
  fe::Mesh skew = exact;
  skew.K = K;
  CHECK(relative(fe::asymmetry(skew), 1e-12) <= 1e-2);
  CHECK(titop_test::has_name(to_string(fe::mesh_report(skew)), "1.0e-12"));
  CHECK(fe::modal_data(skew, "P", {"C"}).omega ==
        fe::modal_data(fe::symmetrised(skew), "P", {"C"}).omega);
  CHECK(fe::asymmetry(exact) == 0);
}

TEST_CASE("one triangle, or half the digits, is no rounding of a reduction") {
  const fe::Mesh exact = boom(2);
  MatrixXd K = exact.K;
  K(1, 11) += 1e-6 * std::sqrt(K(1, 1) * K(11, 11));
  check_refused([&] { fe::to_mesh(read(op4("KAA", K) + op4("MAA", exact.M)), kGrids); },
                Code::bad_value, {"K", "beam", "P.y", "2.rz", "1e-06", "1.5e-08"});
  K = exact.K.triangularView<Eigen::Lower>();
  check_refused([&] { fe::to_mesh(read(op4("KAA", K) + op4("MAA", exact.M)), kGrids); },
                Code::bad_value, {"K", "beam"});
}

TEST_CASE("complex and repeated matrices are listed, and the others read") {
  const MatrixXd I = MatrixXd::Identity(2, 2);
  const std::string complex =
      "       1       2       2       4BAA     1P,3E22.15\n       1       1       4\n" +
      fmt::format("{:22.15E}{:22.15E}{:22.15E}\n{:22.15E}\n", 1.0, 2.0, 3.0, 4.0) +
      "       2       1       1\n" + fmt::format("{:22.15E}\n", 1.0);
  const std::string sparse =  // one value in row 1: four words and the head of its string
      "       1       2       2       4BSP     1P,3E22.15\n       1       0       5\n  327681\n" +
      fmt::format("{:22.15E}{:22.15E}\n", 1.0, 2.0) + "       2       1       1\n" +
      fmt::format("{:22.15E}\n", 1.0);
  const Folder folder;
  folder.write("loop.op4", op4("START", I) + op4("START", 2 * I) + op4("SAME", I) + complex +
                               sparse + op4("SAME", I) + op4("KAA", 3 * I));
  const auto all = fe::read_op4(folder.path / "loop.op4");
  REQUIRE(all.size() == 7);
  CHECK(fe::find_matrix(all, "kaa").value == 3 * I);
  CHECK(fe::find_matrix(all, "SAME").value == I);
  CHECK(all[1].value == 2 * I);
  check_refused([&] { fe::find_matrix(all, "START"); }, Code::bad_file, {"START", "OUTPUT4"});
  for (const char* name : {"BAA", "BSP"})
    check_refused([&] { fe::find_matrix(all, name); }, Code::bad_file, {name, "PARAM,G"});
  check_refused([&] { fe::find_matrix(all, "MAA"); }, Code::unknown_name,
                {"MAA", "START", "SAME", "BAA", "KAA"});

  const auto one = fe::read_op4(folder.path / "loop.op4", {"kaa"});
  CHECK(fe::find_matrix(one, "KAA").value == 3 * I);
  CHECK(one[0].value.size() == 0);
  check_refused([&] { fe::find_matrix(one, "SAME"); }, Code::bad_file, {"SAME"});
}

TEST_CASE("binary: a complex matrix of each storage is passed over") {
  const auto integers = [](std::initializer_list<std::int32_t> values) {
    return std::string(reinterpret_cast<const char*>(values.begin()), 4 * values.size());
  };
  const auto record = [&](const std::string& data) {
    const std::string length = integers({static_cast<std::int32_t>(data.size())});
    return length + data + length;
  };
  const std::string value(16, '\0');  // complex double
  const auto last = [&] { return record(integers({2, 1, 2}) + std::string(8, '\0')); };
  const double three = 3;
  const std::string real(reinterpret_cast<const char*>(&three), 8);
  const Folder folder;
  folder.write("m.op4", record(integers({1, 2, 2, 4}) + "DENSE   ") +
                            record(integers({1, 1, 4}) + value) + last() +
                            record(integers({1, 2, 2, 4}) + "SPARSE  ") +
                            record(integers({1, 0, 5, 1 + 65536 * 5}) + value) + last() +
                            record(integers({1, 1, 1, 2}) + "REAL    ") +
                            record(integers({1, 1, 2}) + real) + last());
  const auto all = fe::read_op4(folder.path / "m.op4");
  REQUIRE(all.size() == 3);
  CHECK(!all[0].unread.empty());
  CHECK(!all[1].unread.empty());
  CHECK(all[2].value(0, 0) == 3);
}

TEST_CASE("text of type 1 in a wide format has the digits of its numbers") {
  const MatrixXd fraction = MatrixXd::Constant(2, 2, 1.0 / 3),
                 single = MatrixXd::Constant(2, 2, static_cast<double>(1.0f / 3.0f));
  const Folder folder;
  folder.write("m.op4", op4("DOUBLE", fraction, 1) + op4("SINGLE", single, 1));
  const auto all = fe::read_op4(folder.path / "m.op4");
  CHECK(all[0].digits == 15);
  CHECK(all[1].digits == 7);
}
