#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <titop/blocks/fe/bulk_cards.hpp>

namespace titop::fe::detail {

namespace {

std::string upper(std::string_view text) {
  std::string result(text);
  for (char& c : result) c = static_cast<char>(std::toupper(static_cast<unsigned char>(c)));
  return result;
}

/// A continuation's mark without blanks, + and *.
std::string mark_in(std::string_view text) {
  text = trim(text);
  if (text.starts_with('+') || text.starts_with('*')) text.remove_prefix(1);
  return upper(trim(text));
}

/// A line in fields of columns: its first one, then eight or four.
std::vector<std::string_view> column_fields(std::string_view text, std::size_t count) {
  const auto piece = [&](std::size_t at, std::size_t width) {
    return at < text.size() ? trim(text.substr(at, width)) : std::string_view();
  };
  std::vector<std::string_view> fields = {piece(0, 8)};
  for (std::size_t i = 0; i < count; ++i) fields.push_back(piece(8 + i * 64 / count, 64 / count));
  fields.push_back(piece(72, 8));
  return fields;
}

/// Data behind the eight or four fields of a line, where a mark may be.
std::string_view data_behind(const std::vector<std::string_view>& fields, std::size_t count) {
  for (std::size_t i = count + 1; i < fields.size(); ++i)
    if (!fields[i].empty() &&
        (i > count + 1 || std::string_view("+*").find(fields[i][0]) == std::string_view::npos))
      return fields[i];
  return {};
}

/// Fields of a line: its first one is the card's name, or the mark of a continuation.
void add_line(std::string_view text, BulkCard& card, bool continuation) {
  const bool wide = text.substr(0, 8).find('*') != std::string_view::npos;
  const std::size_t count = wide ? 4 : 8;
  const bool free = text.find(',') != std::string_view::npos;
  std::vector<std::string_view> fields = free ? comma_fields(text) : column_fields(text, count);
  if (!free && text.find('\t') != std::string_view::npos) card.mistake = "a tab";
  if (const std::string_view data = data_behind(fields, count); free && !data.empty())
    card.mistake = fmt::format("'{}' behind {} fields", data, count);
  if (const std::string mark = mark_in(fields[0]);
      continuation && !mark.empty() && mark != card.mark)
    card.mistake = fmt::format("the continuation '{}' behind the mark '{}'", mark, card.mark);
  fields.resize(count + 2);
  card.mark = mark_in(fields[count + 1]);
  card.fields.insert(card.fields.end(), fields.begin() + 1, fields.end() - 1);
}

/// Blank or a mark in the first field.
bool continues(std::string_view text) {
  return !text.empty() && std::string_view("+* ,\t").find(text[0]) != std::string_view::npos;
}

std::string name_of_card(std::string_view text) {
  const auto end = text.find_first_of(" ,*\t");
  return upper(text.substr(0, std::min<std::size_t>(end, 8)));
}

}  // namespace

std::vector<BulkCard> bulk_cards(const TextFile& file) {
  std::vector<TextLine> lines = lines_of(file);
  const auto begin = std::ranges::find_if(lines, [](const TextLine& line) {
    const auto fields = words(line.text);
    return fields.size() > 1 && upper(fields[0]) == "BEGIN" && upper(fields[1]).starts_with("BULK");
  });
  if (begin != lines.end()) lines.erase(lines.begin(), begin + 1);
  std::vector<BulkCard> cards;
  bool open = false;
  for (const TextLine& line : lines) {
    const std::string_view text = line.text.substr(0, line.text.find('$'));
    if (trim(text).empty()) continue;
    if (continues(text)) {
      if (open) add_line(text, cards.back(), true);
      continue;
    }
    const std::string name = name_of_card(text);
    if (name == "ENDDATA") break;
    open = std::isalpha(static_cast<unsigned char>(text[0])) != 0;
    if (!open) continue;
    cards.push_back({name, {}, line.number});
    add_line(text, cards.back(), false);
  }
  return cards;
}

}  // namespace titop::fe::detail
