#include <algorithm>
#include <cmath>
#include <optional>
#include <titop/compiler/certificate/tried_points.hpp>
#include <titop/compiler/solve/evaluate.hpp>
#include <titop/compiler/solve/frequency.hpp>
#include <titop/graph/linalg/index.hpp>

namespace titop::detail {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using linalg::at;
using Complex = std::complex<double>;

constexpr double kFarBelow = 1e-2;  ///< two decades, without a mode between

/// Powers of s by which outputs decrease per decade; true if all are integers and equal to those
/// before: below all modes with an effect.
bool whole_powers(const MatrixXd& here, const MatrixXd& below, MatrixXd& powers) {
  constexpr double kWhole = 0.03;  // a mode a decade off changes a size by some 1 %: 0.004
  const MatrixXd p = (here.array() / below.array()).log10();
  const MatrixXd whole = p.array().round();
  const auto shows = here.array() > kUnderflow && below.array() > kUnderflow;
  const bool same =
      whole.size() == powers.size() &&
      (!shows || ((p - whole).array().abs() < kWhole && (whole - powers).array() == 0)).all();
  powers = whole;
  return same;
}

/// Searches from s downwards for the slowest mode with an effect on the outputs: a row of slow
/// bodies bends more slowly than any single one. None if it cannot be determined: an output is
/// rounding, or the factors have no digits so far below. O(bodies) per decade.
std::optional<Complex> slowest_shown(const Factored& d, const Complex s,
                                     const solve::RowMatrix<Complex>& u,
                                     const std::vector<int>& units) {
  constexpr int kDecades = 10;  // below them double has no digits of slow motion
  try {
    Complex at = s;
    MatrixXd here = by_unit(Evaluation<Complex>(d, at, u).outputs(), units), powers;
    for (int k = 1; k <= kDecades; ++k) {
      at *= 0.1;
      MatrixXd below = by_unit(Evaluation<Complex>(d, at, u).outputs(), units);
      if (whole_powers(here, below, powers)) return 100.0 * at;  // two decades without a mode
      here = std::move(below);
    }
  } catch (const Error&) {
  }
  return {};
}

/// At the assembly's own frequencies as well, if nothing is tried near them.
void add_frequencies(const MatrixXd& A, std::vector<Complex>& list) {
  for (const double w : frequencies_of(A)) {
    const auto near = [w](const Complex s) {
      return std::abs(s) <= kNear * w && w <= kNear * std::abs(s);
    };
    if (std::ranges::none_of(list, near)) list.push_back(off_axis(w));
  }
}

}  // namespace

MatrixXd by_unit(const solve::RowMatrix<Complex>& y, const std::vector<int>& units) {
  MatrixXd result(std::ssize(units), y.cols());
  for (Index i = 0, first = 0; i < result.rows(); first += units[at(i++)])
    result.row(i) = y.middleRows(first, units[at(i)]).cwiseAbs().colwise().maxCoeff();
  return result;
}

Tried tried(const Factored& d, const MatrixXd& A, const solve::RowMatrix<Complex>& u,
            const std::vector<int>& units) {
  const Complex s = pick_s(d);
  if (A.size() == 0) return {{s}};  // the outputs do not depend on s
  Tried result{{kFarBelow * kFarBelow * s, kFarBelow * s, s, s / kFarBelow}};
  add_frequencies(A, result.s);
  double slowest = std::abs(s);
  for (const int i : d.layout().state_nodes)
    if (const double w = frequency_of(d.numbers.blocks[at(i)]->A); w > 0)
      slowest = std::min(slowest, w);
  const Complex of_blocks = slowest / std::abs(s) * s;
  if (slowest < kFarBelow * std::abs(s)) result.s.push_back(kFarBelow * of_blocks);
  const std::optional<Complex> shown = slowest_shown(d, of_blocks, u, units);
  if (!shown) return result;
  result.slowest = std::abs(*shown);
  if (result.slowest < 0.5 * std::abs(s)) result.s.push_back(*shown);
  if (result.slowest < 2 * kFarBelow * std::abs(s)) result.s.push_back(kFarBelow * *shown);
  return result;
}

}  // namespace titop::detail
