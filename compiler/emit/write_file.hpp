#pragma once

#include <filesystem>
#include <string>

namespace titop::emit {

/// Writes the file, unless it already says the same: what depends on it is then left alone. Throws
/// bad_file.
void write_file(const std::filesystem::path& path, const std::string& content);

}  // namespace titop::emit
