#pragma once

#include <filesystem>
#include <span>
#include <string>
#include <titop/analysis/certify/certify_full.hpp>
#include <titop/compiler/system/system.hpp>
#include <vector>

/// Models as files for other programs. Numbers are written so that they read back to the last bit.
/// All throw bad_file if a file cannot be written.
namespace titop {

/// The log's warnings of System::state_space(): lost digits of A, B, C, D, which `transfer`,
/// `apply` and `simulate` do not lose. Empty if the loss is small. Errors and cost are those of
/// state_space() if it has not been called yet.
std::vector<std::string> dense_warnings(const System& system);

/// A MATLAB/Octave function: the file's name without .m must be an identifier (bad_value)
/// of MATLAB and Octave.
///
///     m = satellite ();  G = m.C * ((s * eye (m.n) - m.A) \ m.B) + m.D;
///     sys = ss (m.A, m.B, m.C, m.D);     % with the control package
///
/// m.states, m.inputs, m.outputs are cell arrays of the names; index (m.inputs, "tau_m") by
/// find (strcmp (m.inputs, "tau_m")). O(n^2).
void write_matlab(const StateSpace& model, const std::filesystem::path& file);
/// Its state_space(), with its `dense_warnings` as comments at the head.
void write_matlab(const System& system, const std::filesystem::path& file);

/// A MAT-file of MATLAB and Octave, version 5, not compressed: `load model.mat` gives A, B, C, D,
/// and the names as cell arrays states, inputs, outputs. Throws size for a matrix of 2 GB. O(n^2).
void write_mat(const StateSpace& model, const std::filesystem::path& file);
/// Its state_space(), with its `dense_warnings` as a cell array warnings.
void write_mat(const System& system, const std::filesystem::path& file);

/// A Python module and its arrays: FOLDER/NAME.py, NAME_A.npy, NAME_B.npy, NAME_C.npy, NAME_D.npy.
/// NAME must be an identifier (bad_value), and no module that numpy imports. `import NAME` gives A,
/// B, C, D, states, inputs, outputs, transfer(s) and poles(). O(n^2).
void write_numpy(const StateSpace& model, const std::filesystem::path& folder,
                 const std::string& name);
/// Its state_space(), with its `dense_warnings` as comments at the head.
void write_numpy(const System& system, const std::filesystem::path& folder,
                 const std::string& name);

/// Frequency response as comma-separated values: a column rad_per_s, then for every output and
/// input re(OUTPUT/INPUT) and im(OUTPUT/INPUT), quoted if a name has a comma or a quote; a line
/// per omega [rad/s]. O(bodies) per frequency.
void write_csv(const System& system, std::span<const double> omega,
               const std::filesystem::path& file);

/// The whole model and its properties as one JSON object: "format" ("titop model 1"), "name",
/// "states", "inputs", "outputs", "A", "B", "C", "D" (lists of rows), "poles", "certificate" (the
/// fields of `Certificate`; null for a number that is not finite or was not computed) and "notes"
/// (those of System::log: pass, kind, text). Keys keep this order, so that the text is stable.
/// O(n^3) for the poles.
std::string model_json(const System& system);
void write_json(const System& system, const std::filesystem::path& file);

/// The full certificate as one JSON object: "format" ("titop certificate 1"), "holds", "faults" (a
/// list of texts), "basic" (as "certificate" of a model), then "grid", "poles", "passivity",
/// "reciprocity", "order" and "exact" with the fields of `FullCertificate` by their names; complex
/// numbers are pairs [re, im]. Each but "order" has "done" and "why_not" (null if it is done);
/// "order" has "judged" and "decided". Values that were not checked or computed are null, as are
/// numbers that are not finite; no item is left out. Keys keep this order.
std::string certificate_json(const FullCertificate& certificate);
void write_json(const FullCertificate& certificate, const std::filesystem::path& file);

}  // namespace titop
