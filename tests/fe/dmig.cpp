// DMIG punch: the real flying wing with its figures (examples/data/nastran_dmig_flying_wing), small
// and 16-column fields, and refusals.
#include <doctest/doctest.h>
#include <fmt/format.h>

#include <algorithm>
#include <fstream>
#include <numbers>
#include <titop/blocks/fe/dmig.hpp>
#include <titop/graph/error.hpp>
#include <titop/graph/linalg/eigen.hpp>
#include <titop/graph/linalg/symmetric.hpp>

#include "dynamics.hpp"
#include "support/folder.hpp"
#include "support/refused.hpp"

using namespace titop;
using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;
using fe_test::relative;
using titop_test::replaced;

namespace {

const std::string kFolder = TITOP_DATA_DIR "/nastran_dmig_flying_wing/";

const fe::GridMatrices& wing() {
  static const fe::GridMatrices m =
      fe::read_dmig(kFolder + "sol103_maewing1_femv5p1.pch", "KAAX", "MAAX");
  return m;
}

/// First elastic frequency of Nastran's own run [Hz].
double first_elastic() {
  std::ifstream file(kFolder + "eigenvalues.csv");
  std::string line;
  for (int i = 0; i < 8; ++i) std::getline(file, line);  // the title and seven modes
  return std::stod(line.substr(line.rfind(',') + 1));
}

/// Finite omega^2 of K x = omega^2 M x, massless motions condensed.
VectorXd eigenvalues(const MatrixXd& K, const MatrixXd& M) {
  const VectorXd scale =
      M.diagonal().unaryExpr([](double m) { return m > 0 ? 1 / std::sqrt(m) : 1.0; });
  const Eigen::SelfAdjointEigenSolver<MatrixXd> mass(scale.asDiagonal() * M * scale.asDiagonal());
  const Index empty = (mass.eigenvalues().array() <= 1e-8).count();
  const MatrixXd Ks = scale.asDiagonal() * K * scale.asDiagonal();
  const MatrixXd Z = mass.eigenvectors().leftCols(empty),
                 E = mass.eigenvectors().rightCols(K.rows() - empty);
  const MatrixXd T = E - Z * (Z.transpose() * Ks * Z).ldlt().solve(Z.transpose() * Ks * E);
  const VectorXd root = mass.eigenvalues().tail(K.rows() - empty).cwiseSqrt().cwiseInverse();
  const MatrixXd S = root.asDiagonal() * (T.transpose() * Ks * T) * root.asDiagonal();
  return Eigen::SelfAdjointEigenSolver<MatrixXd>((S + S.transpose()) / 2).eigenvalues();
}

fe::GridMatrices read(const std::string& text) {
  const titop_test::Folder folder;
  folder.write("m.pch", text);
  return fe::read_dmig(folder.path / "m.pch", "K", "M");
}

const std::string kSmall =
    "$ a comment\n"
    "DMIG    K       0       6       1       0\n"
    "DMIG    K       7       1               7       1       4.0             +\n"
    "+       9       3       -1.5            8               2.5-1\n"
    "DMIG    K       9       3               9       3       2.0\n"
    "DMIG    M       0       1       2       0\n"
    "DMIG*   M                              7               1\n"
    "*                      7               1         1.5D+00\n"
    "GRID    7               0.      0.      0.\n";

void refused(const std::string& text, std::initializer_list<std::string_view> names,
             Code code = Code::bad_file) {
  titop_test::check_refused([&] { read(text); }, code, names);
}

}  // namespace

TEST_CASE("flying wing: size, symmetry, massless rows") {
  const fe::GridMatrices& m = wing();
  CHECK(m.dofs.size() == 426);
  CHECK(m.digits == 10);
  CHECK(m.dofs.front() == fe::GridDof{101, 1});
  CHECK(m.K(0, 0) == 3245226.567);
  CHECK(m.K(0, 1) == -2199590.365);
  CHECK(m.K == m.K.transpose());
  CHECK(m.M == m.M.transpose());
  CHECK(m.K.cwiseAbs().maxCoeff() == 8004266417);
  CHECK(relative(eigh(m.K).lambda(425), 1.4e10) <= 0.05);
  Index massless = 0;
  for (Index i = 0; i < 426; ++i) massless += m.M.row(i).isZero(0);
  CHECK(massless == 34);
  // Eight more are no mass but rounding of ten digits: they vanish once every row has its own unit.
  const VectorXd plain = eigh(m.M).lambda;
  CHECK((plain.array() > 5e-13 * plain(425)).count() == 374);
  const VectorXd scale =
      m.M.diagonal().unaryExpr([](double d) { return d > 0 ? 1 / std::sqrt(d) : 0.0; });
  const VectorXd mass = eigh(scale.asDiagonal() * m.M * scale.asDiagonal()).lambda;
  CHECK((mass.array() > 1e-3).count() == 366);
  CHECK((mass.array() > 1e-9).count() == 366);
}

TEST_CASE("flying wing: effect of ten digits on the rigid and the first elastic mode") {
  const fe::GridMatrices& m = wing();
  const double expected = std::pow(2 * std::numbers::pi * first_elastic(), 2);
  const VectorXd as_read = eigenvalues(m.K, m.M);
  CHECK(as_read(0) >= -45);
  CHECK(as_read(0) <= -35);
  CHECK(as_read.head(6).maxCoeff() <= 10);
  const double off = relative(std::sqrt(as_read(6)), std::sqrt(expected));
  CHECK(off >= 3e-3);
  CHECK(off <= 4e-3);
  // The rigid motions projected out of K: they come to rest, the elastic one stays where it is.
  const Eigen::SelfAdjointEigenSolver<MatrixXd> solver(m.K);
  const MatrixXd V = solver.eigenvectors().rightCols(420);
  const MatrixXd K = V * solver.eigenvalues().tail(420).asDiagonal() * V.transpose();
  const VectorXd projected = eigenvalues(K, m.M);
  CHECK(projected.head(6).cwiseAbs().maxCoeff() <= 2e-3);
  CHECK(relative(std::sqrt(projected(6)), std::sqrt(expected)) <= 4e-3);
}

TEST_CASE("flying wing: rigid motions by statics move all grids of one frame alike") {
  const fe::GridMatrices& m = wing();
  const MatrixXd R = fe::rigid_motions_by_statics(m, 1010);
  const double mass = R.col(0).dot(m.M * R.col(0));
  for (Index i = 1; i < 3; ++i) CHECK(relative(R.col(i).dot(m.M * R.col(i)), mass) <= 1e-3);
  CHECK_THROWS_AS(fe::rigid_motions_by_statics(m, 1), Error);
}

TEST_CASE("fields of 8 and 16 columns, scalar points, numbers without E") {
  const fe::GridMatrices m = read(kSmall);
  REQUIRE(m.dofs == std::vector<fe::GridDof>{{7, 1}, {8, 0}, {9, 3}});
  CHECK(m.K == (MatrixXd(3, 3) << 4, 0.25, -1.5, 0.25, 0, 0, -1.5, 0, 2).finished());
  CHECK(m.M == (MatrixXd(3, 3) << 1.5, 0, 0, 0, 0, 0, 0, 0, 0).finished());
  CHECK(read(replaced(kSmall, "9       3       2.0\n",
                      "9       3       2.0\n+       7       1       -1.5\n"))
            .dofs.size() == 3);
}

TEST_CASE("digits: of the shorter matrix, without leading zeros, at most 7 in single precision") {
  const std::string two =
      "DMIG    K       0       6       2       0\nDMIG*   K                              7         "
      "      1\n*                      7               11.2345678901D+02\n"
      "DMIG    M       0       6       2       0\nDMIG*   M                              7         "
      "      1\n*                      7               1   0.0012345678\n";
  CHECK(read(two).digits == 8);
  CHECK(read(replaced(two, "0.0012345678", "1.23456789E+2")).digits == 9);
  CHECK(read(replaced(two, "0.0012345678", "2.3456789012")).digits == 11);
  CHECK(read(replaced(two, "K       0       6       2", "K       0       6       1")).digits == 7);
}

TEST_CASE("digits: numbers typed by hand are as exact as their type, not rounded to one digit") {
  CHECK(read(kSmall).digits == 7);  // "4.0", "2.0"
}

TEST_CASE("broken DMIG files are refused with line and field") {
  refused(replaced(kSmall, "-1.5 ", "-1,5 "), {"m.pch:4", "'-1,5'"});
  refused(replaced(kSmall, "+       9       3", "+       9       7"), {"m.pch:4", "'7'", "0", "6"});
  refused(replaced(kSmall, "+       9 ", "+       x "), {"m.pch:4", "'x'"});
  refused(replaced(kSmall, "DMIG    K       9", "DMIG    KK      9"), {"m.pch:5", "'KK'"});
  refused(replaced(kSmall, "M       0       1 ", "M       0       2 "), {"m.pch", "M", "form 2"});
  refused(replaced(kSmall, "K       0       6       1", "K       0       6       3"),
          {"m.pch", "K", "type 3"});
  refused(replaced(kSmall, "M       0", "MM      0"), {"m.pch:7", "'M'"});
  refused(replaced(replaced(kSmall, "M       0", "MM      0"), "DMIG*   M ", "DMIG*   MM"),
          {"m.pch", "M", "K, MM"}, Code::unknown_name);
  refused(replaced(kSmall, "9       3       2.0\n",
                   "9       3       2.0\n+       7       1       -1.6\n"),
          {"m.pch:6", "-1.6", "(7 1, 9 3)", "-1.5", "line 4"});
  refused("nothing\n", {"m.pch", "K"}, Code::unknown_name);
}

TEST_CASE("DMIG cards in other forms are refused by line, not passed over") {
  const std::string fixed = "DMIG    K       9       3               9       3       2.0\n";
  for (const char* other :
       {"DMIG,K,9,3,,9,3,2.0\n", "dmig    K       9       3               9       3       2.0\n",
        "DMIG\tK\t9\t3\t\t9\t3\t2.0\n", "DMIG K 9 3 9 3 2.0\n", "Dmig*,K,9,3\n",
        "  DMIG  K       9       3               9       3       2.0\n"})
    refused(replaced(kSmall, fixed, other), {"m.pch:5"});
  const std::string next = "+       9       3       -1.5            8               2.5-1\n";
  for (const char* other : {"+,9,3,-1.5\n", ",9,3,-1.5\n", "+\t9\t3\t-1.5\n", "\t9\t3\t-1.5\n"})
    refused(replaced(kSmall, next, other), {"m.pch:4", "8", "16"});
  // Cards with other names are none of it.
  CHECK(read(kSmall + "DMIGROT,K,9\ngrid,9,,0.,0.,0.\n+,1\n").dofs.size() == 3);
}

TEST_CASE("the flying wing cut at any byte of its last line is refused") {
  std::ifstream file(kFolder + "sol103_maewing1_femv5p1.pch");
  const std::string whole{std::istreambuf_iterator<char>(file), {}};
  // A stiffness of one entry and the whole mass: each cut is read quickly.
  const auto mass = whole.find("DMIG    MAAX");
  const std::string all = whole.substr(0, whole.find("DMIG", whole.find("\n*") + 1)) +
                          whole.substr(mass, whole.find("DMIG    VAX") - mass);
  const auto read_cut = [&](std::size_t length) {
    const titop_test::Folder folder;
    folder.write("m.pch", all.substr(0, length));
    return fe::read_dmig(folder.path / "m.pch", "KAAX", "MAAX");
  };
  CHECK(read_cut(all.size()).K(0, 0) == 3245226.567);
  const auto line = all.rfind('\n', all.size() - 2) + 1;
  const std::string place = fmt::format("m.pch:{}", std::count(all.begin(), all.end(), '\n'));
  for (std::size_t length = line + 1; length < all.size(); ++length)
    titop_test::check_refused([&] { read_cut(length); }, Code::bad_file,
                              {place, "'" + all.substr(line, length - line) + "'"});
}
