#include <algorithm>
#include <cctype>
#include <string>
#include <titop/compiler/emit/identifier.hpp>

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

/// Functions with a sister for float (f behind) and one for long double (l).
constexpr std::string_view kMath =
    " acos acosh asin asinh atan atan2 atanh cbrt ceil copysign cos cosh erf erfc exp exp2 expm1 "
    "fabs fdim floor fma fmax fmin fmod frexp hypot ilogb ldexp lgamma llrint llround log log10 "
    "log1p log2 logb lrint lround modf nan nearbyint nextafter nexttoward pow remainder remquo "
    "rint round scalbln scalbn sin sinh sqrt tan tanh tgamma trunc ";

/// What else the C library and the headers of POSIX that the C++ library includes declare, and the
/// namespaces of those who may be in the same program.
constexpr std::string_view kGlobal =
    " abort abs access acct alarm asctime atexit atof atoi atol atoll bcmp bcopy bsearch bzero "
    "calloc chdir chown clearerr clock close confstr crypt ctime difftime div double_t drand48 dup "
    "dup2 environ erand48 exit fclose feof ferror fflush ffs fgetc fgetpos fgets fileno float_t "
    "fopen fork fprintf fputc fputs fpos_t fread free freopen fscanf fseek fsetpos ftell fwrite "
    "gamma getc getchar getenv gethostname getopt getpid gets getw gmtime imaxabs imaxdiv index "
    "isalnum isalpha isatty isblank iscntrl isdigit isgraph islower isprint ispunct isspace "
    "isupper "
    "isxdigit j0 j1 jn jrand48 kill killpg labs ldiv link llabs lldiv localeconv localtime lockf "
    "lrand48 lseek malloc max_align_t mblen mbstowcs mbtowc memchr memcmp memcpy memmove memset "
    "mktime mrand48 nice nullptr_t pause pclose perror pipe popen pread printf ptrdiff_t putc "
    "putchar putenv puts putw pwrite qsort quick_exit raise rand random read readlink realloc "
    "remove rename rewind rindex rmdir sbrk scanf setbuf setenv setlocale setvbuf sigaction signal "
    "significand sigpause size_t sleep snprintf sprintf srand srandom sscanf stime strcat strchr "
    "strcmp strcoll strcpy strcspn strdup strerror strftime strlen strncat strncmp strncpy strpbrk "
    "strrchr strsep strspn strstr strtod strtof strtok strtol strtold strtoll strtoul strtoull "
    "strxfrm swab symlink sync syscall sysconf system time time_t timer_t timezone tm tmpfile "
    "tmpnam "
    "tolower toupper truncate tzname tzset ungetc unlink usleep valloc vfork vfprintf vprintf "
    "vsprintf wait wcstombs wctomb write y0 y1 yn daylight drem doctest titop ";

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
  if (!is_identifier(text) || contains(kGlobal, text) || contains(kMath, text)) return false;
  const bool sister = text.back() == 'f' || text.back() == 'l';
  return !sister || !contains(kMath, text.substr(0, text.size() - 1));
}

}  // namespace titop::emit
