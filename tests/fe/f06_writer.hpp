#pragma once

#include <fmt/format.h>

#include <Eigen/Core>
#include <string>
#include <titop/graph/linalg/kinematics.hpp>
#include <vector>

/// Tables as Nastran prints them: the first column controls the printer, pages have three lines of
/// titles, numbers seven digits.
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
  /// 6 x N, each mode a row.
  void by_mode(const std::string& title, const Eigen::VectorXd& omega,
               const Eigen::MatrixXd& values) {
    page();
    text += fmt::format(
        "0{:>80}\n   MODE     FREQUENCY            T1                T2                T3          "
        " "
        "     R1                R2                R3\n    NO.\n",
        title);
    for (Eigen::Index k = 0; k < omega.size(); ++k) {
      text += fmt::format("{:9}   {:13.6E}    ", k + 1, omega(k) / (2 * EIGEN_PI));
      for (Eigen::Index c = 0; c < 6; ++c) text += fmt::format("{:13.6E}     ", values(c, k));
      text += "\n";
    }
  }
  /// "AT ORIGIN OF BASIC COORDINATE SYSTEM", "AT GRID 4".
  void rigid(const titop::Matrix6& D, const std::string& about) {
    page();
    text += fmt::format(
        "0   M O D A L   E F F E C T I V E   M A S S   S U M M A R Y\n      TOTAL EFFECTIVE MASS "
        "FRACTION\n      REFERENCE POINT {}\n        T1     T2\n  9.480000E-01  1.0\n      A-SET "
        "RIGID "
        "BODY MASS MATRIX\n  ***                       ***\n",
        about);
    matrix(D);
    text += "  ***                       ***\n";
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
