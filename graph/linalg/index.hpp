#pragma once

#include <cstddef>

namespace titop::linalg {

/// An index of Eigen's or of a graph (both signed), which must not be negative, for a std::vector.
constexpr std::size_t at(std::ptrdiff_t i) { return static_cast<std::size_t>(i); }

}  // namespace titop::linalg
