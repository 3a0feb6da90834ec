#include <fmt/format.h>

#include <algorithm>
#include <titop/graph/error.hpp>
#include <titop/graph/linalg/dense.hpp>
#include <titop/graph/linalg/rounding.hpp>
#include <titop/graph/pole.hpp>
#include <titop/graph/state_space.hpp>

namespace titop {
namespace {

/// Limit for A with scaled entries: below it rounding decides whether A is singular, as its entries
/// may be off by some units in the last place. (A spring of 1e-12 with one of 1 has 1e-12, the
/// static bending of a row of 20 beams 4e-13.)
constexpr double kSingular = 10 * linalg::kEpsilon;

/// At s = 0, where many systems have exact poles, a pivot at rounding level counts as a pole. (At
/// another s a pivot that small may be correct: two dozen integrators in a row.)
bool pole_at_zero(const linalg::Solution& x) {
  return x.rcond < kSingular || x.moved > linalg::kOneDigit;
}

}  // namespace

void require_fitting(const StateSpace& m, const std::string& user) {
  const Eigen::Index n = m.A.rows(), nu = m.B.cols(), ny = m.C.rows();
  std::vector<Mistake> mistakes;
  const auto compare = [&](const char* subject, const Eigen::MatrixXd& entries, Eigen::Index rows,
                           Eigen::Index columns) {
    if (entries.rows() == rows && entries.cols() == columns) return;
    mistakes.push_back({Code::size,
                        fmt::format("{}: {} of the model is {} x {}, beside the others {} x {}",
                                    user, subject, entries.rows(), entries.cols(), rows, columns),
                        {},
                        "A is n x n, B n x nu, C ny x n, D ny x nu"});
  };
  compare("A", m.A, n, n);
  compare("B", m.B, n, nu);
  compare("C", m.C, ny, n);
  compare("D", m.D, ny, nu);
  if (!mistakes.empty()) throw Error(std::move(mistakes));
}

void require_names(const StateSpace& m, const std::string& user) {
  if (std::ssize(m.inputs) == m.B.cols() && std::ssize(m.outputs) == m.C.rows()) return;
  throw Error(Code::size,
              fmt::format("{}: the model has {} inputs and {} outputs, and names of {} and {}",
                          user, m.B.cols(), m.C.rows(), m.inputs.size(), m.outputs.size()),
              "fill StateSpace::inputs and StateSpace::outputs: one name for each");
}

Eigen::MatrixXcd StateSpace::transfer(std::complex<double> s) const {
  check_finite(s, "the model");
  require_fitting(*this, "transfer");
  const auto n = A.rows();
  if (n == 0) return D.cast<std::complex<double>>();
  const linalg::Solution x =
      linalg::solve(s * Eigen::MatrixXcd::Identity(n, n) - A, B.cast<std::complex<double>>());
  if (!(x.rcond > 0) || !x.z.allFinite() || (s == 0.0 && pole_at_zero(x)))
    throw Error(Code::singular, fmt::format("s = {}{:+}j is a pole", s.real(), s.imag()),
                "evaluate at another s");
  return C * x.z + D;
}

namespace {

void print(std::string& text, std::string_view title, const Eigen::MatrixXd& m,
           const std::vector<std::string>& rows, const std::vector<std::string>& cols) {
  constexpr std::size_t most = 8;
  const std::size_t nr = std::min(rows.size(), most), nc = std::min(cols.size(), most);
  text += fmt::format("{} ({} x {})\n{:>20}", title, rows.size(), cols.size(), "");
  for (std::size_t j = 0; j < nc; ++j) text += fmt::format(" {:>14.14}", cols[j]);
  text += cols.size() > nc ? "  ...\n" : "\n";
  for (std::size_t i = 0; i < nr; ++i) {
    text += fmt::format("{:>20.20}", rows[i]);
    for (std::size_t j = 0; j < nc; ++j)
      text += fmt::format(" {:>14.7g}",
                          m(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(j)) + 0.0);
    text += "\n";
  }
  if (rows.size() > nr) text += fmt::format("{:>20} {} more rows\n", "...", rows.size() - nr);
}

}  // namespace

int position_of(const std::vector<std::string>& names, const std::string& name,
                std::string_view subject) {
  const auto it = std::find(names.begin(), names.end(), name);
  if (it != names.end()) return static_cast<int>(it - names.begin());
  std::string all;
  for (std::size_t i = 0; i < names.size() && i < 12; ++i) all += (i ? ", " : "") + names[i];
  if (names.size() > 12) all += ", ...";
  throw Error(Code::unknown_name, fmt::format("the model has no {} \"{}\"", subject, name),
              fmt::format("its {}s are: {}", subject, all));
}

int StateSpace::output(const std::string& name) const {
  return position_of(outputs, name, "output");
}
int StateSpace::input(const std::string& name) const { return position_of(inputs, name, "input"); }
int StateSpace::state(const std::string& name) const { return position_of(states, name, "state"); }

int unit_entry(const Eigen::MatrixXd& A, Eigen::Index row) {
  Eigen::Index entry = -1, count = 0;
  for (Eigen::Index j = 0; j < A.cols() && count < 2; ++j)
    if (A(row, j) != 0) ++count, entry = j;
  return count == 1 && entry != row && A(row, entry) == 1 ? static_cast<int>(entry) : -1;
}

std::vector<int> rates_of(const StateSpace& m) {
  const bool known = std::ssize(m.rates) == m.A.rows() && m.states.size() == m.rates.size();
  std::vector<int> result;
  for (Eigen::Index i = 0; i < m.A.rows(); ++i) {
    const auto state = static_cast<std::size_t>(i);
    const int entry = known && m.rates[state].empty() ? -1 : unit_entry(m.A, i);
    const bool other =
        known && entry >= 0 && m.rates[state] != m.states[static_cast<std::size_t>(entry)];
    result.push_back(other ? -1 : entry);
  }
  return result;
}

std::string to_string(const StateSpace& m) {
  std::string text = fmt::format("{} states, {} inputs, {} outputs\n", m.states.size(),
                                 m.inputs.size(), m.outputs.size());
  if (m.order() > 0) print(text, "A", m.A, m.states, m.states);
  if (m.order() > 0 && !m.inputs.empty()) print(text, "B", m.B, m.states, m.inputs);
  if (m.order() > 0 && !m.outputs.empty()) print(text, "C", m.C, m.outputs, m.states);
  if (!m.inputs.empty() && !m.outputs.empty()) print(text, "D", m.D, m.outputs, m.inputs);
  return text;
}

}  // namespace titop
