// f06: the cantilever's tables printed as Nastran does, against the same tables as another program
// has read them from its OP2; a mass on a massless beam in closed form; and files with tables
// missing or broken.
#include <doctest/doctest.h>

#include <titop/blocks/fe/f06.hpp>
#include <titop/blocks/fe/op2_results.hpp>
#include <titop/titop.hpp>

#include "fe/f06_writer.hpp"
#include "support/folder.hpp"
#include "support/refused.hpp"

using namespace titop;
using Eigen::MatrixXd;
using Eigen::VectorXd;
using fe_test::F06Writer;
using titop_test::check_refused;
using titop_test::Folder;
using titop_test::has_line;
using titop_test::replaced;
using Rows = std::vector<std::pair<int, Vector6>>;

namespace {

const std::string kCantilever = TITOP_DATA_DIR "/nastran_cantilever/";
constexpr double kPrinted = 5e-7;  ///< half a unit of the seventh digit

fe::F06File read(const std::string& text) {
  const Folder folder;
  folder.write("m.f06", text);
  return fe::read_f06(folder.path / "m.f06");
}

/// The real cantilever, clamped at grid 1, from the tables of its OP2.
std::string cantilever() {
  const fe::Op2File op2 = fe::read_op2(kCantilever + "pn_mwe_s-solution_1.op2");
  const fe::NormalModes modes = fe::op2_modes(op2);
  const MatrixXd L = fe::find_matrix(op2.matrices, "MPFACS").value;
  F06Writer w;
  w.eigenvalues(modes.omega, 0, 3);
  w.rigid(fe::find_matrix(op2.matrices, "RBMASSS").value, L * L.transpose(), "AT GRID        1");
  w.fractions(modes.omega);
  w.by_mode("MODAL PARTICIPATION FACTORS", modes.omega, L);
  w.by_mode("MODAL EFFECTIVE MASS", modes.omega, L.cwiseAbs2());
  for (int k = 0; k < 3; ++k) {
    Rows rows;
    for (const auto& [grid, shape] : modes.shapes) rows.emplace_back(grid, shape.col(k));
    w.vector(modes.omega(k), k + 1, rows);
    w.forces(modes.omega(k), {{1, -modes.omega(k) * modes.omega(k) * L.col(k)}});
  }
  return w.text;
}

/// A mass of 2 on a massless beam along x from grid 7 at (1, 2, 3), length 4, EI = 32 about y and
/// z, no torsion or extension: omega^2 = 3 EI / (m L^3) = 0.75, twice; of a unit force at the tip
/// the rotation is 3 / (2 L) of the displacement. Grid 9, at the tip, moves in a system with its x
/// along the basic y, its y along the basic z, its z along the basic x.
struct TipMass {
  double m = 2, length = 4, square = 0.75;
  Vector3d P{1, 2, 3};
  MatrixXd shapes = MatrixXd::Zero(6, 2), factors = MatrixXd::Zero(6, 2);  ///< at grid 9; about 7
  VectorXd omega = VectorXd::Constant(2, std::sqrt(square));
  Matrix6 D;

  TipMass() {
    const double u = 1 / std::sqrt(m), r = 1.5 * u / length;
    shapes.col(0) << 0, u, 0, 0, 0, r;
    shapes.col(1) << 0, 0, u, 0, -r, 0;
    factors.col(0) << 0, m * u, 0, 0, 0, length * m * u;
    factors.col(1) << 0, 0, m * u, 0, -length * m * u, 0;
    D = about(P);
  }
  /// Rigid mass about a point.
  Matrix6 about(const Vector3d& point) const {
    return rigid_mass(m, Matrix3d::Zero(), point - P - Vector3d(length, 0, 0));
  }
  static Vector6 in_own_frame(const Vector6& v) {
    Vector6 own;
    own << v(1), v(2), v(0), v(4), v(5), v(3);
    return own;
  }
  /// Variations of the printed tables.
  struct Print {
    bool vectors = true, forces = true, factors = true, rigid = true, weight = false;
    bool check = false;                  ///< WEIGHTCHECK, about grid 9
    Matrix6 rounding = Matrix6::Zero();  ///< of the rigid mass
    double share = 1;                    ///< of the forces that grid 7 takes
    double mass = 1, effective = 1;
    double wtmass = 1;
  };
  /// Of the tables about the origin of the basic system.
  std::string f06() const { return f06(Print()); }
  std::string f06(const Print& print) const {
    F06Writer w;
    w.mass = print.mass;
    w.subtitle = "MODAL EFFECTIVE MASS FRACTION, R E A L   E I G E N V A L U E S";
    w.echo({"CORD2R  3       0       0.      0.      0.      1.      0.      0.      +A",
            "+A      0.      1.      0.", "GRID    7               1.      2.      3.",
            "GRID    9               5.      2.      3.      3",
            fmt::format("PARAM   WTMASS  {}", print.wtmass)});
    if (print.weight) w.weight(about(Vector3d::Zero()) / print.wtmass, 0);
    w.eigenvalues(3 * omega, 0, 2, "            (BEFORE AUGMENTATION OF RESIDUAL VECTORS)\n");
    w.eigenvalues(omega, 0, 1), w.eigenvalues(omega, 1, 2);  // on two pages
    if (print.check) w.weight_check(about({5, 2, 3}), 9);
    const MatrixXd L = tau(-P).transpose() * factors;
    if (print.rigid)
      w.rigid(about(Vector3d::Zero()) + print.rounding, L * L.transpose(),
              "AT ORIGIN OF BASIC COORDINATE SYSTEM");
    if (print.factors) w.by_mode("MODAL PARTICIPATION FACTORS", omega, L);
    w.by_mode("MODAL EFFECTIVE MASS", omega, print.effective * L.cwiseAbs2());
    w.by_mode("MODAL EFFECTIVE WEIGHT", omega, 9.81 * L.cwiseAbs2());
    w.fractions(omega);
    for (int k = 0; k < 2 && print.vectors; ++k) {
      w.vector(omega(k), k + 1, {{7, Vector6::Zero()}});
      w.vector(omega(k), k + 1, {{9, in_own_frame(shapes.col(k))}});  // on the next page
      w.text += "           101      S      5.000000E-01   2.500000E-01\n";
    }
    for (int k = 0; k < 2 && print.forces; ++k)
      w.forces(omega(k), {{7, -print.share * square * factors.col(k)}});
    return w.text;
  }
};

}  // namespace

TEST_CASE("cantilever: the f06 has the body of its CSV tables to seven digits") {
  const fe::F06File file = read(cantilever());
  const auto grids = fe::op2_grids(fe::read_op2(kCantilever + "pn_mwe_s-solution_1.op2"));
  const ModalData data = scaled(fe::f06_modal_data(file, grids, "1", {"3"}), {.length = 1e-3});
  ModalData right = fe::read_modal_csv(kCantilever + "cantilever.csv");
  right.D_P.diagonal().head<3>().array() -= 0.00851685768388;  // at P: not in RBMASSS
  CHECK(data.digits == 7);
  CHECK((data.omega - right.omega).cwiseAbs().maxCoeff() <= 2 * kPrinted * 6565);
  CHECK((data.D_P - right.D_P).cwiseAbs().maxCoeff() <= kPrinted * 6);
  CHECK((data.L_P - right.L_P).cwiseAbs().maxCoeff() <= kPrinted * 2.3);
  CHECK((data.children[0].PC - right.children[0].PC).norm() <= 1e-15);
  CHECK((data.children[0].Phi_C - right.children[0].Phi_C).cwiseAbs().maxCoeff() <=
        2 * kPrinted * 6.6);
  CHECK(fe::grids_at_rest(file.modes) == std::vector<int>{1, 2});
}

TEST_CASE("mass on a massless beam: tables about the origin, on pages, of two equal eigenvalues") {
  const TipMass right;
  const fe::F06File file = read(right.f06());
  CHECK(file.modes.numbers == std::vector<long long>{1, 2});
  CHECK(file.about == 0);
  REQUIRE(file.rigid);
  CHECK(file.forces.at(7).cols() == 2);
  const ModalData data = fe::f06_modal_data(file, fe::f06_grids(file), "7", {"9"});
  CHECK((data.omega - right.omega).cwiseAbs().maxCoeff() <= kPrinted * right.omega(0));
  CHECK((data.L_P.transpose() - right.factors).cwiseAbs().maxCoeff() <= kPrinted * 20);
  CHECK((data.D_P - right.D).cwiseAbs().maxCoeff() <= kPrinted * 100);
  CHECK(data.children[0].PC == Vector3d(4, 0, 0));
  CHECK((data.children[0].Phi_C - right.shapes).cwiseAbs().maxCoeff() <= kPrinted);
  // Moved by (1, 2, 3): inertias of up to 2 (5^2 + 3^2) + terms that cancel leave 2 * 4^2.
  CHECK(data.digits < 7);
  CHECK(data.digits > 5.5);
}

TEST_CASE("without the a-set's mass that of the weight generator, about its own reference point") {
  const TipMass right;
  const fe::F06File file = read(right.f06({.rigid = false, .weight = true}));
  REQUIRE(file.weight);
  CHECK(!file.rigid);
  const ModalData data = fe::f06_modal_data(file, fe::f06_grids(file), "7", {});
  CHECK((data.D_P - right.D).cwiseAbs().maxCoeff() <= kPrinted * 100);
  // A model in inch, lbf, s whose densities are weights.
  const fe::F06File weights = read(right.f06({.rigid = false, .weight = true, .wtmass = 2.59e-3}));
  CHECK(weights.wtmass == 2.59e-3);
  CHECK((fe::f06_modal_data(weights, fe::f06_grids(weights), "7", {}).D_P - right.D)
            .cwiseAbs()
            .maxCoeff() <= kPrinted * 100);
  check_refused([&] { read(right.f06({.wtmass = -1})); }, Code::bad_file, {"WTMASS", "-1"});
}

TEST_CASE("tables of WEIGHTCHECK about another grid change nothing") {
  const TipMass right;
  for (const bool rigid : {true, false}) {
    const fe::F06File file = read(right.f06({.rigid = rigid, .weight = !rigid, .check = true}));
    CHECK(file.about == 0);
    const ModalData data = fe::f06_modal_data(file, fe::f06_grids(file), "7", {"9"});
    CHECK((data.L_P.transpose() - right.factors).cwiseAbs().maxCoeff() <= kPrinted * 20);
    CHECK((data.D_P - right.D).cwiseAbs().maxCoeff() <= kPrinted * 100);
  }
}

TEST_CASE("entries of the rigid mass are rounded alone, and contradict each other by no more") {
  TipMass::Print print;
  print.rounding(1, 5) = 1e-5;  // of 10: the seventh digit
  const fe::F06File file = read(TipMass().f06(print));
  const ModalData data = fe::f06_modal_data(file, fe::f06_grids(file), "7", {"9"});
  CHECK(data.D_P == data.D_P.transpose());
  CHECK((data.D_P - TipMass().D).cwiseAbs().maxCoeff() <= kPrinted * 100);
  print.rounding(1, 5) = 0.1;
  const fe::F06File wrong = read(TipMass().f06(print));
  check_refused([&] { fe::f06_modal_data(wrong, fe::f06_grids(wrong), "7", {}); }, Code::bad_file,
                {"m.f06", "y, rz", "1.010000e+01", "1.000000e+01"});
}

TEST_CASE("modes above fifty are on pages without the title of their table") {
  const Eigen::Index n = 120;
  const VectorXd omega = VectorXd::LinSpaced(n, 1, 2);
  const MatrixXd L = VectorXd::LinSpaced(6, 1, 2) * omega.transpose();
  F06Writer w;
  w.eigenvalues(omega, 0, n);
  w.rigid(Matrix6::Identity(), Matrix6::Identity(), "AT ORIGIN OF BASIC COORDINATE SYSTEM");
  w.fractions(omega);
  w.by_mode("MODAL PARTICIPATION FACTORS", omega, L);
  w.by_mode("MODAL EFFECTIVE MASS", omega, L.cwiseAbs2());
  const fe::F06File file = read(w.text);
  REQUIRE(file.factors);
  REQUIRE(file.effective);
  REQUIRE(file.factors->cols() == n);
  CHECK((*file.factors - L).cwiseAbs().maxCoeff() <= kPrinted * 4);
  CHECK((*file.effective - L.cwiseAbs2()).cwiseAbs().maxCoeff() <= kPrinted * 16);
}

TEST_CASE("a missing table is named, with the case control that prints it") {
  const TipMass right;
  const auto refused = [&](const TipMass::Print& print,
                           std::initializer_list<std::string_view> names) {
    const fe::F06File file = read(right.f06(print));
    check_refused([&] { fe::f06_modal_data(file, fe::f06_grids(file), "7", {"9"}); },
                  Code::bad_file, names);
  };
  refused({.vectors = false}, {"m.f06", "REAL EIGENVECTOR", "VECTOR(SORT1,REAL,PRINT)=ALL"});
  refused({.factors = false}, {"MODAL PARTICIPATION FACTORS", "MEFFMASS(PRINT,GRID=7"});
  refused({.rigid = false}, {"A-SET RIGID BODY MASS MATRIX", "MEFFMASS(SUMMARY)=YES"});
  refused({.forces = false}, {"SINGLE-POINT CONSTRAINT", "SPCFORCES(SORT1,REAL,PRINT)=ALL"});
  refused({.share = 0.5}, {"grid 7", "mode 1", "SPCFORCES"});  // another support takes the rest
  refused({.mass = 4}, {"generalised mass 4", "MASS"});
  refused({.effective = 1.001}, {"effective mass", "participation factor"});
  check_refused([] { read("1  NASTRAN\n"); }, Code::bad_file,
                {"m.f06", "REAL EIGENVALUES", "METHOD", "SOL 103"});
  const fe::F06File no_echo = read(replaced(right.f06(), "B U L K", "B O L K"));
  check_refused([&] { fe::f06_grids(no_echo); }, Code::bad_file, {"ECHO=SORT", "--grids"});
}

TEST_CASE("parents that move, grids that are not there") {
  const TipMass right;
  const fe::F06File file = read(right.f06());
  const auto grids = fe::f06_grids(file);
  check_refused([&] { fe::f06_modal_data(file, grids, "9", {}); }, Code::bad_value,
                {"grid 9", "moves", "7"});
  check_refused([&] { fe::f06_modal_data(file, grids, "8", {}); }, Code::unknown_name, {"grid 8"});
  check_refused([&] { fe::f06_modal_data(file, grids, "7", {"11"}); }, Code::unknown_name,
                {"grid 11"});
}

TEST_CASE("broken tables are refused with their line") {
  const std::string good = TipMass().f06();
  const auto refused = [&](const char* part, const char* with,
                           std::initializer_list<std::string_view> names) {
    check_refused([&] { read(replaced(good, part, with)); }, Code::bad_file, names);
  };
  refused("        2         2        7.500000E-01", "        1         2        7.500000E-01",
          {"m.f06:", "once", "subcase"});
  refused("        2         2        7.500000E-01", "        2         2        ************",
          {"m.f06:", "****", "mode"});
  refused("G      7.071068E-01   0.0", "G      7.071068X-01   0.0", {"m.f06:", "grid"});
  refused("N O .          2", "N O .          3", {"3 eigenvectors", "2 eigenvalues"});
  refused("             9      G ", "             7      G ", {"m.f06:", "once"});
  refused("EIGENVALUE =  7.500000E-01\n                    F O", "EIGENVALUE =  7.6E-01\n F O",
          {"7.600000e-01", "eigenvalue"});
  refused("*  2.000000E+00", "*  2.00000X", {"m.f06:72", "rigid mass"});
  check_refused([&] { read(good + " *** USER FATAL MESSAGE 9050 (SEKRRS)\n"); }, Code::bad_file,
                {"m.f06:", "FATAL MESSAGE 9050"});
  check_refused([&] { read(good + good.substr(good.find("1    WING"))); }, Code::bad_file,
                {"once", "subcase"});
}

TEST_CASE("import of an f06: positions from its echo, beside it, or from --grids") {
  const Folder folder;
  const std::string text = TipMass().f06();
  folder.write("beam.f06", text);
  const fe::Import listed = fe::import_body(folder.path / "beam.f06");
  CHECK(listed.ports == std::vector<std::string>{"7", "9"});
  CHECK(has_line(listed.text, {"modes: 2", "7 digits"}));
  CHECK(has_line(listed.text, {"at rest", "7"}));
  CHECK(listed.text.find("no table") == std::string::npos);
  CHECK(has_line(listed.text, {"warning", "END OF JOB"}));
  folder.write("whole.f06",
               text + "1                                        * * * END OF JOB * * *\n");
  CHECK(fe::import_body(folder.path / "whole.f06").text.find("END OF JOB") == std::string::npos);
  folder.write("few.f06", TipMass().f06({.vectors = false, .factors = false}));
  const std::string few = fe::import_body(folder.path / "few.f06").text;
  CHECK(has_line(few, {"no table REAL EIGENVECTOR", "VECTOR(PRINT)=ALL"}));
  CHECK(has_line(few, {"no table MODAL PARTICIPATION FACTORS", "MEFFMASS(PARTFAC)=YES"}));
  const fe::ImportOptions options{
      .parent = "7", .children = {"9"}, .units = {.length = 1e-3}, .modes = {.xi = {0.01}}};
  const fe::Import found = fe::import_body(folder.path / "beam.f06", options);
  REQUIRE(found.body);
  CHECK(has_line(found.text, {"grids from its bulk data echo", "2"}));
  CHECK(found.body->children[0].PC == Vector3d(4e-3, 0, 0));
  CHECK(found.body->xi == Eigen::Vector2d(0.01, 0.01));
  CHECK(compile(diagram_of_body(*found.body)).inputs().size() == 12);

  folder.write("alone.f06", replaced(text, "B U L K", "B O L K"));
  check_refused([&] { fe::import_body(folder.path / "alone.f06", options); }, Code::bad_file,
                {"alone.f06", "--grids"});
  folder.write("alone.bdf", "GRID,7,,1.,2.,3.\nGRID,9,,5.,2.,3.\n");
  CHECK(has_line(fe::import_body(folder.path / "alone.f06", options).text, {"alone.bdf"}));
  folder.write("other.bdf", "GRID,7,,0.,2.,3.\nGRID,9,,5.,2.,3.\n");
  check_refused(
      [&] {
        fe::import_body(folder.path / "beam.f06",
                        {.parent = "7", .grids = folder.path / "other.bdf"});
      },
      Code::bad_file, {"grid 7", "participation"});  // moved to another place
  check_refused([&] { fe::import_body(folder.path / "beam.f06", {.modes = {.kept = 1}}); },
                Code::bad_value, {"beam.f06", "--modes"});
}
