#include "generate/command.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <filesystem>
#include <fstream>
#include <stdexcept>
#include <titop/graph/error.hpp>

#include "generate/generate.hpp"

namespace titop::generate {
namespace {

/// The words one after the other.
class CommandWords {
 public:
  explicit CommandWords(const std::vector<std::string>& all) : all_(all) {}
  bool more() const { return at_ < all_.size(); }
  const std::string& next() {
    if (!more()) throw std::invalid_argument(fmt::format("{} needs more", all_.back()));
    return all_[at_++];
  }
  int number(int low, int high) {
    const std::string& text = next();
    int value = 0;
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
    if (error != std::errc() || end != text.data() + text.size() || value < low || value > high)
      throw std::invalid_argument(
          fmt::format("'{}' is no whole number from {} to {}", text, low, high));
    return value;
  }
  /// Its place among these.
  template <class Enum>
  Enum one_of(std::initializer_list<const char*> names) {
    const std::string& text = next();
    const auto found = std::find(names.begin(), names.end(), text);
    if (found == names.end())
      throw std::invalid_argument(
          fmt::format("'{}' is none of {}", text, fmt::join(names.begin(), names.end(), ", ")));
    return static_cast<Enum>(found - names.begin());
  }

 private:
  const std::vector<std::string>& all_;
  std::size_t at_ = 0;
};

bool option(const std::string& word, CommandWords& words, GenerateOptions& o) {
  if (word == "--seed") {
    o.seed = static_cast<std::uint64_t>(words.number(0, 2000000000));
  } else if (word == "--family") {
    o.family = words.one_of<Family>({"scalar", "spatial"});
  } else if (word == "--shape") {
    o.shape = words.one_of<Shape>({"chain", "tree", "star"});
  } else if (word == "--damping") {
    o.damping = words.one_of<Damping>({"none", "some", "all"});
  } else if (word == "--bodies") {
    o.bodies = words.number(1, 100);
  } else if (word == "--loops") {
    o.loops = words.number(0, 100);
  } else if (word == "--stiffness") {
    o.stiffness_low = words.number(-20, 40);
    o.stiffness_high = words.number(o.stiffness_low + 1, 41);
  } else if (word == "--states") {
    o.states = words.number(1, 12);
  } else if (word == "--no-controllers") {
    o.controllers = false;
  } else if (word == "--twins") {
    o.twins = true;
  } else if (word == "--mistake") {
    o.mistake = words.next();
  } else {
    return false;
  }
  return true;
}

void write(const std::filesystem::path& path, const std::string& content) {
  std::ofstream file(path, std::ios::binary);
  file << content;
  file.flush();
  if (!file)
    throw Error(Code::bad_file, fmt::format("{}: cannot be written", path.string()),
                "check that the folder exists and may be written to");
}

}  // namespace

void command(const std::vector<std::string>& all) {
  GenerateOptions options;
  std::vector<std::filesystem::path> files;
  for (CommandWords words(all); words.more();) {
    const std::string& word = words.next();
    if (option(word, words, options)) continue;
    if (word.starts_with("--"))
      throw std::invalid_argument(fmt::format("there is no option {}", word));
    files.emplace_back(word);
  }
  const bool family_given = std::find(all.begin(), all.end(), "--family") != all.end();
  if (!family_given && needs_space(options.mistake)) options.family = Family::spatial;
  if (files.size() != 1 || files[0].extension() != ".json")
    throw std::invalid_argument("generate takes one file, DIAGRAM.json");
  const Generated g = generate(options);
  const std::filesystem::path folder = files[0].parent_path();
  const std::string name = files[0].stem().string();
  write(files[0], text(g.scene));
  write(folder / (name + ".answer.json"), text(g.answer));
  write(folder / (name + "_test.cpp"), test_source(g, files[0].filename().string()));
}

}  // namespace titop::generate
