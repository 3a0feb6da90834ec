#pragma once

#include <filesystem>
#include <string>
#include <titop/blocks/fe/modal_data.hpp>

/// Modal data typed by hand or written by scripts, as text.
namespace titop::fe {

/// Reads a file of lines `keyword, number, ...`; empty lines and text after a # are skipped.
///
///     units, 0.001, 1, 1            # of length [m], mass [kg], time [s]; SI if left out
///     digits, 7                     # that the data carry; 15 if left out
///     D_P, 5.07, 0, 0, 0, 0, 0      # six lines: the rigid mass matrix about P, row by row
///     at P, 0.008517                # mass on the clamped grid that D_P leaves out; 0 if left out
///     child, C, 100, 0, 0           # a child point: its name, its position from P
///     mode, 562.7, 0.005, L_P(6), Phi(6) of each child in the order of their lines
///
/// A mode has omega, damping ratio, the six participation factors at P, and for each child the six
/// displacements and rotations there. A line `modal mass, m` behind a mode brings it to modal mass
/// 1 (its L_P and Phi are divided by sqrt(m)): for modes normalised to MAX. Children precede modes.
///
/// The data are in SI units; only the format is checked: `FlexibleBody` and `modal_report` check
/// the values. Throws bad_file, all mistakes together, with file, line and the expected text; also
/// for a repeated entry that is allowed once (units, digits, at P, a child's name, a mode's modal
/// mass), and for a last line without line end, whose number may be truncated. A file that is
/// truncated at the end of a line looks complete: missing modes are not detected.
ModalData read_modal_csv(const std::filesystem::path& path);

/// The same data as such a text, in SI units; reading it gives them back to the last bit. Throws
/// size for matrices that do not fit the modes, bad_value for a child's name that cannot be written
/// to a field: with a comma, # or line end, with blanks at its ends, or empty; and for data with
/// lines, which such a text does not hold.
std::string modal_csv(const ModalData& data);

}  // namespace titop::fe
