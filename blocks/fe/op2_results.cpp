#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <titop/blocks/fe/op2_results.hpp>
#include <titop/graph/error.hpp>

namespace titop::fe {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

namespace {

/// Words of a record; reals of a table have the size of a word.
struct Words {
  const std::string& bytes;
  const detail::WordLayout& layout;

  std::size_t size() const { return bytes.size() / layout.word; }
  long long integer(std::size_t i) const { return layout.integer(&bytes[i * layout.word]); }
  double real(std::size_t i) const {
    return layout.word == 8 ? layout.value<double>(&bytes[8 * i])
                            : static_cast<double>(layout.value<float>(&bytes[4 * i]));
  }
};

[[noreturn]] void refuse(const Op2File& file, const std::string& found, const std::string& hint) {
  throw Error(Code::bad_file, fmt::format("{}: {}", file.name, found), hint);
}

/// The table of one of these names.
const Op2Table& table(const Op2File& file, std::initializer_list<const char*> names,
                      const char* hint) {
  for (const char* name : names)
    for (const Op2Table& t : file.tables)
      if (t.name == name && t.records.size() > 1) return t;
  refuse(file, fmt::format("it has no table {}", *names.begin()), hint);
}

int grid_number(long long number, const Op2File& file) {
  if (number < 1 || number > 2'000'000'000)
    refuse(file, fmt::format("grid {}", number), "numbers of grids are above 0");
  return static_cast<int>(number);
}

double finite(double value, const Op2File& file, const Op2Table& t) {
  if (!std::isfinite(value))
    refuse(file, fmt::format("table {} has {}", t.name, value),
           "let the run end, and write it again");
  return value;
}

constexpr const char* kAskModes =
    "write VECTOR(SORT1,REAL)=ALL in the case control, PARAM,POST,-1 in the bulk data, and run SOL "
    "103";

/// Mode, order, eigenvalue, omega, frequency, generalised mass and stiffness of each mode.
void read_lama(const Op2File& file, Op2Modes& modes) {
  const Op2Table& t = table(file, {"LAMA", "LAMAS", "BLAMA"}, kAskModes);
  if (t.records.size() != 3)
    refuse(file, fmt::format("table {} has {} records", t.name, t.records.size()),
           "one subcase of normal modes has three: run one METHOD in one subcase");
  const Words words{t.records[2], file.layout};
  const auto n = static_cast<Index>(words.size() / 7);
  modes.omega.resize(n), modes.mass.resize(n);
  for (Index k = 0; k < n; ++k) {
    const auto first = 7 * static_cast<std::size_t>(k);
    modes.omega(k) = finite(words.real(first + 3), file, t);
    modes.mass(k) = finite(words.real(first + 5), file, t);
  }
}

/// Ident and data of each mode: 8 words per grid, its number times 10 and a device, a type, and six
/// components.
void read_shapes(const Op2File& file, Op2Modes& modes) {
  const Op2Table& t = table(file, {"OUGV1", "OPHIG", "BOPHIG"}, kAskModes);
  const Index n = modes.omega.size();
  if (static_cast<Index>(t.records.size()) != 1 + 2 * n)
    refuse(file, fmt::format("table {} has {} records for {} modes", t.name, t.records.size(), n),
           kAskModes);
  for (Index k = 0; k < n; ++k) {
    const Words ident{t.records[static_cast<std::size_t>(1 + 2 * k)], file.layout};
    const Words words{t.records[static_cast<std::size_t>(2 + 2 * k)], file.layout};
    if (ident.size() < 10 || ident.integer(9) != 8 || words.size() % 8 != 0)
      refuse(file, fmt::format("table {} has no real shapes of 8 words per grid", t.name),
             kAskModes);
    for (std::size_t i = 0; i < words.size(); i += 8) {
      MatrixXd& shape = modes.shapes[grid_number(words.integer(i) / 10, file)];
      if (shape.size() == 0) shape.setZero(6, n);
      for (Index c = 0; c < 6; ++c)
        shape(c, k) = finite(words.real(i + 2 + static_cast<std::size_t>(c)), file, t);
    }
  }
}

/// A matrix of the modes' rigid-body results.
const Op4Matrix& summary_matrix(const Op2File& file, const std::string& name,
                                const std::string& parent) {
  for (const Op4Matrix& m : file.matrices)
    if (m.name == name) return find_matrix(file.matrices, name);
  refuse(file, fmt::format("it has no matrix {}", name),
         fmt::format("write MEFFMASS(PLOT,GRID={},SUMMARY,PARTFAC,MEFFM,MEFFW,FRACSUM)=YES in the "
                     "case control, and PARAM,POST,-2 in the bulk data",
                     parent));
}

const Grid& find_grid(const std::vector<Grid>& grids, const Op2File& file,
                      const std::string& name) {
  for (const Grid& g : grids)
    if (std::to_string(g.id) == name) return g;
  throw Error(Code::unknown_name, fmt::format("{} has no grid {}", file.name, name),
              "take the number of a GRID");
}

}  // namespace

Op2Modes op2_modes(const Op2File& file) {
  Op2Modes modes;
  read_lama(file, modes);
  read_shapes(file, modes);
  return modes;
}

ModalData op2_modal_data(const Op2File& file, const std::string& parent,
                         const std::vector<std::string>& children) {
  const Op2Modes modes = op2_modes(file);
  const Index n = modes.omega.size();
  const Op4Matrix& D = summary_matrix(file, "RBMASSS", parent);
  const Op4Matrix& L = summary_matrix(file, "MPFACS", parent);
  if (D.value.rows() != 6 || D.value.cols() != 6 || L.value.rows() != 6 || L.value.cols() != n)
    refuse(file,
           fmt::format("RBMASSS is {} x {}, MPFACS {} x {}, for {} modes", D.value.rows(),
                       D.value.cols(), L.value.rows(), L.value.cols(), n),
           "they are 6 x 6 and 6 by the number of modes");
  const VectorXd root = modes.mass.cwiseSqrt();
  if (!(modes.mass.array() > 0).all())
    refuse(file, "a generalised mass in LAMA is not positive", kAskModes);
  const std::vector<Grid> grids = op2_grids(file);
  const Grid& P = find_grid(grids, file, parent);
  ModalData data;
  data.omega = modes.omega;
  data.xi = VectorXd::Zero(n);
  data.L_P = (L.value * root.cwiseInverse().asDiagonal()).transpose();
  data.D_P = D.value;
  data.digits = 7;
  for (const std::string& child : children) {
    const Grid& C = find_grid(grids, file, child);
    const auto shape = modes.shapes.find(C.id);
    if (shape == modes.shapes.end())
      throw Error(Code::unknown_name, fmt::format("{} has no shapes of grid {}", file.name, child),
                  kAskModes);
    const Matrix3d T = C.frame.nominal();
    MatrixXd Phi = shape->second * root.cwiseInverse().asDiagonal();
    Phi.topRows<3>() = (T * Phi.topRows<3>()).eval();
    Phi.bottomRows<3>() = (T * Phi.bottomRows<3>()).eval();
    data.children.push_back({child, C.position - P.position, std::move(Phi)});
  }
  return data;
}

}  // namespace titop::fe
