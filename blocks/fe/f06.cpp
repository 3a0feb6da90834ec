#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <titop/blocks/fe/bulk_cards.hpp>
#include <titop/blocks/fe/bulk_data.hpp>
#include <titop/blocks/fe/f06_tables.hpp>
#include <titop/blocks/fe/fortran.hpp>
#include <titop/graph/linalg/rounding.hpp>

namespace titop::fe {

using detail::ByNumber;
using detail::F06Tables;
using Eigen::Index;
using Eigen::MatrixXd;

namespace {

/// Tables by mode become columns.
class F06Assembly {
 public:
  F06Assembly(const TextFile& file, F06Tables tables, FileMistakes& mistakes)
      : file_(file), tables_(std::move(tables)), mistakes_(mistakes) {}

  F06File file() {
    F06File result{.name = file_.name,
                   .about = tables_.about,
                   .rigid = tables_.rigid,
                   .weight = tables_.weight,
                   .bulk = std::move(tables_.bulk),
                   .ends = tables_.ends};
    const auto n = std::ssize(tables_.eigenvalues);
    result.modes.omega.resize(n), result.modes.mass.resize(n);
    for (Index k = 0; const auto& [mode, e] : tables_.eigenvalues) {
      result.modes.numbers.push_back(mode);
      result.modes.omega(k) = e.omega, result.modes.mass(k++) = e.mass;
    }
    result.modes.shapes = shapes();
    result.forces = forces();
    result.factors = of_all_modes(tables_.factors, "MODAL PARTICIPATION FACTORS");
    result.effective = of_all_modes(tables_.effective, "MODAL EFFECTIVE MASS");
    return result;
  }

 private:
  void mistake(const std::string& found, const std::string& expected) {
    mistakes_.add(bad_line(file_, 0, found, expected));
  }

  template <class A, class B>
  static bool same_numbers(const std::map<int, A>& a, const std::map<int, B>& b) {
    return std::ranges::equal(a, b, {}, &std::pair<const int, A>::first,
                              &std::pair<const int, B>::first);
  }

  void put(const ByNumber& values, Index column, std::map<int, MatrixXd>& into) const {
    for (const auto& [grid, value] : values) {
      MatrixXd& all = into[grid];
      if (all.size() == 0) all.setZero(6, std::ssize(tables_.eigenvalues));
      all.col(column) = value;
    }
  }

  std::map<int, MatrixXd> shapes() {
    if (tables_.vectors.empty()) return {};
    if (!same_numbers(tables_.vectors, tables_.eigenvalues))
      mistake(fmt::format("{} eigenvectors for {} eigenvalues", tables_.vectors.size(),
                          tables_.eigenvalues.size()),
              "one for each: VECTOR(SORT1,REAL,PRINT)=ALL");
    const auto& [first, grids] = *tables_.vectors.begin();
    for (const auto& [mode, values] : tables_.vectors)
      if (!same_numbers(values, grids))
        mistake(fmt::format("{} grids in mode {}, {} in mode {}", values.size(), mode, grids.size(),
                            first),
                "the same ones in all modes");
    std::map<int, MatrixXd> result;
    if (mistakes_.empty())
      for (Index k = 0; const auto& [mode, values] : tables_.vectors) put(values, k++, result);
    return result;
  }

  /// Their tables have no number of a mode, but its eigenvalue; a mode without forces has none.
  std::map<int, MatrixXd> forces() {
    std::map<int, MatrixXd> result;
    auto at = tables_.eigenvalues.begin();
    const auto begin = at, end = tables_.eigenvalues.end();
    for (const detail::F06Forces& f : tables_.forces) {
      const auto is_other = [&](double value) {
        return !(std::abs(value - f.eigenvalue) <= linalg::kTextDigits * std::abs(f.eigenvalue));
      };
      while (at != end && is_other(at->second.value)) ++at;
      if (at == end) {
        mistake(fmt::format("support forces of the eigenvalue {:.6e}", f.eigenvalue),
                "those of the real eigenvalues, in their order");
        break;
      }
      put(f.values, std::distance(begin, at++), result);
    }
    return result;
  }

  std::optional<MatrixXd> of_all_modes(const ByNumber& values, const char* table) {
    if (values.empty()) return std::nullopt;
    if (!same_numbers(values, tables_.eigenvalues))
      mistake(fmt::format("{} modes in {}, {} eigenvalues", values.size(), table,
                          tables_.eigenvalues.size()),
              "the same modes in both");
    MatrixXd all(6, std::ssize(values));
    for (Index k = 0; const auto& [mode, value] : values) all.col(k++) = value;
    return all;
  }

  const TextFile& file_;
  F06Tables tables_;
  FileMistakes& mistakes_;
};

TextFile echo_of(const F06File& file) { return {file.name + ", bulk data echo", file.bulk, true}; }

double wtmass(const F06File& file) {
  const TextFile echo = echo_of(file);
  for (const detail::BulkCard& card : detail::bulk_cards(echo)) {
    if (card.name != "PARAM" || card.field(0) != "WTMASS") continue;
    double value = 0;
    if (parse_fortran(card.field(1), value) && value > 0) return value;
    refuse_file(echo.name, fmt::format("PARAM,WTMASS is '{}'", card.field(1)), "a number above 0");
  }
  return 1;
}

/// Case control and parameters with which a run prints these tables.
std::string ask(const std::string& parent = "g") {
  return fmt::format(
      "SOL 103, clamped at one grid {0}; VECTOR(SORT1,REAL,PRINT)=ALL, "
      "SPCFORCES(SORT1,REAL,PRINT)=ALL, MEFFMASS(PRINT,GRID={0},SUMMARY,PARTFAC,MEFFM)=YES in the "
      "case control, PARAM,GRDPNT,{0} in the bulk data",
      parent);
}

constexpr double kSameSquares = 1e-5;  ///< two roundings to seven digits, and that of the square

/// Of modes of mass 1. Their rows in another unit, or of another run, would not fit.
void require_squares(const F06File& file) {
  if (!file.effective) return;
  const MatrixXd off = (file.factors->cwiseAbs2() - *file.effective).cwiseAbs();
  for (Index c = 0; c < 6; ++c)
    for (Index k = 0; k < off.cols(); ++k)
      if (off(c, k) > kSameSquares * file.effective->row(c).cwiseAbs().maxCoeff())
        refuse_file(
            file.name,
            fmt::format("mode {} has the effective mass {:.6e}, its participation factor {:.6e}",
                        file.modes.numbers[static_cast<std::size_t>(k)], (*file.effective)(c, k),
                        (*file.factors)(c, k)),
            "the mass is its square: normalise the modes to MASS, and print one run");
}

/// Vector from P to the grid that a table refers to; the origin for 0.
Vector3d reference(const F06File& file, const std::vector<Grid>& grids, int about) {
  return about == 0 ? Vector3d::Zero().eval()
                    : detail::find_grid(grids, file.name, std::to_string(about)).position;
}

/// Digits of a mass matrix that remain when it is moved by tau: those of its largest entries of
/// inertia, which may cancel.
double digits_left(const Matrix6& D, const Matrix6& moved, const Matrix6& T) {
  const Matrix6 terms = T.cwiseAbs().transpose() * D.cwiseAbs() * T.cwiseAbs();
  const double before = terms.diagonal().tail<3>().maxCoeff();
  const double after = moved.diagonal().tail<3>().maxCoeff();
  return after > 0 ? 7 - std::max(0.0, std::log10(before / after)) : 7;
}

}  // namespace

F06File read_f06(const std::filesystem::path& path) {
  const TextFile file = read_text(path);
  require_text(file);
  FileMistakes mistakes;
  F06Tables tables = detail::f06_tables(file, mistakes);
  if (tables.eigenvalues.empty())
    mistakes.add(bad_line(file, 0, "no REAL EIGENVALUES",
                          "a normal modes analysis, which prints them: METHOD=n in SOL 103"));
  mistakes.finish();
  F06File result = F06Assembly(file, std::move(tables), mistakes).file();
  mistakes.finish();
  result.wtmass = wtmass(result);
  return result;
}

std::vector<Grid> f06_grids(const F06File& file) {
  if (file.bulk.empty())
    refuse_file(
        file.name, "it has no positions of its grids",
        "give its bulk data (ImportOptions::grids; titop import --grids FILE.bdf), or print them: "
        "ECHO=SORT in the case control");
  return detail::grids_in(echo_of(file));
}

std::vector<std::string> f06_missing(const F06File& file) {
  std::vector<std::string> missing;
  const auto need = [&](bool there, const char* table) {
    if (!there) missing.emplace_back(table);
  };
  need(!file.modes.shapes.empty(), "REAL EIGENVECTOR, which VECTOR(PRINT)=ALL prints");
  need(file.factors.has_value(), "MODAL PARTICIPATION FACTORS, which MEFFMASS(PARTFAC)=YES prints");
  need(file.rigid || file.weight,
       "A-SET RIGID BODY MASS MATRIX, which MEFFMASS(SUMMARY)=YES prints");
  need(!file.forces.empty(),
       "FORCES OF SINGLE-POINT CONSTRAINT, which SPCFORCES(PRINT)=ALL prints");
  return missing;
}

ModalData f06_modal_data(const F06File& file, const std::vector<Grid>& grids,
                         const std::string& parent, const std::vector<std::string>& children) {
  if (const auto missing = f06_missing(file); !missing.empty())
    refuse_file(file.name, "it has no table " + missing[0], ask(parent));
  require_squares(file);
  detail::ClampedRun run{.file = file.name,
                         .modes = file.modes,
                         .forces = file.forces,
                         .grids = grids,
                         .ask = ask(parent)};
  const Vector3d P = detail::find_grid(grids, file.name, parent).position;
  const F06Mass& D = file.rigid ? *file.rigid : *file.weight;
  const Matrix6 to_P = tau(P - reference(file, grids, D.about));
  const Matrix6 mass = (file.rigid ? 1 : file.wtmass) * detail::symmetric_mass(D.value, file.name);
  run.D = to_P.transpose() * mass * to_P;
  run.L = tau(P - reference(file, grids, file.about)).transpose() * *file.factors;
  run.digits = digits_left(mass, run.D, to_P);
  if (run.digits < 1)
    refuse_file(
        file.name,
        fmt::format("moved to grid {}, its rigid mass has {:.1f} digits", parent, run.digits),
        ask(parent));
  return detail::clamped_modal_data(run, parent, children);
}

}  // namespace titop::fe
