#pragma once

#include <array>
#include <complex>
#include <string>
#include <titop/titop.hpp>

/// Rows of equal masses in which waves decay: the effect of elimination on one front is harmless,
/// its product along the row is not. Against the recursion of the row's own dynamic stiffness in 50
/// digits, without a line of the library.
namespace titop_test {

struct LossyRow {
  enum class Base { held, free };
  enum class Tip { force, motion };

  int n;
  double damping;  ///< N s/m of each spring, beside 10 N/m and 1 kg
  Base base;
  Tip tip;

  /// Inputs: the force on the tip, or its acceleration. Outputs: "base", the force on the wall or
  /// the acceleration of the free base of 2 kg; "tip", the other one of the tip's two.
  titop::Diagram diagram() const;
  /// The same; the damping is a parameter of this name.
  titop::Diagram diagram(const std::string& damping_name) const;
};

/// The four pairs of prescribed quantities at the base and the tip, with this length and damping.
std::array<LossyRow, 4> lossy_rows(int n, double damping);

/// Transfers of a row asked for, and how many of them were wrong or refused as singular.
struct LossyRowCount {
  int tried = 0, wrong = 0, refused = 0;

  /// Right: both outputs to 1e-8 of themselves, or to 1e-12 of the largest of their terms; below
  /// 1e-290 numbers have not all their digits.
  void ask(const titop::System& system, const LossyRow& row, std::complex<double> s,
           titop::Precision precision = titop::Precision::as_needed);
  /// Of a transfer found in another way.
  void judge(const Eigen::MatrixXcd& found, const LossyRow& row, std::complex<double> s);
};

}  // namespace titop_test
