#pragma once

#include <Eigen/Core>
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <titop/blocks/fe/grids.hpp>
#include <titop/blocks/fe/normal_modes.hpp>
#include <vector>

/// Reader for the printed results of a normal modes analysis of Nastran (SOL 103): `.f06`.
namespace titop::fe {

/// A rigid mass matrix in the basic frame, about a grid, or about the origin.
struct F06Mass {
  Matrix6 value = Matrix6::Zero();
  int about = 0;  ///< number of the grid; 0: the origin
};

/// The tables of a file, of seven printed digits, in the data's own units; those that it does not
/// have are empty.
struct F06File {
  std::string name;                               ///< for messages
  NormalModes modes = {};                         ///< REAL EIGENVALUES, REAL EIGENVECTOR
  std::map<int, Eigen::MatrixXd> forces = {};     ///< 6 x N, FORCES OF SINGLE-POINT CONSTRAINT
  std::optional<Eigen::MatrixXd> factors = {};    ///< 6 x N, MODAL PARTICIPATION FACTORS
  std::optional<Eigen::MatrixXd> effective = {};  ///< 6 x N, MODAL EFFECTIVE MASS
  int about = 0;                       ///< reference point of factors, a grid or the origin
  std::optional<F06Mass> rigid = {};   ///< A-SET RIGID BODY MASS MATRIX
  std::optional<F06Mass> weight = {};  ///< GRID POINT WEIGHT GENERATOR, in units of weight
  std::string bulk = {};               ///< SORTED BULK DATA ECHO, its cards
  double wtmass = 1;                   ///< PARAM,WTMASS of the echo: mass of a unit of weight
  bool ends = false;                   ///< END OF JOB: the run has printed all its tables
};

/// Tables of one subcase, over any number of pages, with titles of any text. Eigenvalues before the
/// augmentation by residual vectors are skipped, as are scalar points and all other tables. The
/// layout of MEFFMASS, with its A-SET RIGID BODY MASS MATRIX, is that of files of NX Nastran 10.2
/// and MSC Nastran 2018.
///
/// Throws bad_file, all mistakes together, with file and line: a row that does not fit its table, a
/// grid twice in a mode or missing in one, eigenvectors and forces of modes that the eigenvalues do
/// not have, several subcases, a fatal message of the run.
F06File read_f06(const std::filesystem::path& path);

/// Positions and frames of the grids of the file's own bulk data echo. Throws bad_file without one,
/// and the errors of `read_grids`.
std::vector<Grid> f06_grids(const F06File& file);

/// Tables without which `f06_modal_data` refuses, each with the request that prints it.
std::vector<std::string> f06_missing(const F06File& file);

/// Modal data of a body that the run has clamped at grid `parent` alone, like `op2_modal_data`.
/// `grids`: positions and frames, from the bulk data. L_P is the table MODAL PARTICIPATION FACTORS.
/// D_P is the A-SET RIGID BODY MASS MATRIX, without the mass lumped at the clamped grid; if the
/// file does not have it, the matrix of the GRID POINT WEIGHT GENERATOR, with that mass, times
/// `wtmass` (which must be 1 if the file has no echo). Both are moved from their reference points
/// to the parent. `digits` is 7, less the digits that this move costs.
///
/// Throws the errors of `op2_modal_data`; bad_file for effective masses that are not the squares of
/// the participation factors.
ModalData f06_modal_data(const F06File& file, const std::vector<Grid>& grids,
                         const std::string& parent, const std::vector<std::string>& children);

}  // namespace titop::fe
