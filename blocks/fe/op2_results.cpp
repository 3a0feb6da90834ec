#include <fmt/format.h>

#include <cmath>
#include <titop/blocks/fe/op2_results.hpp>
#include <titop/blocks/fe/text_file.hpp>
#include <titop/graph/support/some_names.hpp>

namespace titop::fe {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

namespace {

/// Words of a record; reals of a table have the size of a word.
struct RecordWords {
  const std::string& bytes;
  const detail::WordLayout& layout;

  std::size_t size() const { return bytes.size() / layout.word; }
  long long integer(std::size_t i) const { return layout.integer(&bytes[i * layout.word]); }
  double real(std::size_t i) const {
    return layout.word == 8 ? layout.value<double>(&bytes[8 * i])
                            : static_cast<double>(layout.value<float>(&bytes[4 * i]));
  }
};

/// Case control and parameters with which a run writes these tables.
std::string ask(const std::string& parent = "g") {
  return fmt::format(
      "SOL 103, clamped at one grid {0}; VECTOR(SORT1,REAL)=ALL, SPCFORCES(SORT1,REAL)=ALL, "
      "MEFFMASS(PLOT,GRID={0},SUMMARY,PARTFAC)=YES in the case control, PARAM,POST,-2 and "
      "PARAM,POSTEXT,YES in the bulk data",
      parent);
}

template <class T>
std::string names(const std::vector<T>& all) {
  std::vector<std::string> names;
  for (const T& one : all) names.push_back(one.name);
  return names.empty() ? "none" : titop::detail::some_names(names);
}

/// The only table of this name.
const Op2Table& table(const Op2File& file, const std::string& name) {
  const Op2Table* found = nullptr;
  for (const Op2Table& t : file.tables) {
    if (t.name != name || t.records.size() < 2) continue;
    if (found)
      refuse_file(file.name, fmt::format("it has several tables {}", name),
                  "run one METHOD in one subcase, and write it to a file of its own");
    found = &t;
  }
  if (!found)
    refuse_file(file.name, fmt::format("it has no table {}, but {}", name, names(file.tables)),
                ask());
  return *found;
}

int grid_number(long long number, const Op2File& file) {
  if (number < 1 || number > 2'000'000'000)
    refuse_file(file.name, fmt::format("grid {}", number), "numbers of grids are above 0");
  return static_cast<int>(number);
}

double finite(double value, const Op2File& file, const Op2Table& t) {
  if (!std::isfinite(value))
    refuse_file(file.name, fmt::format("table {} has {}", t.name, value),
                "let the run end, and write it again");
  return value;
}

/// Mode, order, eigenvalue, omega, frequency, generalised mass and stiffness of each mode. Returns
/// the numbers of the modes.
std::vector<long long> read_lama(const Op2File& file, NormalModes& modes) {
  const Op2Table& t = table(file, "LAMA");
  if (t.records.size() != 3)
    refuse_file(file.name, fmt::format("table {} has {} records", t.name, t.records.size()),
                "one subcase of normal modes has three: run one METHOD in one subcase");
  const RecordWords words{t.records[2], file.layout};
  if (words.size() % 7 != 0)
    refuse_file(file.name, fmt::format("table {} has {} words", t.name, words.size()),
                "7 for each mode");
  const auto n = static_cast<Index>(words.size() / 7);
  modes.omega.resize(n), modes.mass.resize(n);
  std::vector<long long> numbers;
  for (Index k = 0; k < n; ++k) {
    const auto first = 7 * static_cast<std::size_t>(k);
    numbers.push_back(words.integer(first));
    modes.omega(k) = finite(words.real(first + 3), file, t);
    modes.mass(k) = finite(words.real(first + 5), file, t);
  }
  return numbers;
}

constexpr long long kEigenvectors = 7, kSupportForces = 3;  ///< codes of tables

/// Approach 2 (real eigenvalues), with a device as last digit; code of the table, which tells also
/// SORT2 and complex data; mode; words per grid.
void check_ident(const Op2File& file, const Op2Table& t, const RecordWords& ident, long long code,
                 long long mode) {
  if (ident.size() < 10 || ident.integer(0) / 10 != 2 || ident.integer(1) != code ||
      ident.integer(9) != 8)
    refuse_file(file.name,
                fmt::format("table {} has no real values of modes, 8 words per grid", t.name),
                ask());
  if (ident.integer(4) != mode)
    refuse_file(
        file.name,
        fmt::format("table {} has mode {} where LAMA has {}", t.name, ident.integer(4), mode),
        ask());
}

/// Six components by grid, a column per mode. Ident and data of each mode: 8 words per point, its
/// number times 10 and a device, its type (1 for a grid, 2 for a scalar point), the components.
std::map<int, MatrixXd> values_at_grids(const Op2File& file, const std::string& name,
                                        long long code, const std::vector<long long>& modes) {
  const Op2Table& t = table(file, name);
  if (t.records.size() != 1 + 2 * modes.size())
    refuse_file(
        file.name,
        fmt::format("table {} has {} records for {} modes", name, t.records.size(), modes.size()),
        ask());
  std::map<int, MatrixXd> values;
  for (std::size_t k = 0; k < modes.size(); ++k) {
    check_ident(file, t, {t.records[1 + 2 * k], file.layout}, code, modes[k]);
    const RecordWords words{t.records[2 + 2 * k], file.layout};
    if (words.size() % 8 != 0)
      refuse_file(file.name, fmt::format("table {} has {} words in a mode", name, words.size()),
                  "8 for each grid");
    for (std::size_t i = 0; i < words.size(); i += 8) {
      if (words.integer(i + 1) != 1) continue;
      MatrixXd& value = values[grid_number(words.integer(i) / 10, file)];
      if (value.size() == 0) value.setZero(6, std::ssize(modes));
      for (Index c = 0; c < 6; ++c)
        value(c, static_cast<Index>(k)) =
            finite(words.real(i + 2 + static_cast<std::size_t>(c)), file, t);
    }
  }
  return values;
}

/// A matrix of the modes' rigid-body results.
const Op4Matrix& summary_matrix(const Op2File& file, const std::string& name,
                                const std::string& parent) {
  for (const Op4Matrix& m : file.matrices)
    if (m.name == name) return find_matrix(file.matrices, name);
  refuse_file(file.name, fmt::format("it has no matrix {}, but {}", name, names(file.matrices)),
              ask(parent));
}

}  // namespace

NormalModes op2_modes(const Op2File& file) {
  NormalModes modes;
  modes.numbers = read_lama(file, modes);
  modes.shapes = values_at_grids(file, "OUGV1", kEigenvectors, modes.numbers);
  return modes;
}

ModalData op2_modal_data(const Op2File& file, const std::string& parent,
                         const std::vector<std::string>& children) {
  detail::ClampedRun run{
      .file = file.name, .modes = op2_modes(file), .grids = op2_grids(file), .ask = ask(parent)};
  const Index n = run.modes.omega.size();
  detail::require_at_rest(run.modes, file.name, detail::find_grid(run.grids, file.name, parent));
  const Op4Matrix& D = summary_matrix(file, "RBMASSS", parent);
  const Op4Matrix& L = summary_matrix(file, "MPFACS", parent);
  if (D.value.rows() != 6 || D.value.cols() != 6 || L.value.rows() != 6 || L.value.cols() != n)
    refuse_file(file.name,
                fmt::format("RBMASSS is {} x {}, MPFACS {} x {}, for {} modes", D.value.rows(),
                            D.value.cols(), L.value.rows(), L.value.cols(), n),
                "they are 6 x 6 and 6 by the number of modes");
  run.D = detail::symmetric_mass(D.value, file.name);
  run.L = L.value;
  run.forces = values_at_grids(file, "OQG1", kSupportForces, run.modes.numbers);
  return detail::clamped_modal_data(run, parent, children);
}

}  // namespace titop::fe
