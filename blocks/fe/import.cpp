#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <map>
#include <titop/blocks/fe/bulk_data.hpp>
#include <titop/blocks/fe/calculix.hpp>
#include <titop/blocks/fe/dmig.hpp>
#include <titop/blocks/fe/file_kind.hpp>
#include <titop/blocks/fe/import.hpp>
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

/// Names of stiffness and mass among those of the file.
std::pair<std::string, std::string> chosen_pair(const ImportOptions& options, const Names& there) {
  if (!options.stiffness.empty() || !options.mass.empty()) return {options.stiffness, options.mass};
  constexpr std::array<std::pair<const char*, const char*>, 5> pairs = {
      {{"KAA", "MAA"}, {"KXX", "MXX"}, {"KAAX", "MAAX"}, {"KGG", "MGG"}, {"K", "M"}}};
  const auto has = [&](const char* name) { return std::ranges::find(there, name) != there.end(); };
  Names found;
  std::pair<std::string, std::string> result;
  for (const auto& [K, M] : pairs)
    if (has(K) && has(M)) {
      found.push_back(fmt::format("{} and {}", K, M));
      result = {K, M};
    }
  if (found.size() == 1) return result;
  throw Error(
      Code::unknown_name,
      found.empty() ? "the file has no pair of stiffness and mass that is known by name"
                    : "the file has more than one pair of stiffness and mass",
      fmt::format("name them (ImportOptions::stiffness, mass; titop import --matrices K,M); "
                  "its matrices are {}",
                  titop::detail::some_names(there)));
}

/// One import: what it reads is told in `result.text`.
class Importer {
 public:
  Importer(const fs::path& file, const ImportOptions& options) : file_(file), options_(options) {}

  Import run() {
    switch (kind_of_file(file_)) {
      case FileKind::op4: use(grids_of_op4()); break;
      case FileKind::dmig: use(grids_of_dmig()); break;
      case FileKind::calculix: use(calculix()); break;
      case FileKind::modal_csv: modal_data_alone(); break;
      case FileKind::op2: op2(); break;
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

  fs::path bulk_file() const {
    if (!options_.grids.empty()) return options_.grids;
    const fs::path beside = fs::path(file_).replace_extension(".asm");
    std::error_code ignored;
    return beside != file_ && fs::exists(beside, ignored) ? beside : fs::path();
  }

  Names list(const std::vector<Op4Matrix>& all) {
    Names names;
    for (const Op4Matrix& m : all) {
      names.push_back(m.name);
      if (m.unread.empty())
        tell("{}: {} x {}, form {}, {:.3g} digits", m.name, m.value.rows(), m.value.cols(), m.form,
             m.digits);
      else
        tell("{}: {}", m.name, m.unread);
    }
    return names;
  }

  Mesh grids_of_op4() {
    const std::vector<Op4Matrix> all = read_op4(file_);
    const Names names = list(all);
    const auto [stiffness, mass] = chosen_pair(options_, names);
    const Op4Matrix &K = find_matrix(all, stiffness), &M = find_matrix(all, mass);
    const fs::path bulk = bulk_file();
    if (bulk.empty())
      throw Error(
          Code::bad_file,
          fmt::format("{} does not say which row is which grid", file_.filename().string()),
          "give its bulk data (ImportOptions::grids; titop import --grids FILE.asm): Nastran "
          "writes them by EXTSEOUT(ASMBULK,EXTBULK,MATOP4=31)");
    const std::vector<Grid> grids = read_grids(bulk);
    tell("grids from {}: {}", bulk.filename().string(), grids.size());
    return mesh_of(six_rows_each(K, M, grids), grids);
  }

  GridMatrices six_rows_each(const Op4Matrix& K, const Op4Matrix& M,
                             const std::vector<Grid>& grids) const {
    std::vector<int> ids;
    for (const Grid& g : grids) ids.push_back(g.id);
    return grid_matrices(file_.stem().string(), K.value, M.value, ids,
                         std::min(K.digits, M.digits));
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
      const auto [stiffness, mass] = chosen_pair(options_, names);
      const std::vector<Grid> grids = op2_grids(all);
      return use(mesh_of(six_rows_each(find_matrix(all.matrices, stiffness),
                                       find_matrix(all.matrices, mass), grids),
                         grids));
    }
    for (const auto& [grid, shape] : op2_modes(all).shapes)
      result_.ports.push_back(std::to_string(grid));
    if (options_.parent.empty()) return;
    ModalData data = op2_modal_data(all, options_.parent, options_.children);
    if (options_.modes.xi.size() == 1) data.xi.setConstant(options_.modes.xi[0]);
    take(scaled(std::move(data), options_.units));
  }

  Mesh grids_of_dmig() {
    const Names names = dmig_names(file_);
    tell("matrices: {}", titop::detail::some_names(names));
    const auto [stiffness, mass] = chosen_pair(options_, names);
    const GridMatrices m = read_dmig(file_, stiffness, mass);
    const fs::path bulk = bulk_file();
    tell("{}, {}: {} rows, {:.3g} digits", stiffness, mass, m.dofs.size(), m.digits);
    if (bulk.empty()) return mesh_of(m, {});
    std::vector<Grid> grids = read_grids(bulk);
    std::erase_if(grids, [&](const Grid& g) {
      return std::ranges::none_of(m.dofs, [&](const GridDof& dof) { return dof.grid == g.id; });
    });
    tell("grids from {}: {}", bulk.filename().string(), grids.size());
    return mesh_of(m, grids);
  }

  /// Positions by statics if there are no grids.
  Mesh mesh_of(GridMatrices m, std::vector<Grid> grids) {
    const std::vector<GridDof> empty = empty_rows(m);
    Names dropped;
    for (const GridDof& dof : empty)
      dropped.push_back(dof.component > 0 ? fmt::format("{}.{}", dof.grid, dof.component)
                                          : fmt::format("scalar {}", dof.grid));
    if (!empty.empty())
      tell("dropped, without stiffness and mass: {} rows, {}", empty.size(),
           titop::detail::some_names(dropped));
    m = without(std::move(m), empty);
    if (grids.empty()) grids = by_statics(m);
    std::erase_if(grids, [&](const Grid& g) {
      return std::ranges::none_of(m.dofs, [&](const GridDof& dof) { return dof.grid == g.id; });
    });
    return to_mesh(m, grids);
  }

  /// From the grid of the parent port, or else from the first one that gives rigid motions.
  std::vector<Grid> by_statics(const GridMatrices& m) {
    const std::vector<int> from = references(m);
    for (std::size_t i = 0;; ++i) try {
        std::vector<Grid> grids = grids_by_statics(m, from.at(i));
        tell("positions by statics, from grid {}", from[i]);
        return grids;
      } catch (const Error&) {
        constexpr std::size_t most = 10;
        if (i + 1 == std::min(from.size(), most)) throw;
      }
  }

  /// The grid of the parent port, or else those with the most components; 0 if there are none.
  std::vector<int> references(const GridMatrices& m) const {
    const std::string& name = options_.parent;
    int parent = 0;
    if (const auto end = name.data() + name.size();
        !name.empty() && std::from_chars(name.data(), end, parent).ptr == end)
      return {parent};
    std::map<int, int> components;
    int most = 0;
    for (const GridDof& dof : m.dofs)
      if (dof.component > 0) most = std::max(most, ++components[dof.grid]);
    std::vector<int> grids;
    for (const auto& [grid, count] : components)
      if (count == most) grids.push_back(grid);
    if (grids.empty()) grids.push_back(0);
    return grids;
  }

  Mesh calculix() {
    const CalculixFiles files = calculix_files(fs::path(file_).replace_extension());
    warn(implausible(read_calculix_deck(files.deck)));
    return read_calculix(files);
  }

  void warn(const std::vector<std::string>& lines) {
    for (const std::string& line : lines) tell("warning: {}", line);
  }

  void use(const Mesh& mesh) {
    tell("mesh {}: {} points, {} rows, {:.3g} digits", mesh.name, mesh.points.size(),
         mesh.dofs.size(), mesh.digits);
    tell_mass(mesh);
    for (const MeshPoint& point : mesh.points)
      if (may_be_port(mesh, point)) result_.ports.push_back(point.name);
    if (options_.parent.empty()) return;
    take(scaled(fe::modal_data(mesh, options_.parent, options_.children, options_.modes),
                options_.units));
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
    if (!options_.parent.empty() || !options_.children.empty())
      throw Error(
          Code::bad_value,
          fmt::format("{} has modal data, which have their ports", file_.filename().string()),
          "name no parent and no children");
    ModalData data = scaled(read_modal_csv(file_), options_.units);
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
