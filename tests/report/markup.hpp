#pragma once

#include <fmt/format.h>

#include <set>
#include <string>
#include <vector>

/// Reads HTML that is also XML, as our reports are.
namespace titop_test {

/// The first fault of the markup, "" if none: tags nest and close, attributes are quoted, ids are
/// unique, every & is an entity.
inline std::string complaint(const std::string& text) {
  const auto near = [&](const char* subject, std::size_t at) {
    return fmt::format("{}: {}", subject, text.substr(at, 60));
  };
  std::vector<std::string> open;
  std::set<std::string> ids;
  std::size_t at = text.find("<html");
  if (text.rfind("<!DOCTYPE html>", 0) != 0 || at == std::string::npos) return "no HTML";
  for (; at < text.size(); ++at) {
    if (text[at] == '&') {
      const std::size_t end = text.find_first_not_of(
          "#abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789", at + 1);
      if (end == std::string::npos || end == at + 1 || text[end] != ';') return near("&", at);
    }
    if (text[at] == '>') return near("a stray >", at);
    if (text[at] != '<') continue;
    const std::size_t start = at;
    std::size_t name_end = text.find_first_of(" />\n", at + 2);
    const std::string name = text.substr(at + 1, name_end - at - 1);
    if (name.empty() || name[0] == '!' || name[0] == '?') return near("no tag", at);
    if (name[0] == '/') {
      if (open.empty() || "/" + open.back() != name) return near("closes another", at);
      open.pop_back();
      at = text.find('>', at);
      continue;
    }
    for (at = name_end; text[at] != '>' && text[at] != '/';) {
      at = text.find_first_not_of(" \n", at);
      if (text[at] == '>' || text[at] == '/') break;
      const std::size_t equals = text.find('=', at);
      const std::string attribute = text.substr(at, equals - at);
      if (attribute.find_first_of(" <>\"/") != std::string::npos || text[equals + 1] != '"')
        return near("attribute", start);
      const std::size_t close = text.find('"', equals + 2);
      const std::string value = text.substr(equals + 2, close - equals - 2);
      if (value.find('<') != std::string::npos) return near("< in an attribute", start);
      if (attribute == "id" && !ids.insert(value).second) return near("an id twice", start);
      at = close + 1;
    }
    if (text[at] == '/') {
      if (text[++at] != '>') return near("/", start);
    } else if (name == "style") {  // CSS has > of its own
      at = text.find("</style>", at) + 7;
    } else {
      open.push_back(name);
    }
  }
  return open.empty() ? "" : "not closed: " + open.back();
}

/// All texts between `open` and the next `close` behind it.
inline std::vector<std::string> between(const std::string& text, const std::string& open,
                                        const std::string& close) {
  std::vector<std::string> found;
  for (std::size_t at = text.find(open); at != std::string::npos; at = text.find(open, at)) {
    at += open.size();
    const std::size_t end = text.find(close, at);
    found.push_back(text.substr(at, end - at));
  }
  return found;
}

/// The page's section with this id; "" if there is none, or more than one.
inline std::string section(const std::string& page, const std::string& id) {
  const auto found = between(page, "<section id=\"" + id + "\">", "</section>");
  return found.size() == 1 ? found.front() : "";
}

/// One line of the page's head: its class, good, bad or open, and its text.
struct Verdict {
  std::string cls, html;
};

/// The head's lines: the first is on stability, then come all faults, bad, or one line, good; the
/// order; and warnings of the log.
inline std::vector<Verdict> verdicts(const std::string& page) {
  std::vector<Verdict> found;
  for (const std::string& list : between(page, "<ul class=\"verdicts\">\n", "</ul>"))
    for (const std::string& line : between(list, "<li class=\"", "</li>"))
      found.push_back({line.substr(0, line.find('"')), line.substr(line.find('>') + 1)});
  return found;
}

inline std::size_t count(const std::string& text, const std::string& part) {
  std::size_t n = 0;
  for (std::size_t at = text.find(part); at != std::string::npos; at = text.find(part, at + 1)) ++n;
  return n;
}

inline bool has(const std::string& text, const std::string& part) {
  return text.find(part) != std::string::npos;
}

}  // namespace titop_test
