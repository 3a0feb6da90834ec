#pragma once

#include <filesystem>
#include <string>

namespace titop::emit {

/// Writes the file, unless it already says the same: what depends on it is then left alone.
/// Written beside it (.part) and renamed, so that no half of it is ever there. Throws bad_file,
/// also for a folder.
void write_file(const std::filesystem::path& path, const std::string& content);

}  // namespace titop::emit
