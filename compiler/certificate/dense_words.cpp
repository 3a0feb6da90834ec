#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <titop/compiler/certificate/dense_check.hpp>
#include <titop/compiler/certificate/residual.hpp>
#include <titop/compiler/definition/compare.hpp>
#include <titop/compiler/solve/factored.hpp>
#include <titop/compiler/solve/layout.hpp>

/// Messages on a dense model: that it belongs to another system, or its errors.
namespace titop::detail {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;

std::string counts(std::size_t states, std::size_t inputs, std::size_t outputs) {
  return fmt::format("{} states, {} inputs and {} outputs", states, inputs, outputs);
}

void refuse_counts(const Factored& d, const StateSpace& m) {
  const Layout& l = d.layout();
  const std::vector<std::string>& states = d.state_names();
  if (m.states.size() == states.size() && m.inputs.size() == l.inputs.size() &&
      m.outputs.size() == l.outputs.size())
    return;
  throw Error(
      Code::size,
      fmt::format("certificate: a model of {} is not one of {}",
                  counts(m.states.size(), m.inputs.size(), m.outputs.size()), d.graph().name),
      fmt::format("pass a model made by System::write: {}; the model of state_space() is in "
                  "dense_certificate()",
                  counts(states.size(), l.inputs.size(), l.outputs.size())));
}

/// The first name that differs.
void compare_names(const char* subject, const std::vector<std::string>& given,
                   const std::vector<std::string>& expected, std::vector<Mistake>& mistakes) {
  const auto [is, should] = std::mismatch(given.begin(), given.end(), expected.begin());
  if (is == given.end()) return;
  mistakes.push_back({Code::size,
                      fmt::format("certificate: {} {} of the model is {}, in this system it is {}",
                                  subject, is - given.begin() + 1, *is, *should),
                      {},
                      "pass a model made by System::write of this system"});
}

void compare_size(const char* subject, const MatrixXd& m, Index rows, Index columns,
                  std::vector<Mistake>& mistakes) {
  if (m.rows() == rows && m.cols() == columns) return;
  mistakes.push_back({Code::size,
                      fmt::format("certificate: {} of the model is {} x {}, by its names it is "
                                  "{} x {}",
                                  subject, m.rows(), m.cols(), rows, columns),
                      {},
                      "pass the model as System::write made it"});
}

/// The first entry that is infinite or no number, by the names of its row and column.
void find_not_finite(const char* subject, const MatrixXd& m, const std::vector<std::string>& rows,
                     const std::vector<std::string>& columns, std::vector<Mistake>& mistakes) {
  for (Index j = 0; j < m.cols(); ++j)
    for (Index i = 0; i < m.rows(); ++i)
      if (!std::isfinite(m(i, j))) {
        mistakes.push_back(
            {Code::not_finite,
             fmt::format("certificate: {} of the model has {} at {}, {}", subject, m(i, j),
                         rows[static_cast<std::size_t>(i)], columns[static_cast<std::size_t>(j)]),
             {},
             "write it again; if System::write made this, take other units, or smaller gains: all "
             "numbers must stay below 1e308"});
        return;
      }
}

void throw_if_any(std::vector<Mistake> mistakes) {
  if (!mistakes.empty()) throw Error(std::move(mistakes));
}

}  // namespace

void require_written(const Factored& d, const StateSpace& m) {
  refuse_counts(d, m);
  std::vector<Mistake> mistakes;
  compare_names("state", m.states, d.state_names(), mistakes);
  compare_names("input", m.inputs, d.layout().inputs, mistakes);
  compare_names("output", m.outputs, d.layout().outputs, mistakes);
  const Index n = std::ssize(m.states), inputs = std::ssize(m.inputs),
              outputs = std::ssize(m.outputs);
  compare_size("A", m.A, n, n, mistakes);
  compare_size("B", m.B, n, inputs, mistakes);
  compare_size("C", m.C, outputs, n, mistakes);
  compare_size("D", m.D, outputs, inputs, mistakes);
  throw_if_any(std::move(mistakes));
  mistakes = {};
  find_not_finite("A", m.A, m.states, m.states, mistakes);
  find_not_finite("B", m.B, m.states, m.inputs, mistakes);
  find_not_finite("C", m.C, m.outputs, m.states, mistakes);
  find_not_finite("D", m.D, m.outputs, m.inputs, mistakes);
  throw_if_any(std::move(mistakes));
}

namespace {

/// "z", or "U(1) to U(3)" of three that share their unit.
std::string name_of_unit(const std::vector<std::string>& names, const std::vector<int>& units,
                         int unit) {
  std::size_t first = 0;
  for (int i = 0; i < unit; ++i)
    first += static_cast<std::size_t>(units[static_cast<std::size_t>(i)]);
  const auto size = static_cast<std::size_t>(units[static_cast<std::size_t>(unit)]);
  return size == 1 ? names[first] : names[first] + " to " + names[first + size - 1];
}

/// "3 digits of y driven by u"
std::string digits_of(const Factored& d, const DenseError::Worst& w) {
  const Measure units = measure(d.graph(), {});
  std::string text = fmt::format("{:.0f} digits", std::max(0.0, -std::log10(w.error)));
  if (w.output >= 0) text += " of " + name_of_unit(d.layout().outputs, units.rows, w.output);
  if (w.input >= 0) text += " driven by " + name_of_unit(d.layout().inputs, units.cols, w.input);
  return text;
}

std::complex<double> lowest(const std::vector<std::complex<double>>& list) {
  return *std::ranges::min_element(list, {}, [](const auto& s) { return std::abs(s); });
}

}  // namespace

void warn_of_lost_digits(const Factored& d, const DenseError& e, std::vector<Note>& notes) {
  const auto warn = [&](const char* text, const DenseError::Worst& w) {
    const std::string s = fmt::format("{:.3g}{:+.3g}j", w.s.real(), w.s.imag());
    notes.push_back({Note::Kind::warning, "dense",
                     fmt::format(fmt::runtime(text), s, digits_of(d, w)) +
                         "; System::transfer keeps all digits"});
  };
  if (e.beside_largest.error > kWarn)
    warn("written as A, B, C, D the model keeps {1} at s = {0}", e.beside_largest);
  // An acceleration far below the modes always loses some digits.
  if (e.where_used.error > kSixDigits &&
      e.where_used.error > kAnotherDigit * e.beside_largest.error)
    warn("at s = {0}, where outputs are small, A, B, C, D keep {1}", e.where_used);
  if (e.not_tried.empty()) return;
  const bool none = e.beside_largest.error < 0;
  notes.push_back({none ? Note::Kind::unchecked : Note::Kind::warning, "dense",
                   fmt::format("the dense model is not compared at {} of the points s, or not in "
                               "all outputs, the lowest |s| = {:.3g}: the factors have no digit "
                               "there in double; transfer uses finer arithmetic",
                               none ? "any" : std::to_string(e.not_tried.size()),
                               std::abs(lowest(e.not_tried)))});
}

}  // namespace titop::detail
