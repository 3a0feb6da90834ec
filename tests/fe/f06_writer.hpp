#pragma once

#include <fmt/format.h>

#include <Eigen/Core>
#include <string>
#include <titop/graph/linalg/kinematics.hpp>
#include <vector>

/// Tables as Nastran prints them: the first column controls the printer, pages have three lines of
/// titles, numbers seven digits. The tables of MEFFMASS and WEIGHTCHECK are laid out as in two
/// files of others: NX Nastran 10.2 (github.com/misams/f06ModalReader, SOL103_multiple_of_50.f06)
/// and MSC Nastran 2018.0.1 (github.com/ymnpy/modal_contribution, basic.f06).
namespace fe_test {

inline std::string printed(double value) {
  return value == 0 ? " 0.0         " : fmt::format("{:13.6E}", value);
}

class F06Writer {
 public:
  std::string text = "1News\n Welcome to Nastran\n";
  std::string subtitle = "CLAMPED AT ONE GRID";

  void page() {
    text += fmt::format("1    WING {:>100}   PAGE {:5}\n      {}\n0 {:>120}\n", "NASTRAN  6/17/05",
                        ++page_, subtitle, "SUBCASE 1");
  }
  void eigenvalues(const Eigen::VectorXd& omega, Eigen::Index begin, Eigen::Index end,
                   const std::string& more = "") {
    page();
    text +=
        " \n                                      R E A L   E I G E N V A L U E S\n" + more +
        "   MODE    EXTRACTION      EIGENVALUE            RADIANS             CYCLES            "
        "GENERALIZED         GENERALIZED\n"
        "    NO.       ORDER                                                                    "
        "   MASS              STIFFNESS\n";
    for (Eigen::Index k = begin; k < end; ++k) {
      const double w = omega(k);
      text += fmt::format("{:9}{:10}{:20.6E}{:20.6E}{:20.6E}{:20.6E}{:20.6E}\n", k + 1, k + 1,
                          w * w, w, w / (2 * EIGEN_PI), mass, mass * w * w);
    }
  }
  double mass = 1;  ///< generalised

  /// Rows of an eigenvector, by grid.
  void vector(double omega, int mode, const std::vector<std::pair<int, titop::Vector6>>& rows) {
    page();
    text += fmt::format(
        "      EIGENVALUE = {:13.6E}\n          CYCLES = {:13.6E}         R E A L   E I G E N V E "
        "C T "
        "O R   N O . {:10}\n \n",
        omega * omega, omega / (2 * EIGEN_PI), mode);
    grid_rows(rows);
  }
  void forces(double omega, const std::vector<std::pair<int, titop::Vector6>>& rows) {
    page();
    text += fmt::format(
        "      EIGENVALUE = {:13.6E}\n                    F O R C E S   O F   S I N G L E - P O I "
        "N T "
        "  C O N S T R A I N T\n \n",
        omega * omega);
    grid_rows(rows);
  }
  /// 6 x N, each mode a row, fifty on a page; the title stands on the first one.
  void by_mode(const std::string& title, const Eigen::VectorXd& omega,
               const Eigen::MatrixXd& values) {
    for (Eigen::Index k = 0; k < omega.size(); ++k) {
      if (k % 50 == 0) {
        page();
        text += k == 0 ? fmt::format("\n{:>80}\n\n", title) : "\n";
        text += "    MODE     FREQUENCY  ";
        for (const char* component : {"T1", "T2", "T3", "R1", "R2", "R3"})
          text += fmt::format("{:>14}    ", component);
        text += "\n     NO.\n\n";
      }
      text += fmt::format("{:8}{:16.6E}", k + 1, omega(k) / (2 * EIGEN_PI));
      for (Eigen::Index c = 0; c < 6; ++c) text += fmt::format("{:18.6E}", values(c, k));
      text += "\n";
    }
    text += "\n                  TOTAL ";
    for (const double sum : values.rowwise().sum()) text += fmt::format("{:18.6E}", sum);
    text += "\n\n\n";
  }
  /// Fraction and sum of the translations of each mode, then of the rotations.
  void fractions(const Eigen::VectorXd& omega) {
    for (const char* of : {"TRANSLATIONAL", "ROTATIONAL"}) {
      page();
      text += fmt::format(
          "\n{:>81}\n{:>72} DEGREES OF FREEDOM)\n\n    MODE    FREQUENCY\n     NO.        "
          "FRACTION  SUM\n\n",
          "MODAL EFFECTIVE MASS FRACTION", fmt::format("(FOR {}", of));
      for (Eigen::Index k = 0; k < omega.size(); ++k)
        text += fmt::format("{:8}{:16.6E}{}\n", k + 1, omega(k) / (2 * EIGEN_PI),
                            std::string("      5.000000E-01      1.000000E+00") +
                                "      5.000000E-01      1.000000E+00      5.000000E-01" +
                                "      1.000000E+00");
    }
  }
  /// "AT ORIGIN OF BASIC COORDINATE SYSTEM", "AT GRID 4".
  void rigid(const titop::Matrix6& D, const titop::Matrix6& effective, const std::string& about) {
    page();
    text += fmt::format("\n{:>94}\n\n\n\n{:>81}\n{:41}REFERENCE POINT {}\n\n\n",
                        "M O D A L   E F F E C T I V E   M A S S   S U M M A R Y",
                        "TOTAL EFFECTIVE MASS FRACTION", "", about);
    text += fmt::format("{:>26}{:>18}\n{:>31}{:>18}\n\n\n\n\n", "T1", "T2", "9.480000E-01",
                        "1.000000E+00");
    text += fmt::format("{:>77}   \n", "EFFECTIVE MASS MATRIX");
    framed(effective);
    text += fmt::format("\n{:>81}\n", "A-SET RIGID BODY MASS MATRIX");
    framed(D);
    text += "\n";
  }
  /// Of all degrees of freedom, and of the a-set.
  void weight_check(const titop::Matrix6& D, int about) {
    for (const char* set : {"G", "A"}) {
      page();
      text += fmt::format("{:>90}\n0{:>81} = {}       \n0{:>68} ={:9}\n{:>67}\n",
                          "O U T P U T   F R O M   W E I G H T   C H E C K",
                          "DEGREES OF FREEDOM SET", set, "REFERENCE POINT", about, "M O");
      matrix(D);
    }
  }
  void weight(const titop::Matrix6& D, int about) {
    page();
    text += fmt::format(
        "        O U T P U T   F R O M   G R I D   P O I N T   W E I G H T   G E N E R A T O R\n0  "
        "     "
        "                       REFERENCE POINT = {:8}\n                                  M O\n",
        about);
    matrix(D);
    text += "                                  S\n";
    for (int i = 0; i < 3; ++i)
      text += "            *  1.000000E+00  0.000000E+00  0.000000E+00 *\n";
  }
  void echo(const std::vector<std::string>& cards) {
    page();
    text +=
        "0            S O R T E D   B U L K   D A T A   E C H O\n                 ENTRY\n"
        "                 COUNT        .   1  ..   2  ..   3  ..   4  ..   5\n";
    for (std::size_t i = 0; i < cards.size(); ++i)
      text += fmt::format("{:21}-        {:80}\n", i + 1, cards[i]);
    text += "                              ENDDATA\n0                       TOTAL COUNT=   4\n";
  }

 private:
  void grid_rows(const std::vector<std::pair<int, titop::Vector6>>& rows) {
    text +=
        "      POINT ID.   TYPE          T1             T2             T3             R1          "
        "   R2             R3\n";
    for (const auto& [grid, value] : rows) {
      text += fmt::format("{:14}      G   ", grid);
      for (Eigen::Index c = 0; c < 6; ++c) text += "  " + printed(value(c));
      text += "\n";
    }
  }
  void framed(const titop::Matrix6& D) {
    text += fmt::format("{:>26}{:>85}\n", "***", "***");
    matrix(D);
    text += fmt::format("{:>26}{:>85}\n", "***", "***");
  }
  void matrix(const titop::Matrix6& D) {
    for (Eigen::Index i = 0; i < 6; ++i) {
      text += "                      * ";
      for (Eigen::Index j = 0; j < 6; ++j) text += fmt::format("{:13.6E} ", D(i, j));
      text += "*\n";
    }
  }
  int page_ = 0;
};

}  // namespace fe_test
