#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <titop/graph/error.hpp>
#include <vector>

/// Common to readers of text files: lines with their numbers, numbers independent of the locale,
/// mistakes with file and line.
namespace titop::fe {

/// A line without its line end (LF or CRLF); number counts from 1.
struct TextLine {
  int number = 0;
  std::string_view text;
};

/// A whole text file in memory.
struct TextFile {
  std::string name;  ///< as in messages: the last part of the path
  std::string content;
  bool ends_in_line = true;  ///< the last line has its line end (true for an empty file)
};

/// Throws `bad_file` if the file cannot be opened or read, or is empty.
TextFile read_text(const std::filesystem::path& path);

/// Throws bad_file for a file with NUL bytes, such as binary OP4, and names its reader.
void require_text(const TextFile& file);

/// All lines, views into file.content: keep the file alive.
std::vector<TextLine> lines_of(const TextFile& file);

/// Pieces between blanks (spaces and tabs), none of them empty.
std::vector<std::string_view> words(std::string_view text);

/// Pieces between commas, trimmed; empty ones are kept.
std::vector<std::string_view> comma_fields(std::string_view text);

/// Without leading and trailing blanks.
std::string_view trim(std::string_view text);

/// Number in C notation, no more and no less ("1e3", "+2.5", ".5"); false if the text is anything
/// else, does not fit, or is infinite or not a number. Does not look at the locale.
bool parse(std::string_view text, double& value);
bool parse(std::string_view text, int& value);

/// Throws bad_file, "model.op2: found"; the hint is the way out.
[[noreturn]] void refuse_file(const std::string& name, const std::string& found,
                              const std::string& hint);

/// `bad_file`, "beam.sti:12: found ..., expected ...": the expected text is the way out. Line 0:
/// the whole file. Control characters of the found text become ?, beyond 2000 characters it is cut
/// short.
Mistake bad_line(const TextFile& file, int line, const std::string& found,
                 const std::string& expected);

/// Collects mistakes; after twenty the rest is only counted. `finish` throws them, if any.
class FileMistakes {
 public:
  void add(Mistake mistake);
  bool empty() const { return mistakes_.empty(); }
  void finish() const;

 private:
  std::vector<Mistake> mistakes_;
  int more_ = 0;
};

/// A last line without line end is a mistake: its last number may be cut short. A file that ends at
/// the end of one of its lines looks complete.
void require_line_end(const TextFile& file, FileMistakes& mistakes);

}  // namespace titop::fe
