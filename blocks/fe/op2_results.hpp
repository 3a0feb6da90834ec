#pragma once

#include <Eigen/Core>
#include <map>
#include <string>
#include <titop/blocks/fe/grids.hpp>
#include <titop/blocks/fe/modal_data.hpp>
#include <titop/blocks/fe/op2.hpp>
#include <vector>

/// Results of a normal modes analysis (SOL 103) in an OP2, in the data's own units.
namespace titop::fe {

/// Tables LAMA and OUGV1 (or OPHIG).
struct Op2Modes {
  Eigen::VectorXd omega;                  ///< N [rad/unit of time]
  Eigen::VectorXd mass;                   ///< N, generalised masses
  std::map<int, Eigen::MatrixXd> shapes;  ///< 6 x N by grid, in its displacement frame
};

/// The modes. Throws bad_file for a table that is not there, with the case-control or bulk line
/// that writes it, that has several subcases, complex shapes, or modes that differ from LAMA's.
Op2Modes op2_modes(const Op2File& file);

/// Positions and frames of all grids by ascending number, from GEOM1 (GRID, CORD2R, single or
/// double precision), in the basic frame. Throws bad_file for a missing table or coordinate system.
std::vector<Grid> op2_grids(const Op2File& file);

/// Modal data of a body clamped at grid `parent` by the run itself, mass-normalised: omega from
/// LAMA, Phi of the children (grid numbers, as names) from OUGV1, L_P from MPFACS, D_P from
/// RBMASSS. Nastran computes these about the grid of MEFFMASS's GRID, which must be the parent.
/// `digits`: 7, those of OUGV1 and LAMA. D_P leaves out the mass that is lumped at the clamped
/// grid. Undamped.
///
/// Throws bad_file for what is missing, with the line that writes it; unknown_name for grids
/// without position or shapes.
ModalData op2_modal_data(const Op2File& file, const std::string& parent,
                         const std::vector<std::string>& children);

}  // namespace titop::fe
