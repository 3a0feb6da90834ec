#pragma once

#include <functional>
#include <titop/blocks/diagram_file/json.hpp>
#include <titop/blocks/flexible_body.hpp>
#include <titop/graph/block.hpp>

/// Blocks by type name: their specs as JSON, and back.
namespace titop::diagram_file {

/// Numbers that may be parameters.
using WriteValue = std::function<Json(const Value&)>;
using ReadValue = std::function<Value(const JsonPlace&)>;
/// The name of shared modal data in the file.
using NameBody = std::function<std::string(const ModalData&)>;
using FindBody = std::function<FlexibleBody(const JsonPlace&)>;

/// The fields of this block after "name" and "type". Throws bad_value for a type of the user's
/// own.
void write_block(const Block& block, const WriteValue& value, const NameBody& body, Json& json);

/// The block of this place. Throws bad_file, and the errors of as_block.
BlockPtr read_block(const JsonPlace& place, const ReadValue& value, const FindBody& body);

/// Shared modal data.
Json body_json(const ModalData& data);
FlexibleBody read_body(const JsonPlace& place);

}  // namespace titop::diagram_file
