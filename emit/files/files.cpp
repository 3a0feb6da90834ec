#include <titop/emit/files/files.hpp>

namespace titop {

std::vector<std::string> dense_warnings(const System& system) {
  std::vector<std::string> list;
  for (const Note& n : system.dense_notes())
    if (n.kind == Note::Kind::warning) list.push_back(n.text);
  return list;
}

}  // namespace titop
