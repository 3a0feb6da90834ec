#pragma once

#include <Eigen/Core>
#include <map>
#include <string>
#include <titop/blocks/fe/grids.hpp>
#include <titop/blocks/fe/modal_data.hpp>
#include <vector>

/// Results of a normal modes analysis of Nastran (SOL 103), in the data's own units.
namespace titop::fe {

struct NormalModes {
  Eigen::VectorXd omega;                  ///< N [rad/unit of time]
  Eigen::VectorXd mass;                   ///< N, generalised masses
  std::vector<long long> numbers;         ///< N, of the modes
  std::map<int, Eigen::MatrixXd> shapes;  ///< 6 x N by grid, in its displacement frame
};

/// Grids that no mode moves by more than 1e-6 of its largest displacement and rotation: those that
/// may be clamped.
std::vector<int> grids_at_rest(const NormalModes& modes);

namespace detail {

/// A run clamped at one grid, P, as read from a file. For the folder's own files.
struct ClampedRun {
  std::string file;  ///< for messages
  NormalModes modes;
  /// 6 x N by grid, of supports, in its displacement frame
  std::map<int, Eigen::MatrixXd> forces = {};
  Eigen::MatrixXd L = {};        ///< 6 x N, participation factors about P, basic frame
  Matrix6 D = Matrix6::Zero();   ///< rigid mass about P, basic frame
  std::vector<Grid> grids = {};  ///< positions and frames in the basic frame
  double digits = 7;
  std::string ask = {};  ///< output requests of such a run
};

/// Throws unknown_name.
const Grid& find_grid(const std::vector<Grid>& grids, const std::string& file,
                      const std::string& name);

/// Throws bad_value, with the grids at rest, for a parent that moves in the modes.
void require_at_rest(const NormalModes& modes, const std::string& file, const Grid& parent);

/// A rigid mass matrix as a file has it, each of its entries rounded alone. Throws bad_file if
/// entries (i, j) and (j, i) differ by more than 1e-6 of sqrt(D_ii D_jj).
Matrix6 symmetric_mass(const Matrix6& D, const std::string& file);

/// Modal data of the run, with modes of generalised mass 1, undamped. The forces at the parent are
/// compared with -omega^2 L to 1e-3 of the rigid mass. Throws the errors of `require_at_rest`;
/// bad_file for generalised masses that differ from 1 by more than 1e-5, and for forces that
/// contradict L; unknown_name for grids without position or shapes.
ModalData clamped_modal_data(const ClampedRun& run, const std::string& parent,
                             const std::vector<std::string>& children);

}  // namespace detail

}  // namespace titop::fe
