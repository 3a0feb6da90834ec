#include <fmt/format.h>

#include <cmath>
#include <titop/emit/cpp/header.hpp>
#include <titop/emit/text/literals.hpp>

namespace titop::emit {

using Eigen::Index;
using Eigen::MatrixXd;

namespace {

enum class StorageFormat { none, dense, sparse, blocks };

Index nonzeros(const MatrixXd& m) { return (m.array() != 0).count(); }

bool is_tridiagonal(const MatrixXd& m) {
  for (Index j = 0; j < m.cols(); ++j)
    for (Index i = 0; i < m.rows(); ++i)
      if (std::abs(i - j) > 1 && m(i, j) != 0) return false;
  return m.rows() == m.cols();
}

/// The cheapest: an entry of a sparse matrix costs about two of a dense one, which go by vectors.
StorageFormat storage(const MatrixXd& m) {
  const Index count = nonzeros(m);
  if (count == 0) return StorageFormat::none;
  const bool blocks = m.rows() > 2 && is_tridiagonal(m);
  if (blocks && 3 * m.rows() < std::min(m.size(), 2 * count)) return StorageFormat::blocks;
  return 2 * count < m.size() ? StorageFormat::sparse : StorageFormat::dense;
}

long long products(const MatrixXd& m) {
  switch (storage(m)) {
    case StorageFormat::none: return 0;
    case StorageFormat::dense: return m.size();
    case StorageFormat::sparse: return nonzeros(m);
    case StorageFormat::blocks: return 3 * m.rows();
  }
  return 0;
}

std::string dense(const MatrixXd& m, const std::string& name) {
  std::string text = fmt::format("inline constexpr Dense<{}, {}> {}{{{{", m.rows(), m.cols(), name);
  for (Index j = 0; j < m.cols(); ++j)
    text += fmt::format("{}\n    {}", j > 0 ? "," : "", list(m.col(j), 5));
  return text + "}};\n";
}

std::string sparse(const MatrixXd& m, const std::string& name) {
  std::vector<std::string> start{"0"}, column, value;
  for (Index i = 0; i < m.rows(); ++i) {
    for (Index j = 0; j < m.cols(); ++j)
      if (m(i, j) != 0) {
        column.push_back(std::to_string(j));
        value.push_back(number(m(i, j)));
      }
    start.push_back(std::to_string(value.size()));
  }
  return fmt::format("inline constexpr Sparse<{}, {}> {}{{\n    {},\n    {},\n    {}}};\n",
                     m.rows(), value.size(), name, list(start, 5), list(column, 5), list(value, 5));
}

std::string blocks(const MatrixXd& m, const std::string& name) {
  const Index n = m.rows();
  Eigen::VectorXd below = Eigen::VectorXd::Zero(n), above = below;
  below.tail(n - 1) = m.diagonal(-1);
  above.head(n - 1) = m.diagonal(1);
  return fmt::format("inline constexpr Blocks<{}> {}{{\n    {},\n    {},\n    {}}};\n", n, name,
                     list(below, 5), list(m.diagonal(), 5), list(above, 5));
}

const char* const kDense = R"(
/// By columns: y += m x runs down them, in vectors.
template <std::size_t rows, std::size_t columns>
struct Dense {
  double column[columns][rows];
};
template <std::size_t rows, std::size_t columns, class X, class Y>
constexpr void add(const Dense<rows, columns>& m, const X& x, Y& y) {
  for (std::size_t j = 0; j < columns; ++j)
    for (std::size_t i = 0; i < rows; ++i) y[i] += m.column[j][i] * x[j];
}
)";

const char* const kSparse = R"(
/// By rows: entries start[i] to start[i + 1] belong to row i.
template <std::size_t rows, std::size_t entries>
struct Sparse {
  std::size_t start[rows + 1];
  std::size_t column[entries];
  double value[entries];
};
template <std::size_t rows, std::size_t entries, class X, class Y>
constexpr void add(const Sparse<rows, entries>& m, const X& x, Y& y) {
  for (std::size_t i = 0; i < rows; ++i) {
    double sum = y[i];
    for (std::size_t k = m.start[i]; k < m.start[i + 1]; ++k) sum += m.value[k] * x[m.column[k]];
    y[i] = sum;
  }
}
)";

const char* const kBlocks = R"(
/// Three diagonals: blocks of 1 x 1 and 2 x 2.
template <std::size_t n>
struct Blocks {
  double below[n], at[n], above[n];
};
template <std::size_t n, class X, class Y>
constexpr void add(const Blocks<n>& m, const X& x, Y& y) {
  y[0] += m.at[0] * x[0] + m.above[0] * x[1];
  for (std::size_t i = 1; i + 1 < n; ++i)
    y[i] += m.below[i] * x[i - 1] + m.at[i] * x[i] + m.above[i] * x[i + 1];
  y[n - 1] += m.below[n - 1] * x[n - 2] + m.at[n - 1] * x[n - 1];
}
)";

/// The matrices with their names in the order of use, and which kinds of storage they take.
struct Data {
  std::string text;
  bool kinds[4] = {};

  void add(const MatrixXd& m, const std::string& name) {
    const StorageFormat kind = storage(m);
    kinds[static_cast<int>(kind)] = true;
    if (kind == StorageFormat::dense) text += dense(m, name);
    if (kind == StorageFormat::sparse) text += sparse(m, name);
    if (kind == StorageFormat::blocks) text += blocks(m, name);
  }
  std::string all() const {
    std::string result;
    if (kinds[static_cast<int>(StorageFormat::dense)]) result += kDense;
    if (kinds[static_cast<int>(StorageFormat::sparse)]) result += kSparse;
    if (kinds[static_cast<int>(StorageFormat::blocks)]) result += kBlocks;
    return result + "\n" + text;
  }
};

/// "State step(const State& x, const Input& u)" that adds M x and N u, each if it is not zero.
std::string function(const std::string& head, const std::string& type, const MatrixXd& M,
                     const char* M_name, const MatrixXd& N, const char* N_name) {
  const bool x = nonzeros(M) > 0, u = nonzeros(N) > 0;
  std::string text = fmt::format("constexpr {} {}(const State& {}, const Input& {}) {{\n", type,
                                 head, x ? "x" : "/*x*/", u ? "u" : "/*u*/");
  text += fmt::format("  {} y{{}};\n", type);
  if (x) text += fmt::format("  detail::add(detail::{}, x, y);\n", M_name);
  if (u) text += fmt::format("  detail::add(detail::{}, u, y);\n", N_name);
  return text + "  return y;\n}\n";
}

std::string positions(const std::vector<std::string>& names) {
  std::string text;
  const std::vector<std::string> words = identifiers(names);
  for (std::size_t i = 0; i < words.size(); ++i)
    text += fmt::format("inline constexpr std::size_t {} = {};\n", words[i], i);
  return text;
}

std::string texts(const std::vector<std::string>& names) {
  std::vector<std::string> items;
  for (const std::string& name : names) items.push_back(emit::quoted(name));
  return list(items, 4);
}

const char* const kHeader = R"(// Written by titop from the diagram @DIAGRAM@; do not edit.
// @SIZES@
// State: @COORDINATES@
// Multiplications: @COST@
// @ERROR@
#pragma once

#include <array>
#include <cstddef>

namespace @NAME@ {

inline constexpr std::size_t n_states = @N@, n_inputs = @NU@, n_outputs = @NY@;
using State = std::array<double, n_states>;
using Input = std::array<double, n_inputs>;
using Output = std::array<double, n_outputs>;

/// Positions by name: u[in::...], y[out::...], @STATE_POSITIONS@[state::...].
namespace in {
@IN@}  // namespace in
namespace out {
@OUT@}  // namespace out
namespace state {
@STATE@}  // namespace state

/// The names as the diagram has them.
inline constexpr std::array<const char*, n_inputs> input_names@INPUT_NAMES@;
inline constexpr std::array<const char*, n_outputs> output_names@OUTPUT_NAMES@;
inline constexpr std::array<const char*, n_states> state_names@STATE_NAMES@;

namespace detail {
@DATA@
}  // namespace detail

/// xdot of x and u.
@DERIVATIVE@
/// y of x and u.
@OUTPUT@@STEP@@MODES@
}  // namespace @NAME@
)";

/// The measured errors, as the header's comment.
std::string errors(const Naming& names, const ModelForm& form) {
  if (names.inputs.empty() || names.outputs.empty())
    return "Its accuracy was not measured: there are no inputs or no outputs.";
  std::string text = fmt::format(
      "Transfer within {:.1e} of the diagram's own equations at the points of {}_test.cpp\n"
      "// (worst entry over the largest of its row and column).",
      form.error, names.name);
  if (names.sample_time > 0)
    text += fmt::format("\n// Trajectory by step within {:.1e} of long double's.", form.step_error);
  return text;
}

std::string step_function(const Naming& names, const ModelForm& form) {
  if (names.sample_time == 0) return {};
  return fmt::format(
             "\n/// [s]\ninline constexpr double sample_time = {};\n\n"
             "/// x at t + sample_time, exact for u held from t on.\n",
             number(names.sample_time)) +
         function("step", "State", form.A_h, "A_h", form.B_h, "B_h");
}

std::string mode_functions(const ModelForm& form) {
  if (!form.modal) return {};
  return R"(
/// The model's own states, by their names, from x, and x from them.
using ModelState = std::array<double, n_states>;
constexpr ModelState to_states(const State& x) {
  ModelState own{};
  detail::add(detail::to_states, x, own);
  return own;
}
constexpr State from_states(const ModelState& own) {
  State x{};
  detail::add(detail::from_states, own, x);
  return x;
}
)";
}

std::string matrix_data(const ModelForm& form) {
  Data data;
  data.add(form.A, "A");
  data.add(form.B, "B");
  data.add(form.C, "C");
  data.add(form.D, "D");
  if (form.A_h.size() > 0) data.add(form.A_h, "A_h");
  if (form.B_h.size() > 0) data.add(form.B_h, "B_h");
  if (form.modal) data.add(form.to_states, "to_states");
  if (form.modal) data.add(form.from_states, "from_states");
  return data.all();
}

std::string cost(const ModelForm& form) {
  std::string text = fmt::format("derivative {}, output {}", products(form.A) + products(form.B),
                                 products(form.C) + products(form.D));
  if (form.A_h.size() > 0)
    text += fmt::format(", step {}", products(form.A_h) + products(form.B_h));
  return text;
}

}  // namespace

long long products(const ModelForm& form) {
  return products(form.A) + products(form.B) + products(form.C) + products(form.D) +
         products(form.A_h) + products(form.B_h);
}

std::string header_text(const Naming& names, const ModelForm& form) {
  const auto count = [](std::size_t n, const char* subject) {
    return fmt::format("{} {}{}", n, subject, n == 1 ? "" : "s");
  };
  return filled(
      kHeader,
      {{"DIAGRAM", emit::quoted(names.diagram)},
       {"SIZES",
        fmt::format("{}, {}, {}.", count(names.states.size(), "state"),
                    count(names.inputs.size(), "input"), count(names.outputs.size(), "output"))},
       {"COORDINATES", form.modal ? "modes, A in blocks of 1 x 1 and 2 x 2; to_states(x) gives the "
                                    "model's own."
                                  : "the model's own, by name."},
       {"COST", cost(form)},
       {"ERROR", errors(names, form)},
       {"NAME", names.name},
       {"N", std::to_string(names.states.size())},
       {"NU", std::to_string(names.inputs.size())},
       {"NY", std::to_string(names.outputs.size())},
       {"STATE_POSITIONS", form.modal ? "to_states(x)" : "x"},
       {"IN", positions(names.inputs)},
       {"OUT", positions(names.outputs)},
       {"STATE", positions(names.states)},
       {"INPUT_NAMES", texts(names.inputs)},
       {"OUTPUT_NAMES", texts(names.outputs)},
       {"STATE_NAMES", texts(names.states)},
       {"DATA", matrix_data(form)},
       {"DERIVATIVE", function("derivative", "State", form.A, "A", form.B, "B")},
       {"OUTPUT", function("output", "Output", form.C, "C", form.D, "D")},
       {"STEP", step_function(names, form)},
       {"MODES", mode_functions(form)}});
}

}  // namespace titop::emit
