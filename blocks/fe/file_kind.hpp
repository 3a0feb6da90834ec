#pragma once

#include <filesystem>

/// Kinds of files that a body can be made of. For the folder's own files.
namespace titop::fe {

enum class FileKind { op4, op2, f06, dmig, mat, modal_csv, calculix };

/// By extension (CalculiX, f06, MAT-file) or content. Throws bad_file for another kind, with the
/// output to request from the program that wrote it.
FileKind kind_of_file(const std::filesystem::path& file);

}  // namespace titop::fe
