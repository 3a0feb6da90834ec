#include <algorithm>
#include <cctype>
#include <string>
#include <titop/emit/text/global_names.hpp>
#include <titop/emit/text/identifier.hpp>

namespace titop::emit {

namespace {

/// Words between blanks, with a blank before the first and behind the last.
constexpr std::string_view kCpp =
    " alignas alignof and and_eq asm auto bitand bitor bool break case catch char char16_t "
    "char32_t "
    "char8_t class co_await co_return co_yield compl concept const const_cast consteval constinit "
    "constexpr continue decltype default delete do double dynamic_cast else enum explicit export "
    "extern false float for friend goto if inline int long mutable namespace new noexcept not "
    "not_eq nullptr operator or or_eq private protected public register reinterpret_cast requires "
    "return short signed sizeof static static_assert static_cast struct switch template this "
    "thread_local throw true try typedef typeid typename union unsigned using virtual void "
    "volatile "
    "wchar_t while xor xor_eq std main linux unix ";

/// Macros of the C library, by which any file may be preceded.
constexpr std::string_view kMacros =
    " NULL NAN INFINITY HUGE_VAL HUGE_VALF HUGE_VALL EOF BUFSIZ FILENAME_MAX FOPEN_MAX L_tmpnam "
    "SEEK_SET SEEK_CUR SEEK_END TMP_MAX RAND_MAX EXIT_SUCCESS EXIT_FAILURE MB_CUR_MAX "
    "CLOCKS_PER_SEC TIME_UTC errno EDOM ERANGE EILSEQ assert offsetof setjmp stdin stdout stderr "
    "va_arg va_copy va_end va_start math_errhandling MATH_ERRNO MATH_ERREXCEPT FP_INFINITE FP_NAN "
    "FP_NORMAL FP_SUBNORMAL FP_ZERO FP_ILOGB0 FP_ILOGBNAN CHAR_BIT CHAR_MAX CHAR_MIN SCHAR_MAX "
    "SCHAR_MIN UCHAR_MAX SHRT_MAX SHRT_MIN USHRT_MAX INT_MAX INT_MIN UINT_MAX LONG_MAX LONG_MIN "
    "ULONG_MAX LLONG_MAX LLONG_MIN ULLONG_MAX SIZE_MAX PTRDIFF_MAX PTRDIFF_MIN DBL_EPSILON DBL_MAX "
    "DBL_MIN DBL_DIG FLT_EPSILON FLT_MAX FLT_MIN FLT_DIG LDBL_EPSILON LDBL_MAX LDBL_MIN LDBL_DIG "
    "FLT_RADIX SIG_DFL SIG_ERR SIG_IGN SIGABRT SIGFPE SIGILL SIGINT SIGSEGV SIGTERM M_E M_LOG2E "
    "M_LOG10E M_LN2 M_LN10 M_PI M_PI_2 M_PI_4 M_1_PI M_2_PI M_2_SQRTPI M_SQRT2 M_SQRT1_2 ";

constexpr std::string_view kMatlab =
    " break case catch classdef continue else elseif end for function global if otherwise parfor "
    "persistent return spmd switch try while do until unwind_protect unwind_protect_cleanup "
    "end_try_catch end_unwind_protect endclassdef endenumeration endevents endfor endfunction "
    "endif "
    "endmethods endparfor endproperties endspmd endswitch endwhile zeros ";

constexpr std::string_view kPython =
    " False None True and as assert async await break class continue def del elif else except "
    "finally for from global if import in is lambda nonlocal not or pass raise return try while "
    "with yield numpy pathlib abc argparse ast bisect builtins collections contextlib contextvars "
    "copy ctypes datetime decimal dis enum errno fnmatch functools glob hashlib hmac importlib "
    "inspect io itertools json keyword linecache locale logging math ntpath numbers opcode "
    "operator "
    "os pickle platform posixpath pprint queue random re secrets select selectors shutil signal "
    "site "
    "socket stat string struct subprocess sys sysconfig tempfile textwrap threading time token "
    "tokenize traceback types typing unittest urllib uuid warnings weakref zipfile zlib ";

bool contains(std::string_view words, std::string_view word) {
  return words.find(" " + std::string(word) + " ") != std::string_view::npos;
}

/// True if the text begins with a word of the list.
bool begins_with_one(std::string_view words, std::string_view text) {
  for (std::size_t i = 1; i <= text.size(); ++i)
    if (contains(words, text.substr(0, i))) return true;
  return false;
}

/// fopen64 of fopen, strtof32_l of strtof; of functions for double also sinf, sinl.
bool is_variant(std::string_view text) {
  for (const std::string_view ending :
       {"64", "_l", "_r", "_unlocked", "f32", "f64", "f128", "f32x", "f64x", "f", "l"}) {
    if (!text.ends_with(ending)) continue;
    const std::string_view stem = text.substr(0, text.size() - ending.size());
    if (contains(kMath, stem) || contains(kMacros, stem)) return true;
    if (ending != "f" && ending != "l" && contains(kGlobal, stem)) return true;
  }
  return false;
}

bool is_letter_or_digit(char c) {
  return c == '_' || (static_cast<unsigned char>(c) < 0x80 && std::isalnum(c));
}

}  // namespace

bool is_identifier(std::string_view text, Language language) {
  if (text.empty() || !std::all_of(text.begin(), text.end(), is_letter_or_digit) ||
      text[0] == '_' || std::isdigit(text[0]))
    return false;
  switch (language) {
    case Language::cpp:
      return text.find("__") == std::string_view::npos && !contains(kCpp, text) &&
             !contains(kMacros, text);
    case Language::matlab: return text.size() <= 63 && !contains(kMatlab, text);
    case Language::python: return !contains(kPython, text);
  }
  return false;
}

bool is_namespace(std::string_view text) {
  return is_identifier(text) && !contains(kGlobal, text) && !contains(kMath, text) &&
         !is_variant(text) && !begins_with_one(kFamilies, text);
}

}  // namespace titop::emit
