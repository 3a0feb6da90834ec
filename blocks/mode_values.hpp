#pragma once

#include <functional>
#include <titop/blocks/check_modal_data.hpp>
#include <titop/blocks/flexible_body.hpp>

/// Modal data with other values in place. For the folder's own files.
namespace titop::detail {

/// The number of a value: nominal, or at new values of the parameters.
using NumberOf = std::function<double(const Value&)>;

/// The values in a fixed order.
std::vector<Value> list_of(const ModeValues& values);

/// Frequencies and damping ratios with these values in place. Throws bad_modes for a mode that is
/// not there, and as check_modes. O(N).
ModalParameters modes_with(const ModalData& data, const ModeValues& values, const NumberOf& number);

/// The data with all of these values in place. Throws as modes_with; bad_modes for a component that
/// is not there or an entry given twice, unknown_name for a child, and as check_modal_data.
/// O(entries of the data).
ModalData data_with(const ModalData& data, const ModeValues& values, const NumberOf& number);

}  // namespace titop::detail
