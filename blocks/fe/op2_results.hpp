#pragma once

#include <string>
#include <titop/blocks/fe/grids.hpp>
#include <titop/blocks/fe/modal_data.hpp>
#include <titop/blocks/fe/normal_modes.hpp>
#include <titop/blocks/fe/op2.hpp>
#include <vector>

/// Results of a normal modes analysis (SOL 103) in an OP2, in the data's own units.
namespace titop::fe {

/// Tables LAMA and OUGV1, without scalar points. BOPHIG and OPHIG are not read: their frame is the
/// basic one, or not known. Throws bad_file for a table that is not there, with the lines that
/// write it, or there twice, that has several subcases, SORT2, complex shapes, or other modes than
/// LAMA.
NormalModes op2_modes(const Op2File& file);

/// Positions and frames of all grids by ascending number, from GEOM1 (GRID and the systems that
/// `read_grids` takes, single or double precision), in the basic frame. Throws bad_file for a
/// missing table or coordinate system.
std::vector<Grid> op2_grids(const Op2File& file);

/// Stiffness and mass of these names with the grid and component of each row: of the a-set if the
/// file has USET and EQEXIN (as PARAM,POST,-1 or a DMAP alter write them), of the g-set if they
/// have as many rows as EQEXIN; without these tables six rows for each grid of GEOM1, in ascending
/// order, then scalar points (`grid_matrices`).
///
/// Throws the errors of `find_matrix` and `grid_matrices`; bad_file for matrices with other numbers
/// of rows, and tables that contradict each other.
GridMatrices op2_matrices(const Op2File& file, const std::string& stiffness,
                          const std::string& mass);

/// Modal data of a body clamped at grid `parent` alone by the run itself, with modes of generalised
/// mass 1: omega from LAMA, Phi of the children (grid numbers, as names) from OUGV1, L_P from
/// MPFACS, D_P from RBMASSS. Nastran computes these in the basic frame about the grid of MEFFMASS's
/// GRID, which must be the parent: its forces in OQG1 are compared with -omega^2 L_P to 1e-3 of the
/// rigid mass. `digits`: 7, those of OUGV1 and LAMA. D_P leaves out the mass that is lumped at the
/// clamped grid. Undamped.
///
/// Throws bad_file for missing tables, with the lines that write them, for generalised masses that
/// differ from 1 by more than 1e-5, for support forces that contradict MPFACS, and for RBMASSS that
/// is not symmetric to seven digits; bad_value for a parent that moves in the modes; unknown_name
/// for grids without position or shapes.
ModalData op2_modal_data(const Op2File& file, const std::string& parent,
                         const std::vector<std::string>& children);

}  // namespace titop::fe
