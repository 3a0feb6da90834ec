#include <fmt/format.h>

#include <map>
#include <titop/blocks/fe/bulk_cards.hpp>
#include <titop/blocks/fe/bulk_data.hpp>
#include <titop/blocks/fe/coordinate_systems.hpp>
#include <titop/blocks/fe/fortran.hpp>

namespace titop::fe {

namespace {

using detail::BulkCard;

/// The cards of a file that place grids.
class BulkReader {
 public:
  explicit BulkReader(const TextFile& file) : file_(file) {
    require_text(file);
    for (BulkCard& card : detail::bulk_cards(file)) sort(std::move(card));
    for (const auto& [id, card] : grid_cards_) systems_.grids[id] = grid_card(card);
    for (const auto& [id, card] : grid_cards_) place(id, card);
    if (grids_.empty() && mistakes_.empty())
      mistakes_.add(bad_line(file_, 0, "no GRID",
                             "the bulk data of the model, or the .asm that "
                             "EXTSEOUT(ASMBULK) writes"));
    mistakes_.finish();
  }

  std::vector<Grid> grids() && { return std::move(grids_); }

 private:
  void mistake(const BulkCard& card, std::string_view found, const std::string& expected) {
    mistakes_.add(
        bad_line(file_, card.line, fmt::format("'{}' in {}", found, card.name), expected));
  }

  /// A blank field is 0.
  int integer(const BulkCard& card, std::size_t i) {
    int value = 0;
    if (!card.field(i).empty() && !parse(card.field(i), value))
      mistake(card, card.field(i), fmt::format("an integer in field {}", i + 2));
    return value;
  }
  Vector3d point(const BulkCard& card, std::size_t first) {
    Vector3d p = Vector3d::Zero();
    for (std::size_t i = 0; i < 3; ++i) {
      const std::string_view text = card.field(first + i);
      double value = 0;
      if (!text.empty() && !parse_fortran(text, value))
        mistake(card, text, fmt::format("a number in field {}", first + i + 2));
      p(static_cast<Eigen::Index>(i)) = value;
    }
    return p;
  }

  /// The last one of those that are read and must be there.
  static std::size_t last_field(const BulkCard& card) {
    if (card.name.starts_with("CORD2")) return 8;
    if (card.name.starts_with("CORD1")) return 3;
    return card.name == "GRID" && !card.mark.empty() ? 4 : 0;
  }

  detail::GridCard grid_card(const BulkCard& card) {
    const int in = integer(card, 1), moves = integer(card, 5);
    return {in, point(card, 2), moves};
  }

  void sort(BulkCard card) {
    if (card.name == "INCLUDE" || card.name == "GRDSET")
      return mistake(card, card.name, "its text, or its effect, in the GRIDs of this file");
    const bool grid = card.name == "GRID";
    if (!grid && !card.name.starts_with("CORD")) return;
    if (!card.mistake.empty())
      mistakes_.add(bad_line(file_, card.line, fmt::format("{} in {}", card.mistake, card.name),
                             "each line with its fields alone, in columns without tabs or between "
                             "commas, each continuation right behind its line, with the same "
                             "mark"));
    if (card.fields.size() <= last_field(card))
      mistakes_.add(bad_line(file_, card.line, fmt::format("no continuation of {}", card.name),
                             "it right behind its line"));
    add(card, 0, grid ? grid_cards_ : system_cards_);
    // A second system in the same card.
    if (card.name.starts_with("CORD1") && !card.field(4).empty()) add(card, 4, system_cards_);
  }

  /// The card whose number is in this field.
  void add(const BulkCard& card, std::size_t first, std::map<int, BulkCard>& cards) {
    const int id = integer(card, first);
    if (id < 1) return mistake(card, card.field(first), "a number above 0");
    const auto [at, is_new] = cards.insert({id, card});
    if (!is_new && (at->second.fields != card.fields || at->second.name != card.name))
      mistake(card, card.field(first),
              fmt::format("the data of line {}, or another number", at->second.line));
    if (is_new && card.name != "GRID") add_system(card, first, id);
  }

  void add_system(const BulkCard& card, std::size_t first, int id) {
    using detail::SystemKind;
    static const std::map<char, SystemKind> kinds = {{'R', SystemKind::rectangular},
                                                     {'C', SystemKind::cylindrical},
                                                     {'S', SystemKind::spherical}};
    const auto kind = card.name.size() == 6 ? kinds.find(card.name[5]) : kinds.end();
    if (kind == kinds.end() || (card.name[4] != '1' && card.name[4] != '2')) {
      systems_.others[id] = card.name;
      return;
    }
    detail::SystemCard& system = systems_.systems[id];
    system.kind = kind->second;
    if (card.name[4] == '1') {
      system.grids = {integer(card, first + 1), integer(card, first + 2), integer(card, first + 3)};
      return;
    }
    system.in = integer(card, 1);
    for (std::size_t i = 0; i < 3; ++i) system.points.at(i) = point(card, 2 + 3 * i);
  }

  void place(int id, const BulkCard& card) {
    std::string why;
    if (const auto grid = systems_.place(id, why))
      grids_.push_back(*grid);
    else
      mistakes_.add(bad_line(file_, card.line, why,
                             "a CORD1R, CORD1C, CORD1S, CORD2R, CORD2C or CORD2S in this file"));
  }

  const TextFile& file_;
  FileMistakes mistakes_;
  std::map<int, BulkCard> grid_cards_, system_cards_;
  detail::CoordinateSystems systems_;
  std::vector<Grid> grids_;
};

}  // namespace

std::vector<Grid> detail::grids_in(const TextFile& file) { return BulkReader(file).grids(); }

std::vector<Grid> read_grids(const std::filesystem::path& path) {
  return detail::grids_in(read_text(path));
}

}  // namespace titop::fe
