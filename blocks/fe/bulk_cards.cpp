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

/// Fields of a line without the first, the card's name or a continuation mark: eight or four.
void add_line(std::string_view text, BulkCard& card) {
  const std::string_view head = text.substr(0, std::min<std::size_t>(text.size(), 8));
  if (text.find(',') != std::string_view::npos) {
    std::vector<std::string_view> fields = comma_fields(text);
    const std::size_t count = head.find('*') != std::string_view::npos ? 4 : 8;
    fields.erase(fields.begin());
    fields.resize(count);  // the mark of the continuation goes
    card.fields.insert(card.fields.end(), fields.begin(), fields.end());
    return;
  }
  const bool wide = head.find('*') != std::string_view::npos;
  const std::size_t width = wide ? 16 : 8, count = wide ? 4 : 8;
  for (std::size_t i = 0; i < count; ++i) {
    const std::size_t at = 8 + i * width;
    card.fields.push_back(at < text.size() ? trim(text.substr(at, width)) : std::string_view());
  }
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
      if (open) add_line(text, cards.back());
      continue;
    }
    const std::string name = name_of_card(text);
    if (name == "ENDDATA") break;
    open = std::isalpha(static_cast<unsigned char>(text[0])) != 0;
    if (!open) continue;
    cards.push_back({name, {}, line.number});
    add_line(text, cards.back());
  }
  return cards;
}

}  // namespace titop::fe::detail
