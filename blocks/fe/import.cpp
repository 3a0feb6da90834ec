#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <functional>
#include <titop/blocks/fe/bulk_data.hpp>
#include <titop/blocks/fe/calculix.hpp>
#include <titop/blocks/fe/dmig.hpp>
#include <titop/blocks/fe/f06.hpp>
#include <titop/blocks/fe/file_kind.hpp>
#include <titop/blocks/fe/import.hpp>
#include <titop/blocks/fe/import_mesh.hpp>
#include <titop/blocks/fe/import_options.hpp>
#include <titop/blocks/fe/mat.hpp>
#include <titop/blocks/fe/mesh_checks.hpp>
#include <titop/blocks/fe/modal_checks.hpp>
#include <titop/blocks/fe/modal_csv.hpp>
#include <titop/blocks/fe/op2_results.hpp>
#include <titop/blocks/fe/op4.hpp>
#include <titop/graph/support/some_names.hpp>
#include <utility>

namespace titop::fe {

namespace {

namespace fs = std::filesystem;

using Names = std::vector<std::string>;

/// Bulk data of a run, beside its f06.
const std::vector<const char*> kBulkFiles = {".asm", ".bdf", ".dat", ".nas"};

/// One import; `result.text` lists the contents of the file.
class Importer {
 public:
  Importer(const fs::path& file, const ImportOptions& options) : file_(file), options_(options) {}

  Import run() {
    switch (kind_of_file(file_)) {
      case FileKind::op4: use(six_rows_each(op4())); break;
      case FileKind::mat: use(six_rows_each(read_mat(file_))); break;
      case FileKind::dmig: use(grids_of_dmig()); break;
      case FileKind::calculix: use(calculix()); break;
      case FileKind::modal_csv: modal_data_alone(); break;
      case FileKind::op2: op2(); break;
      case FileKind::f06: f06(); break;
    }
    for (const std::string& port : result_.ports) ports_ += (ports_.empty() ? "" : ", ") + port;
    result_.text += fmt::format("ports: {}\n", ports_.empty() ? "none" : ports_);
    return std::move(result_);
  }

 private:
  template <class... T>
  void tell(fmt::format_string<T...> text, T&&... values) {
    result_.text += fmt::format(text, std::forward<T>(values)...) + "\n";
  }

  std::string name() const { return file_.filename().string(); }

  void refuse(const TakenOptions& taken) const { refuse_others(options_, taken, name()); }

  /// The one that is given, or one of the same name beside the file; empty if there is none.
  fs::path bulk_file(const std::vector<const char*>& extensions = {".asm"}) const {
    if (!options_.grids.empty()) return options_.grids;
    for (const char* extension : extensions) {
      const fs::path beside = fs::path(file_).replace_extension(extension);
      std::error_code ignored;
      if (beside != file_ && fs::exists(beside, ignored)) return beside;
    }
    return {};
  }

  Names list(const std::vector<Op4Matrix>& all) {
    Names names;
    for (const Op4Matrix& m : all) {
      names.push_back(m.name);
      if (m.unread.empty())
        tell("{}: {} x {}{}, {:.3g} digits", m.name, m.value.rows(), m.value.cols(),
             m.form > 0 ? fmt::format(", form {}", m.form) : "", m.digits);
      else
        tell("{}: {}", m.name, m.unread);
    }
    return names;
  }

  std::vector<Op4Matrix> op4() const {
    Names only;
    if (!options_.stiffness.empty() && !options_.mass.empty())
      only = {options_.stiffness, options_.mass};
    return read_op4(file_, only);
  }

  /// Six rows for each grid of the bulk data.
  Mesh six_rows_each(const std::vector<Op4Matrix>& all) {
    const Names names = list(all);
    const auto [stiffness, mass] = chosen_pair(options_, names, name());
    const Op4Matrix &K = find_matrix(all, stiffness), &M = find_matrix(all, mass);
    const fs::path bulk = bulk_file();
    if (bulk.empty())
      throw Error(
          Code::bad_file,
          fmt::format("{} has {} ({} x {}) and {}, and does not say which row is which grid",
                      name(), K.name, K.value.rows(), K.value.cols(), M.name),
          "give its bulk data (ImportOptions::grids; titop import --grids FILE.asm): Nastran "
          "writes them by EXTSEOUT(ASMBULK,EXTBULK,MATOP4=31)");
    const std::vector<Grid> grids = read_grids(bulk);
    tell("grids from {}: {}", bulk.filename().string(), grids.size());
    std::vector<int> ids;
    for (const Grid& g : grids) ids.push_back(g.id);
    return mesh_of(
        grid_matrices(file_.stem().string(), K.value, M.value, ids, std::min(K.digits, M.digits)),
        grids);
  }

  /// Matrices if it has a pair of them, the modes of its run otherwise.
  void op2() {
    const Op2File all = read_op2(file_);
    const Names names = list(all.matrices);
    Names tables;
    for (const Op2Table& table : all.tables) tables.push_back(table.name);
    tell("tables: {}", fmt::join(tables, ", "));
    const bool asked = !options_.stiffness.empty() || !options_.mass.empty();
    if (asked || std::ranges::any_of(names, [](const std::string& name) {
          return name == "KAA" || name == "KXX" || name == "KGG";
        })) {
      refuse({.ports = true, .units = true, .matrices = true, .modes = true, .xi = true});
      const auto [stiffness, mass] = chosen_pair(options_, names, name());
      const GridMatrices m = op2_matrices(all, stiffness, mass);
      return use(mesh_of(m, with_rows(op2_grids(all), m)));
    }
    op2_modes_alone(all);
  }

  void op2_modes_alone(const Op2File& all) {
    refuse({.ports = true, .units = true, .xi = true});
    clamped_run(op2_modes(all),
                [&] { return op2_modal_data(all, options_.parent, options_.children); });
    tell_of_lumped_mass();
  }

  void tell_of_lumped_mass() {
    if (result_.body)
      tell("D_P leaves out the mass that is lumped at grid {}: add it as a rigid body there",
           options_.parent);
  }

  void f06() {
    refuse({.ports = true, .units = true, .grids = true, .xi = true});
    const F06File all = read_f06(file_);
    tell("modes: {}, with shapes of {} grids, support forces of {}, {} digits",
         all.modes.omega.size(), all.modes.shapes.size(), all.forces.size(), 7);
    tell("participation factors: {}, effective masses: {}, rigid mass of the a-set: {}",
         all.factors ? "yes" : "no", all.effective ? "yes" : "no", all.rigid ? "yes" : "no");
    if (all.weight)
      tell("mass by the grid point weight generator, in units of weight: {:.7g}",
           all.weight->value(0, 0));
    for (const std::string& table : f06_missing(all)) tell("no table {}", table);
    if (!all.ends) warn({"no END OF JOB: the run or the file may have been cut short"});
    clamped_run(all.modes, [&] {
      const fs::path bulk = all.bulk.empty() ? bulk_file(kBulkFiles) : options_.grids;
      const std::vector<Grid> grids = bulk.empty() ? f06_grids(all) : read_grids(bulk);
      tell("grids from {}: {}", bulk.empty() ? "its bulk data echo" : bulk.filename().string(),
           grids.size());
      return f06_modal_data(all, grids, options_.parent, options_.children);
    });
    if (all.rigid) tell_of_lumped_mass();
  }

  /// A body of the modes of a run; its grids at rest are those that may be clamped.
  void clamped_run(const NormalModes& modes, const std::function<ModalData()>& body) {
    for (const auto& [grid, shape] : modes.shapes) result_.ports.push_back(std::to_string(grid));
    tell("at rest in all modes, for the parent: {}", fmt::join(grids_at_rest(modes), ", "));
    if (options_.parent.empty()) return;
    ModalData data = body();
    set_damping(options_.modes.xi, data);
    take(scaled(std::move(data), options_.units));
  }

  Mesh grids_of_dmig() {
    const Names names = dmig_names(file_);
    tell("matrices: {}", titop::detail::some_names(names));
    const auto [stiffness, mass] = chosen_pair(options_, names, name());
    const GridMatrices m = read_dmig(file_, stiffness, mass);
    const fs::path bulk = bulk_file();
    tell("{}, {}: {} rows, {:.3g} digits", stiffness, mass, m.dofs.size(), m.digits);
    if (bulk.empty()) return mesh_of(m, {});
    const std::vector<Grid> grids = with_rows(read_grids(bulk), m);
    tell("grids from {}: {}", bulk.filename().string(), grids.size());
    return mesh_of(m, grids);
  }

  Mesh mesh_of(const GridMatrices& m, const std::vector<Grid>& grids) {
    return mesh_of_matrices(m, grids, options_.parent, result_.text);
  }

  Mesh calculix() {
    refuse({.ports = true, .units = true, .modes = true, .xi = true});
    const CalculixFiles files = calculix_files(fs::path(file_).replace_extension());
    for (const fs::path& one : {files.stiffness, files.mass, files.dofs, files.deck})
      if (std::error_code ignored; !fs::exists(one, ignored))
        throw Error(Code::bad_file,
                    fmt::format("{} is one of four files of CalculiX, of which {} is missing",
                                name(), one.filename().string()),
                    "SOLVER=MATRIXSTORAGE writes .sti, .mas and .dof beside the deck .inp");
    CalculixDeck deck = read_calculix_deck(files.deck);
    const auto& [length, mass, time] = options_.units;
    if (deck.least_E) *deck.least_E *= mass / (length * time * time);
    warn(implausible(deck));
    return read_calculix(files);
  }

  void warn(const std::vector<std::string>& lines) {
    for (const std::string& line : lines) tell("warning: {}", line);
  }

  void use(const Mesh& mesh) {
    tell("mesh {}: {} points, {} rows, {:.3g} digits", mesh.name, mesh.points.size(),
         mesh.dofs.size(), mesh.digits);
    const auto& [length, mass, time] = options_.units;
    if (length == 1 && mass == 1 && time == 1)
      tell("taken as m, kg, s (ImportOptions::units; --units)");
    tell_mass(mesh);
    for (const MeshPoint& point : mesh.points)
      if (may_be_port(mesh, point)) result_.ports.push_back(point.name);
    if (options_.parent.empty()) return;
    ModeOptions modes = options_.modes;
    if (modes.rayleigh) modes.rayleigh->mass *= time, modes.rayleigh->stiffness /= time;
    take(scaled(fe::modal_data(mesh, options_.parent, options_.children, modes), options_.units));
  }

  /// A planar model has no mass along some directions.
  void tell_mass(const Mesh& mesh) {
    const Vector3d origin =
        mesh.points.empty() ? Vector3d::Zero().eval() : mesh.points.front().position;
    const std::array<bool, 6> still = still_directions(mesh, origin);
    Names directions;
    for (std::size_t c = 0; c < 6; ++c)
      if (still.at(c)) directions.push_back(component_name(static_cast<int>(c)));
    if (directions.empty()) {
      result_.text += to_string(mesh_report(mesh), options_.units);
      return;
    }
    const Eigen::MatrixXd R = rigid_motions(mesh, origin);
    for (int c = 0; c < 3; ++c)
      if (!still.at(static_cast<std::size_t>(c)))
        tell("mass along {}: {:.8g} (units of the file)", component_name(c),
             R.col(c).dot(mesh.M * R.col(c)));
    const RigidStiffness held = rigid_stiffness(mesh);
    tell(
        "it does not move in {}: a body needs its rigid mass (ModeOptions::rigid; titop import "
        "--mass)",
        fmt::join(directions, ", "));
    tell("stiffness against rigid motions {:.1e} of the largest, {:.1e} of its terms, worst at {}",
         held.of_largest, held.of_terms, held.worst);
  }

  /// Six directions, but for those in which the whole mesh is still.
  static bool may_be_port(const Mesh& mesh, const MeshPoint& point) {
    try {
      interface_rows(mesh, point.name, still_directions(mesh, point.position));
      return true;
    } catch (const Error&) {
      return false;
    }
  }

  void modal_data_alone() {
    refuse({});
    ModalData data = read_modal_csv(file_);
    result_.ports.push_back("P");
    for (const ModalChild& child : data.children) result_.ports.push_back(child.name);
    take(std::move(data));
  }

  void take(ModalData data) {
    tell("body: {} modes, {:.3g} digits", data.omega.size(), data.digits);
    result_.text += to_string(modal_report(data));
    if (data.omega.size() > 0 && data.xi.isZero(0)) tell("undamped: all damping ratios are 0");
    result_.body = std::move(data);
  }

  const fs::path& file_;
  const ImportOptions& options_;
  std::string ports_;
  Import result_;
};

}  // namespace

Import import_body(const fs::path& file, const ImportOptions& options) {
  return Importer(file, options).run();
}

}  // namespace titop::fe
