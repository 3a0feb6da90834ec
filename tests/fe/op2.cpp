// OP2: the real cantilever against its tables as another program has read them (README.md there),
// and small files in every byte order and word size.
#include <doctest/doctest.h>

#include <cstring>
#include <titop/blocks/fe/modal_csv.hpp>
#include <titop/blocks/fe/op2.hpp>
#include <titop/blocks/fe/op2_results.hpp>
#include <titop/blocks/fe/scaled.hpp>
#include <titop/graph/error.hpp>

#include "fe/op2_writer.hpp"
#include "support/folder.hpp"
#include "support/refused.hpp"

using namespace titop;
using Eigen::MatrixXd;
using fe_test::Op2Style;
using fe_test::Op2Writer;
using titop_test::check_refused;

namespace {

const std::string kFolder = TITOP_DATA_DIR "/nastran_cantilever/";

fe::Op2File read(const std::string& bytes) {
  const titop_test::Folder folder;
  folder.write("m.op2", bytes);
  return fe::read_op2(folder.path / "m.op2");
}

/// Options of a run, and faults of its file.
struct Run {
  double mass = 1;                                         ///< generalised
  std::vector<double> forces = {100, 0, -200, 0, -50, 0};  ///< of the support at grid 7
  std::vector<double> at_7 = {0, 0, 0, 0, 0, 0};           ///< shape
  const char* shapes = "OUGV1";                            ///< table
  std::int64_t code = 7, mode = 1;                         ///< of it
  bool twice = false;                                      ///< two tables LAMA
  bool words_missing = false;                              ///< in LAMA
};

/// One mode, of 10 rad/s, of grids 7 and 9 and a scalar point 11. Grid 9 is at (5, 0, 0) in system
/// 3, which lies at (0, 0, 2) and is turned: its z along the basic x, its x along the basic y. Both
/// move in that system. About grid 7 in the basic frame MPFACS is (2, -1, 0, 0, 0, 0.5): its
/// support forces are -100 times this, (100, 0, -200), (0, -50, 0) in system 3.
std::string modes(Op2Style style, bool wide, const Run& run = {}) {
  Op2Writer w(style);
  const auto real = [&](double x) { return wide ? w.wide(x) : w.real(x); };
  const auto reals = [&](const std::vector<double>& values) {
    std::string all;
    for (const double x : values) all += real(x);
    return all;
  };
  w.label();
  w.table("GEOM1", {w.integers({2101, 21, wide ? 220 : 8}) + w.integers({3, 1, 2, 0}) +
                        reals({0, 0, 2, 1, 0, 2, 0, 1, 2}),
                    w.integers({4501, 45, wide ? 1120001 : 1}) + w.integers({7, 0}) +
                        reals({1, 2, 3}) + w.integers({3, 0, 0}) + w.integers({9, 3}) +
                        reals({5, 0, 0}) + w.integers({3, 0, 0})});
  const auto singles = [&](const std::vector<double>& values) {
    std::string all;
    for (const double x : values) all += w.real(x);
    return all;
  };
  for (int i = 0; i < (run.twice ? 2 : 1); ++i)
    w.table("LAMA", {std::string(w.integers(std::vector<std::int64_t>(146, 0))),
                     w.integers({1, 1}) + singles({100, 10, 1.5, run.mass}) +
                         (run.words_missing ? std::string() : singles({100 * run.mass}))});
  const auto ident = [&](std::int64_t code, std::int64_t mode) {
    std::vector<std::int64_t> words(146, 0);
    words[0] = 22, words[1] = code, words[4] = mode, words[9] = 8;
    return w.integers(words);
  };
  w.table(run.shapes,
          {ident(run.code, run.mode), w.integers({71, 1}) + singles(run.at_7) +
                                          w.integers({91, 1}) + singles({1, 2, 3, 4, 5, 6}) +
                                          w.integers({111, 2}) + singles({9, 0, 0, 0, 0, 0})});
  if (!run.forces.empty())
    w.table("OQG1", {ident(3, 1), w.integers({71, 1}) + singles(run.forces)});
  w.matrix("RBMASSS", 8 * MatrixXd::Identity(6, 6), 2);
  MatrixXd L = MatrixXd::Zero(6, 1);
  L(0) = 2, L(1) = -1, L(5) = 0.5;
  w.matrix("MPFACS", L, 1);
  w.end();
  return w.bytes;
}

}  // namespace

TEST_CASE("cantilever: the OP2 has the body of its CSV tables") {
  const fe::Op2File file = fe::read_op2(kFolder + "pn_mwe_s-solution_1.op2");
  CHECK(file.tables.size() > 20);
  const ModalData data = scaled(fe::op2_modal_data(file, "1", {"3"}), {.length = 1e-3});
  ModalData right = fe::read_modal_csv(kFolder + "cantilever.csv");
  right.D_P.diagonal().head<3>().array() -= 0.00851685768388;  // at P: not in RBMASSS
  CHECK((data.omega - right.omega).cwiseAbs().maxCoeff() <= 6e-8 * 6565);
  CHECK((data.D_P - right.D_P).cwiseAbs().maxCoeff() <= 1e-12 * 6);
  CHECK((data.L_P - right.L_P).cwiseAbs().maxCoeff() <= 1e-15 * 2.3);
  REQUIRE(data.children.size() == 1);
  CHECK((data.children[0].PC - right.children[0].PC).norm() <= 1e-15);
  CHECK((data.children[0].Phi_C - right.children[0].Phi_C).cwiseAbs().maxCoeff() <= 1e-7 * 6.6);
}

TEST_CASE("modes and geometry in every byte order, word size and precision") {
  for (const bool big_endian : {false, true})
    for (const bool long_words : {false, true})
      for (const bool wide : {false, true}) {
        CAPTURE(big_endian);
        CAPTURE(long_words);
        CAPTURE(wide);
        const fe::Op2File file = read(modes({big_endian, long_words}, wide));
        const std::vector<fe::Grid> grids = fe::op2_grids(file);
        REQUIRE(grids.size() == 2);
        CHECK(grids[0].position == Vector3d(1, 2, 3));
        CHECK(grids[1].position == Vector3d(0, 5, 2));
        Matrix3d T;
        T << 0, 0, 1, 1, 0, 0, 0, 1, 0;
        CHECK(grids[1].frame.nominal() == T);
        const ModalData data = fe::op2_modal_data(file, "7", {"9"});
        CHECK(data.omega == Eigen::VectorXd::Constant(1, 10));
        CHECK(data.D_P == Matrix6(8 * Matrix6::Identity()));
        CHECK(data.L_P == (MatrixXd(1, 6) << 2, -1, 0, 0, 0, 0.5).finished());
        CHECK(data.children[0].PC == Vector3d(-1, 3, -1));
        CHECK(data.children[0].Phi_C == (MatrixXd(6, 1) << 3, 1, 2, 6, 4, 5).finished());
        CHECK(fe::op2_modes(file).shapes.size() == 2);  // not the scalar point
      }
}

TEST_CASE("systems of GEOM1: by points and by grids, cylindrical and spherical") {
  for (const bool big_endian : {false, true})
    for (const bool long_words : {false, true})
      for (const bool wide : {false, true}) {
        CAPTURE(big_endian);
        CAPTURE(long_words);
        CAPTURE(wide);
        Op2Writer w({big_endian, long_words});
        const auto reals = [&](std::initializer_list<double> values) {
          std::string all;
          for (const double x : values) all += wide ? w.wide(x) : w.real(x);
          return all;
        };
        // Systems 3 and 4 at (0, 0, 2), z along the basic x, x along the basic y; 5 by grids there.
        const auto by_points = [&](std::int64_t code, std::int64_t sub, std::int64_t id) {
          return w.integers({code, sub,
                             wide        ? 1310008
                             : sub == 20 ? 9
                                         : 10,
                             id, 1, 2, 0}) +
                 reals({0, 0, 2, 1, 0, 2, 0, 1, 2});
        };
        const auto grid = [&](int id, int in, std::initializer_list<double> point, int moves) {
          return w.integers({id, in}) + reals(point) + w.integers({moves, 0, 0});
        };
        w.table("GEOM1", {by_points(2001, 20, 3), by_points(2201, 22, 4),
                          w.integers({1701, 17, 6, 5, 2, 1, 11, 12, 13}),
                          w.integers({4501, 45, wide ? 1120001 : 1}) + grid(1, 3, {2, 90, 5}, 3) +
                              grid(2, 4, {2, 90, 90}, 0) + grid(3, 5, {2, 90, 5}, 5) +
                              grid(11, 0, {0, 0, 2}, 0) + grid(12, 0, {1, 0, 2}, 0) +
                              grid(13, 0, {0, 1, 2}, 0)});
        w.end();
        const std::vector<fe::Grid> grids = fe::op2_grids(read(w.bytes));
        REQUIRE(grids.size() == 6);
        // r = 2 and theta = 90 degrees: 2 along y, which is the basic z.
        CHECK((grids[0].position - Vector3d(5, 0, 4)).norm() <= 1e-15);
        CHECK((grids[1].position - Vector3d(0, 0, 4)).norm() <= 1e-15);
        CHECK((grids[2].position - Vector3d(5, 0, 4)).norm() <= 1e-15);
        Matrix3d T;  // r along the basic z, theta against the basic y, z along the basic x
        T << 0, 0, 1, 0, -1, 0, 1, 0, 0;
        CHECK((grids[0].frame.nominal() - T).cwiseAbs().maxCoeff() <= 1e-15);
        CHECK((grids[2].frame.nominal() - T).cwiseAbs().maxCoeff() <= 1e-15);
      }
}

TEST_CASE("rows of matrices by USET and EQEXIN") {
  // Grid 20 comes first in Nastran's order, then the scalar point 5, then grid 10: 13 rows. Of grid
  // 20 z is in the o-set, rx is an m, ry in s (sb, with bit 1, which some versions give to the
  // b-set); grid 10 is supported (sg). KAA has 20.x, 20.y, 20.rz, 5.
  const std::int64_t b = 2 | 1 << 21, o = 4, m = 1, sb = 1 << 10 | 2, sg = 1 << 9, q = 1 << 22;
  const std::vector<std::int64_t> sets = {b, b, o, m, sb, b, q, sg, sg, sg, sg, sg, sg};
  const auto file = [&](const std::vector<std::int64_t>& uset, Eigen::Index n) {
    Op2Writer w({});
    w.table("GEOM1", {w.integers({4501, 45, 1, 10, 0}) + w.real(1) + w.real(0) + w.real(0) +
                      w.integers({0, 0, 0, 20, 0}) + w.real(3) + w.real(0) + w.real(0) +
                      w.integers({0, 0, 0})});
    w.table("EQEXINS", {w.integers({5, 2, 10, 3, 20, 1}), w.integers({5, 72, 10, 81, 20, 11})});
    if (!uset.empty()) w.table("USET", {w.integers(uset)});
    w.matrix("KAA", MatrixXd::Identity(n, n), 2);
    w.matrix("MAA", 2 * MatrixXd::Identity(n, n), 2);
    w.end();
    return read(w.bytes);
  };
  const fe::GridMatrices reduced = fe::op2_matrices(file(sets, 4), "KAA", "MAA");
  CHECK(reduced.dofs == std::vector<fe::GridDof>{{20, 1}, {20, 2}, {20, 6}, {5, 0}});
  CHECK(reduced.M == 2 * MatrixXd::Identity(4, 4));
  const fe::GridMatrices all = fe::op2_matrices(file(sets, 13), "KAA", "MAA");
  CHECK(all.dofs[0] == fe::GridDof{20, 1});
  CHECK(all.dofs[6] == fe::GridDof{5, 0});
  CHECK(all.dofs[7] == fe::GridDof{10, 1});
  const fe::GridMatrices alone = fe::op2_matrices(file({}, 12), "KAA", "MAA");
  CHECK(alone.dofs[0] == fe::GridDof{10, 1});  // by number, without the tables
  check_refused([&] { fe::op2_matrices(file(sets, 5), "KAA", "MAA"); }, Code::bad_file,
                {"KAA", "5 rows", "a-set 4", "g-set 13"});
  check_refused(
      [&] {
        fe::op2_matrices(file({b, b}, 2), "KAA", "MAA");
      },
      Code::bad_file, {"USET", "2", "EQEXIN", "13"});
}

TEST_CASE("cantilever: the parent is the grid that the run clamps") {
  const fe::Op2File file = fe::read_op2(kFolder + "pn_mwe_s-solution_1.op2");
  // Grid 2, at the tip, belongs to no element, and thus rests.
  CHECK(fe::grids_at_rest(fe::op2_modes(file)) == std::vector<int>{1, 2});
  check_refused([&] { fe::op2_modal_data(file, "3", {"5"}); }, Code::bad_value,
                {"pn_mwe_s-solution_1.op2", "grid 3", "SPC1", "1, 2"});
  check_refused([&] { fe::op2_modal_data(file, "2", {"3"}); }, Code::bad_file,
                {"grid 2", "mode 1", "MPFACS", "SPCFORCES"});
}

TEST_CASE("runs whose results are no clamped modes of mass 1 are refused") {
  const auto refused = [](const Run& run, Code code,
                          std::initializer_list<std::string_view> names) {
    check_refused([&] { fe::op2_modal_data(read(modes({}, false, run)), "7", {"9"}); }, code,
                  names);
  };
  refused({.mass = 4}, Code::bad_file, {"mode 1", "4", "MASS"});
  refused({.at_7 = {0, 0, 0, 0, 0, 1e-4}}, Code::bad_value, {"grid 7", "SPC1"});
  refused({.forces = {}}, Code::bad_file, {"OQG1", "SPCFORCES(SORT1,REAL)=ALL"});
  // The support takes half: there is another one.
  refused({.forces = {50, 0, -100, 0, -25, 0}}, Code::bad_file, {"grid 7", "MPFACS"});
  // MPFACS about a grid elsewhere.
  refused({.forces = {100, 0, -200, 0, -50, 30}}, Code::bad_file, {"grid 7", "MEFFMASS"});
  for (const char* name : {"BOPHIG", "OPHIG"})
    refused({.shapes = name}, Code::bad_file, {"OUGV1", "VECTOR(SORT1,REAL)=ALL"});
  refused({.twice = true}, Code::bad_file, {"several", "LAMA"});
  refused({.words_missing = true}, Code::bad_file, {"LAMA", "6 words", "7"});
  for (const std::int64_t code : {1, 1007, 2007})  // displacements, complex, SORT2
    refused({.code = code}, Code::bad_file, {"OUGV1", "SORT1"});
  refused({.mode = 2}, Code::bad_file, {"OUGV1", "mode 2", "LAMA"});
}

TEST_CASE("a missing table is named with the line that writes it") {
  Op2Writer w({});
  w.matrix("KAA", MatrixXd::Identity(2, 2), 2);
  w.end();
  const fe::Op2File file = read(w.bytes);
  CHECK(fe::find_matrix(file.matrices, "KAA").value == MatrixXd::Identity(2, 2));
  check_refused([&] { fe::op2_modes(file); }, Code::bad_file,
                {"m.op2", "LAMA, but none", "VECTOR(SORT1,REAL)=ALL"});
  check_refused([&] { fe::op2_grids(file); }, Code::bad_file, {"GEOM1", "PARAM,POSTEXT,YES"});
  std::string other = modes({}, false);
  for (std::size_t at; (at = other.find("MPFACS")) != std::string::npos;)
    other.replace(at, 6, "MPFACX");
  check_refused([&] { fe::op2_modal_data(read(other), "7", {}); }, Code::bad_file,
                {"MPFACS, but RBMASSS, MPFACX", "GRID=7", "PARTFAC"});
  check_refused([&] { fe::op2_modes(read(modes({}, false, {.shapes = "OUGX"}))); }, Code::bad_file,
                {"OUGV1, but GEOM1, LAMA, OUGX, OQG1"});
  check_refused([&] { fe::op2_modal_data(read(modes({}, false)), "7", {"8"}); }, Code::unknown_name,
                {"grid 8"});
}

TEST_CASE("a grid twice in GEOM1: the same data, or refused") {
  const auto with = [](float z) {
    Op2Writer w({});
    const auto grid = [&](double at) {
      return w.integers({10, 0}) + w.real(1) + w.real(2) + w.real(at) + w.integers({0, 0, 0});
    };
    w.table("GEOM1", {w.integers({4501, 45, 1}) + grid(3)});
    w.table("GEOM1S", {w.integers({4501, 45, 1}) + grid(z)});
    w.end();
    return read(w.bytes);
  };
  CHECK(fe::op2_grids(with(3)).size() == 1);
  check_refused([&] { fe::op2_grids(with(4)); }, Code::bad_file, {"m.op2", "grid 10", "twice"});
}

TEST_CASE("broken OP2 files are refused with data block, record and byte") {
  const std::string good = modes({}, false);
  const auto with = [&](std::size_t at, std::int32_t value) {
    std::string bytes = good;
    std::memcpy(&bytes[at], &value, 4);
    return [bytes] { read(bytes); };
  };
  check_refused(with(0, 5), Code::bad_file, {"m.op2", "byte 0", "5", "4", "8"});
  check_refused(with(4, 2), Code::bad_file, {"m.op2", "12 bytes"});
  check_refused([&] { read(good.substr(0, 300)); }, Code::bad_file, {"m.op2", "GEOM1"});
  const std::size_t lama = good.find("LAMA");
  check_refused(with(lama + 16, -5), Code::bad_file, {"LAMA", "marker -5", "-1"});
  check_refused([&] { read(std::string(7, '\0')); }, Code::bad_file, {"m.op2"});
}
