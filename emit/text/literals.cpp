#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <set>
#include <stdexcept>
#include <titop/emit/text/identifier.hpp>
#include <titop/emit/text/literals.hpp>
#include <titop/graph/error.hpp>

namespace titop::emit {

namespace {

bool is_word(char c) { return std::isalnum(static_cast<unsigned char>(c)) || c == '_'; }

}  // namespace

std::string number(double x) {
  if (!std::isfinite(x))
    throw Error(Code::not_finite, fmt::format("generated code would contain the number {}", x),
                "a value of the model overflows: take other units");
  std::string text = fmt::format("{}", x);
  if (text.find_first_of(".e") == std::string::npos) text += ".0";
  return text;
}

std::string quoted(std::string_view text) {
  std::string result = "\"";
  for (const char c : text) {
    if (c == '"' || c == '\\') {
      result += '\\';
      result += c;
    } else if (static_cast<unsigned char>(c) < 0x20 || c == 0x7f) {
      // Octal: always three digits, so that the following text cannot belong to it.
      result += fmt::format("\\{:03o}", static_cast<unsigned char>(c));
    } else if (c == '?') {
      result += "\\?";  // no trigraphs
    } else {
      result += c;
    }
  }
  return result + "\"";
}

std::vector<std::string> identifiers(const std::vector<std::string>& names) {
  std::vector<std::string> result;
  std::set<std::string> taken;
  for (const std::string& name : names) {
    std::string word;
    for (const char c : name) {
      if (is_word(c) && c != '_')
        word += c;
      else if (!word.empty() && word.back() != '_')
        word += '_';
    }
    while (!word.empty() && word.back() == '_') word.pop_back();
    if (word.empty() || std::isdigit(static_cast<unsigned char>(word[0]))) word.insert(0, "n");
    if (!is_identifier(word)) word += "_";
    std::string unique = word;
    for (int i = 2; !taken.insert(unique).second; ++i) unique = fmt::format("{}_{}", word, i);
    result.push_back(std::move(unique));
  }
  return result;
}

std::string list(const std::vector<std::string>& items, int indent) {
  std::string text = "{";
  std::size_t column = static_cast<std::size_t>(indent) + 1;
  for (std::size_t i = 0; i < items.size(); ++i) {
    const std::string item = items[i] + (i + 1 < items.size() ? "," : "}");
    if (i > 0 && column + 1 + item.size() > 98) {
      text += fmt::format("\n{:{}}", "", indent);
      column = static_cast<std::size_t>(indent);
    } else if (i > 0) {
      text += ' ';
      ++column;
    }
    text += item;
    column += item.size();
  }
  return items.empty() ? "{}" : text;
}

std::string list(const Eigen::VectorXd& values, int indent) {
  std::vector<std::string> items;
  for (const double x : values) items.push_back(number(x));
  return list(items, indent);
}

std::string filled(std::string_view text,
                   const std::vector<std::pair<std::string_view, std::string>>& values) {
  std::string result;
  while (!text.empty()) {
    const auto at = text.find('@');
    result += text.substr(0, at);
    if (at == std::string_view::npos) break;
    text.remove_prefix(at + 1);
    const std::string_view key = text.substr(0, text.find('@'));
    const auto found = std::find_if(values.begin(), values.end(),
                                    [&](const auto& value) { return value.first == key; });
    if (found == values.end()) throw std::logic_error(fmt::format("no value for @{}@", key));
    result += found->second;
    text.remove_prefix(key.size() + 1);
  }
  return result;
}

}  // namespace titop::emit
