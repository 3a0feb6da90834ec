#include <titop/emit/files/files.hpp>

namespace titop {

std::vector<std::string> dense_warnings(const System& system) {
  system.state_space();
  std::vector<std::string> list;
  for (Note& n : system.dense_notes())
    if (n.kind == Note::Kind::warning) list.push_back(std::move(n.text));
  return list;
}

}  // namespace titop
