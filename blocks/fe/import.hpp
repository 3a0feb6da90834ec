#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <titop/blocks/fe/mesh.hpp>
#include <titop/blocks/fe/modal_data.hpp>
#include <titop/blocks/fe/scaled.hpp>
#include <vector>

/// From a file of a finite-element program to a flexible body, with all checks on the way.
namespace titop::fe {

/// Data that the file itself does not contain.
struct ImportOptions {
  /// Parent port, one of `Import::ports`; empty: the contents are listed, no body is made.
  std::string parent = {};
  std::vector<std::string> children = {};  ///< child ports, of `Import::ports`
  DataUnits units = {};                    ///< of the file; a CSV has its own line of them
  ModeOptions modes = {};                  ///< of the mesh: `rigid` in its units, `rayleigh` in s
  /// Positions and frames of the grids of an OP4, MAT, DMIG or f06 file: bulk data (`read_grids`).
  /// Empty: the file of the same name with the extension .asm, or, without it, of a DMIG by statics
  /// from the parent, whose displacement frame is then the body's. Of an f06 its own bulk data
  /// echo, or the file of the same name with .asm, .bdf, .dat or .nas.
  std::filesystem::path grids = {};
  /// Names of stiffness and mass; empty: the one pair of KAA, MAA; KXX, MXX; KAAX, MAAX; KGG, MGG;
  /// K, M that the file has.
  std::string stiffness = {}, mass = {};
};

/// Contents of the file, its checks, and the body.
struct Import {
  std::string text;                ///< one fact per line: contents, checks, warnings, ports
  std::vector<std::string> ports;  ///< grids or points that may be parent or child
  std::optional<ModalData> body;   ///< in SI, if a parent was named, or the file has modal data
};

/// Reads a file by its content: OP4 (text or binary), OP2, f06, DMIG punch, a MAT-file, modal data
/// as CSV, or one of the four files of CalculiX (.sti, .mas, .dof, .inp). Rows without stiffness
/// and mass are dropped and listed; the matrices are symmetrised. `text` has the matrices with
/// sizes and digits, the asymmetry, the mass properties, the stiffness against rigid motions, and
/// of a body its `modal_report`.
///
/// Rows of an OP4 or a MAT-file are six for each grid of the bulk data, in ascending order, then
/// scalar points; of an OP2 those of `op2_matrices`. An OP2 without stiffness and mass, and an f06,
/// give the modes of their run (`op2_modal_data`, `f06_modal_data`), clamped at the parent by the
/// run.
///
/// Throws the errors of the readers, of `to_mesh` and `modal_data`; bad_value for options that the
/// kind of file does not take (a CSV of modes: any; the modes of an OP2 or f06: modes but for xi;
/// an OP2: grids; CalculiX: grids, stiffness, mass); bad_file for a file of another
/// kind, with the output to request from the program; unknown_name for matrices or ports that do
/// not exist.
Import import_body(const std::filesystem::path& file, const ImportOptions& options = {});

}  // namespace titop::fe
