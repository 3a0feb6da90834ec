#pragma once

#include <titop/analysis/lft/lft.hpp>
#include <titop/emit/files/files.hpp>

/// Linear fractional transformations as files for other programs. Numbers read back to the last
/// bit; all throw bad_file if a file cannot be written, bad_value for a name that the language does
/// not take. O((states + occurrences)^2).
namespace titop {

/// A MATLAB/Octave function: `m = satellite ()` has A, B, C, D with inputs [w; u] and outputs [z;
/// y], and their names; `[m, sys] = satellite ()` also a uss of ureal, by MATLAB's Robust Control
/// Toolbox.
///
/// m.parameters is a struct array: name, size, at_least, minimal, nominal, from, to, and the map
/// delta = d / (gain - shape d), d = value - nominal if divisor is 0, else tan ((value - nominal) /
/// divisor). In sys every parameter is one ureal of its name (as an identifier), its delta in [-1,
/// 1].
void write_matlab(const Lft& f, const std::filesystem::path& file);

/// A Python module and its arrays as `write_numpy` of a model makes them, with inputs [w; u] and
/// outputs [z; y]; also `parameters` (dictionaries with the fields above) and `at(m=1100, ...)`,
/// which returns A, B, C, D of the model at these values.
void write_numpy(const Lft& f, const std::filesystem::path& folder, const std::string& name);

/// One JSON object: "format" ("titop lft 1"), "states", "inputs", "outputs", "A", "B", "C", "D",
/// "states_at_least", "not_decided" (null if the lower bounds are known) and "parameters", a list
/// with the fields above, "first" and "where".
std::string lft_json(const Lft& f);
void write_json(const Lft& f, const std::filesystem::path& file);

}  // namespace titop
