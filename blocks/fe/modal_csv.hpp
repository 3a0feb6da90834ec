#pragma once

#include <filesystem>
#include <string>
#include <titop/blocks/modal_data.hpp>

/// Modal data typed by hand or written by scripts, as text.
namespace titop::fe {

/// Reads a file of lines `keyword, number, ...`; empty lines and what follows a # are skipped.
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
/// The data come out in SI units and unchecked but for their form: `FlexibleBody` and
/// `modal_report` judge them. Throws bad_file, all mistakes together, with file, line and what was
/// expected; also for what may come once
/// and comes twice (units, digits, at P, a child's name, a mode's modal mass), and for a last line
/// without line end, whose number may be cut short. A file cut at the end of a line looks whole:
/// modes that are missing are not missed.
ModalData read_modal_csv(const std::filesystem::path& path);

/// The same data as such a text, in SI units; reading it gives them back to the last bit. Throws
/// size for matrices that do not fit the modes, bad_value for a child's name that cannot stand in a
/// field: with a comma, # or line end, with blanks at its ends, or empty.
std::string modal_csv(const ModalData& data);

}  // namespace titop::fe
