#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <titop/graph/diagram.hpp>

/// Diagrams as text: JSON, stable, the same to the last bit when read again.
/// docs/diagram.schema.json describes it.
namespace titop {

/// The diagram before any pass, equations as they were written:
///
///     {"format": "titop scene 1", "name": "masses",
///      "parameters": [{"name": "k", "value": 10}],
///      "bodies": {"body1": {"omega": [...], ...}},                       # shared modal data
///      "blocks": [{"name": "z1", "type": "SpringMass", "mass": 1,
///                  "stiffness": {"parameter": "k"}, ...}],
///      "inputs": [{"name": "u", "size": 1}],
///      "equations": [{"of": ["z1", "parent", "accel"], "terms": []},      # = 0
///                    {"of": ["z1", "child", "force"], "add": true,       # +=
///                     "terms": [{"signal": ["u"], "sign": -1, "factors": [2.5]}]}],
///      "outputs": [{"name": "x", "size": 1, "terms": [{"signal": ["z1", "stretch"]}]}]}
///
/// A signal is [block, channel, "accel" or "force"], [block, port] or [input]; a term may read its
/// "position", "rate" or "reaction" ("read"). Factors act from the last to the first: numbers,
/// parameters, {"rotation": ...}, {"matrix": ...}, {"part": ...}. Keys keep this order; numbers
/// have enough digits to be read back exactly.
///
/// Throws the mistakes noted in the diagram, bad_value for a block of the user's own type (the
/// reader cannot create it) and duplicate_name for two blocks, inputs or parameters of one name.
/// O(size).
std::string diagram_json(const Diagram& diagram);

/// The diagram of such a text; `file` is for messages. Compiling it gives the same model, to the
/// last bit, as compiling the diagram that was written. Throws bad_file, with the place in the text
/// ("blocks[3].mass"), the text found and the text expected; and the errors of `Diagram::add` for
/// invalid blocks. Later messages have "equations[3] of the diagram file" for a source line, those
/// after pass check "a diagram file".
Diagram parse_diagram(std::string_view json, const std::string& file = "diagram");

/// The same with files. Throw bad_file, and the errors of diagram_json or parse_diagram.
void write_diagram(const Diagram& diagram, const std::filesystem::path& file);
Diagram read_diagram(const std::filesystem::path& file);

}  // namespace titop
