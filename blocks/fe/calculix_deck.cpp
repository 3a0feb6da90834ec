#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <titop/blocks/fe/calculix.hpp>
#include <titop/blocks/fe/modal_checks.hpp>
#include <titop/blocks/fe/text_file.hpp>

/// read_calculix_deck: node and degree of freedom of the matrices' rows.
namespace titop::fe {

namespace {

/// A keyword with its parameters; CalculiX ignores case and blanks in it.
struct Card {
  std::string keyword;                            ///< "*NODE"
  std::map<std::string, std::string> parameters;  ///< "REFNODE" -> "900001"
  int line = 0;
};

std::string normal(std::string_view text) {
  std::string result;
  for (const char c : text)
    if (c != ' ' && c != '\t')
      result += static_cast<char>(std::toupper(static_cast<unsigned char>(c)));
  return result;
}

/// Element types that CalculiX expands to solids: B31, S8R, M3D4, T3D2, CPS4, CPE4, CAX4, ...
bool is_expanded(std::string_view type) {
  for (const char* kind :
       {"B2", "B3", "S3", "S4", "S6", "S8", "M3D", "T2D", "T3D", "CPS", "CPE", "CAX"})
    if (type.starts_with(kind)) return true;
  return false;
}

bool is_comment(std::string_view text) { return text.starts_with("**"); }

class DeckReader {
 public:
  explicit DeckReader(const std::filesystem::path& path)
      : file_(read_text(path)), lines_(lines_of(file_)) {}

  CalculixDeck read() {
    require_text(file_);
    Card card;
    while (at_ < lines_.size()) {
      const TextLine line = lines_[at_++];
      if (is_comment(line.text) || trim(line.text).empty()) continue;
      if (line.text.starts_with('*')) {
        card = read_card(line);
        if (card.keyword == "*RIGIDBODY") read_rigid_body(card);
        note_own_nodes(card);
      } else if (card.keyword == "*NODE") {
        read_node(line);
      } else if (card.keyword == "*ELASTIC") {
        read_elastic(card, line);
      }
    }
    if (deck_.nodes.empty() && mistakes_.empty())
      mistakes_.add(bad_line(file_, 0, "no *NODE with positions", "the deck of the matrices"));
    mistakes_.finish();
    return std::move(deck_);
  }

 private:
  /// A keyword line that ends in a comma continues in the next line.
  Card read_card(const TextLine& first) {
    std::string text = normal(first.text);
    while (text.ends_with(',') && at_ < lines_.size()) text += normal(lines_[at_++].text);
    Card card;
    card.line = first.number;
    const auto fields = comma_fields(text);
    card.keyword = fields.front();
    for (std::size_t i = 1; i < fields.size(); ++i) {
      const auto equals = fields[i].find('=');
      const bool has_value = equals != std::string_view::npos;
      card.parameters[std::string(fields[i].substr(0, equals))] =
          has_value ? fields[i].substr(equals + 1) : std::string_view();
    }
    if (card.keyword == "*INCLUDE")
      mistakes_.add(bad_line(file_, card.line, "*INCLUDE", "the included lines in its place"));
    if (card.keyword == "*NODE")
      for (const auto& [name, value] : card.parameters)
        if (name != "NSET")
          mistakes_.add(bad_line(file_, card.line, fmt::format("*NODE parameter {}", name),
                                 "NSET only: this reader does not support others"));
    return card;
  }

  void note_own_nodes(const Card& card) {
    const auto type = card.parameters.find("TYPE");
    const bool expanded =
        card.keyword == "*ELEMENT" && type != card.parameters.end() && is_expanded(type->second);
    if (expanded)
      deck_.makes_nodes.push_back(
          fmt::format("*ELEMENT, TYPE={} (line {})", type->second, card.line));
    if (card.keyword.ends_with("COUPLING"))
      deck_.makes_nodes.push_back(fmt::format("{} (line {})", card.keyword, card.line));
  }

  /// E, nu, temperature; for other types of elasticity another order.
  void read_elastic(const Card& card, const TextLine& line) {
    const auto type = card.parameters.find("TYPE");
    double E = 0;
    if ((type != card.parameters.end() && type->second != "ISO" && type->second != "ISOTROPIC") ||
        !parse(comma_fields(line.text).front(), E))
      return;
    deck_.least_E = std::min(E, deck_.least_E.value_or(E));
  }

  void read_node(const TextLine& line) {
    auto fields = comma_fields(line.text);
    if (fields.size() == 5 && fields.back().empty()) fields.pop_back();
    int node = 0;
    Vector3d position;
    const std::string found = fmt::format("'{}'", trim(line.text));
    if (fields.size() != 4 || !parse(fields[0], node) || node <= 0 ||
        !parse(fields[1], position.x()) || !parse(fields[2], position.y()) ||
        !parse(fields[3], position.z())) {
      mistakes_.add(bad_line(file_, line.number, found, "node, x, y, z with finite numbers"));
      return;
    }
    const auto [at, is_new] = deck_.nodes.insert({node, position});
    if (!is_new && at->second != position)
      mistakes_.add(bad_line(file_, line.number, found,
                             fmt::format("one position per node: node {} was at {}, {}, {}", node,
                                         at->second.x(), at->second.y(), at->second.z())));
  }

  void read_rigid_body(const Card& card) {
    CalculixDeck::RigidConstraint body;
    body.line = card.line;
    for (const auto& [name, node] :
         {std::pair{"REF NODE", &body.ref_node}, std::pair{"ROT NODE", &body.rot_node}}) {
      const auto at = card.parameters.find(normal(name));
      if (at != card.parameters.end() && parse(std::string_view(at->second), *node)) continue;
      mistakes_.add(bad_line(file_, card.line, fmt::format("a *RIGID BODY without {}", name),
                             "REF NODE= and ROT NODE= with node numbers, so that its rows can be "
                             "told from others"));
      return;
    }
    for (const auto& other : deck_.rigid_bodies)
      if (other.ref_node == body.ref_node || other.rot_node == body.rot_node ||
          other.rot_node == body.ref_node || other.ref_node == body.rot_node)
        mistakes_.add(bad_line(file_, card.line,
                               fmt::format("nodes {} and {}, of which line {} uses one",
                                           body.ref_node, body.rot_node, other.line),
                               "different nodes for different rigid bodies"));
    if (body.ref_node == body.rot_node)
      mistakes_.add(bad_line(file_, card.line,
                             fmt::format("node {} as REF NODE and ROT NODE", body.ref_node),
                             "two different nodes"));
    deck_.rigid_bodies.push_back(body);
  }

  TextFile file_;
  std::vector<TextLine> lines_;
  std::size_t at_ = 0;
  CalculixDeck deck_;
  FileMistakes mistakes_;
};

}  // namespace

std::vector<std::string> implausible(const CalculixDeck& deck) {
  return deck.least_E ? implausible_modulus(*deck.least_E) : std::vector<std::string>{};
}

CalculixDeck read_calculix_deck(const std::filesystem::path& path) {
  return DeckReader(path).read();
}

}  // namespace titop::fe
