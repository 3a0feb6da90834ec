#pragma once

#include <string_view>

/// Names that a language accepts.
namespace titop::emit {

enum class Language {
  cpp,     ///< no keyword, nothing reserved, no macro of the standard library
  matlab,  ///< of a function's file, MATLAB's and Octave's: no keyword of either, 63 letters at
           ///< most
  python,  ///< of a module: no keyword, none of the modules that numpy itself imports
};

/// Letters of ASCII, digits and underscores, from a letter on, and not taken in this language.
bool is_identifier(std::string_view text, Language language = Language::cpp);

/// A C++ identifier that does not collide with the C library in a namespace: `sin` and `link` are
/// functions.
bool is_namespace(std::string_view text);

}  // namespace titop::emit
