#include <sstream>
#include <titop/compiler/emit/report/times.hpp>

namespace titop::report {

std::vector<std::pair<std::string, double>> seconds(const System& system) {
  std::vector<std::pair<std::string, double>> list;
  std::istringstream text(system.timings());
  std::string pass, unit;
  for (double value = 0; text >> pass >> value >> unit;) list.emplace_back(pass, 1e-6 * value);
  return list;
}

std::vector<Note> dense_notes(const System& system) {
  std::vector<Note> list;
  std::istringstream text(system.log());
  for (std::string line; std::getline(text, line);) {
    std::istringstream words(line);
    Note note;
    std::string kind;
    words >> note.pass >> kind >> std::ws;
    std::getline(words, note.text);
    if (kind == "warning") note.kind = Note::Kind::warning;
    if (!line.starts_with("  ")) continue;
    if (note.pass == "dense" || note.pass == "minimize") list.push_back(note);
  }
  return list;
}

}  // namespace titop::report
