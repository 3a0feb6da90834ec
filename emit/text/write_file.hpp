#pragma once

#include <filesystem>
#include <string>

namespace titop::emit {

/// Writes the file, unless it has this content already, so that its time stamp stays. Written
/// next to it (.part) and renamed, so that it is never incomplete. Throws bad_file, also for a
/// folder.
void write_file(const std::filesystem::path& path, const std::string& content);

}  // namespace titop::emit
