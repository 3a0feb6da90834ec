#include <fmt/format.h>

#include <charconv>
#include <cmath>
#include <fstream>
#include <iterator>
#include <titop/blocks/fe/text_file.hpp>

namespace titop::fe {

namespace {

constexpr std::string_view kBlanks = " \t";

/// from_chars takes no leading plus.
template <class Number>
bool parse_whole(std::string_view text, Number& value) {
  if (text.size() > 1 && text[0] == '+' && text[1] != '-') text.remove_prefix(1);
  const char* end = text.data() + text.size();
  const auto [stop, error] = std::from_chars(text.data(), end, value);
  return error == std::errc() && stop == end;
}

}  // namespace

TextFile read_text(const std::filesystem::path& path) {
  std::ifstream stream(path, std::ios::binary);
  std::error_code ignored;
  if (!stream || std::filesystem::is_directory(path, ignored))
    throw Error(Code::bad_file, fmt::format("{}: cannot be opened", path.string()),
                "check the path; without / at its front it starts from the working directory");
  TextFile file{path.filename().string(), {std::istreambuf_iterator<char>(stream), {}}, true};
  if (stream.bad())
    throw Error(Code::bad_file, fmt::format("{}: cannot be read", path.string()),
                "check the disk and the permissions");
  if (file.content.empty())
    throw Error(Code::bad_file, fmt::format("{}: the file is empty", path.string()),
                "let the program that wrote it run to its end");
  file.ends_in_line = file.content.back() == '\n';
  return file;
}

std::vector<TextLine> lines_of(const TextFile& file) {
  std::vector<TextLine> lines;
  std::string_view rest = file.content;
  for (int number = 1; !rest.empty(); ++number) {
    const auto end = rest.find('\n');
    std::string_view text = rest.substr(0, end);
    rest.remove_prefix(end == std::string_view::npos ? rest.size() : end + 1);
    if (!text.empty() && text.back() == '\r') text.remove_suffix(1);
    lines.push_back({number, text});
  }
  return lines;
}

std::string_view trim(std::string_view text) {
  const auto first = text.find_first_not_of(kBlanks);
  if (first == std::string_view::npos) return {};
  return text.substr(first, text.find_last_not_of(kBlanks) - first + 1);
}

std::vector<std::string_view> words(std::string_view text) {
  std::vector<std::string_view> result;
  while (!(text = trim(text)).empty()) {
    const auto end = text.find_first_of(kBlanks);
    result.push_back(text.substr(0, end));
    text.remove_prefix(result.back().size());
  }
  return result;
}

std::vector<std::string_view> comma_fields(std::string_view text) {
  std::vector<std::string_view> result;
  for (;;) {
    const auto comma = text.find(',');
    result.push_back(trim(text.substr(0, comma)));
    if (comma == std::string_view::npos) return result;
    text.remove_prefix(comma + 1);
  }
}

bool parse(std::string_view text, double& value) {
  double read = 0;
  if (!parse_whole(text, read) || !std::isfinite(read)) return false;
  value = read;
  return true;
}

bool parse(std::string_view text, int& value) { return parse_whole(text, value); }

void require_text(const TextFile& file) {
  const auto at = file.content.find('\0');
  if (at == std::string::npos) return;
  throw Error(Code::bad_file,
              fmt::format("{}: found a NUL byte at byte {}, expected text", file.name, at),
              "binary files of Nastran: read_op4 reads those of OUTPUT4");
}

namespace {

std::string printable(std::string text) {
  constexpr std::size_t most = 2000;
  if (text.size() > most) text = text.substr(0, most) + "...";
  for (char& c : text)
    if ((c >= 0 && c < ' ') || c == 0x7f) c = '?';
  return text;
}

}  // namespace

void refuse_file(const std::string& name, const std::string& found, const std::string& hint) {
  throw Error(Code::bad_file, fmt::format("{}: {}", name, found), hint);
}

Mistake bad_line(const TextFile& file, int line, const std::string& found,
                 const std::string& expected) {
  const std::string where =
      line > 0 ? fmt::format("{}:{}", file.name, line) : std::string(file.name);
  return {Code::bad_file,
          fmt::format("{}: found {}, expected {}", where, printable(found), expected),
          {},
          {}};
}

void FileMistakes::add(Mistake mistake) {
  if (mistakes_.size() < 20)
    mistakes_.push_back(std::move(mistake));
  else
    ++more_;
}

void require_line_end(const TextFile& file, FileMistakes& mistakes) {
  if (file.ends_in_line) return;
  const TextLine last = lines_of(file).back();
  mistakes.add(bad_line(file, last.number, fmt::format("'{}' without line end", last.text),
                        "a line end: the file may be truncated (add one if it is complete)"));
}

void FileMistakes::finish() const {
  if (mistakes_.empty()) return;
  std::vector<Mistake> all = mistakes_;
  if (more_ > 0) all.back().details.push_back(fmt::format("and {} more like these", more_));
  throw Error(std::move(all));
}

}  // namespace titop::fe
