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
    if (card.name == "CORD2R") return 8;
    return card.name == "GRID" && !card.mark.empty() ? 4 : 0;
  }

  void sort(BulkCard card) {
    if (card.name == "INCLUDE" || card.name == "GRDSET")
      return mistake(card, card.name, "its text, or its effect, in the GRIDs of this file");
    const bool grid = card.name == "GRID";
    if (!grid && !card.name.starts_with("CORD")) return;
    if (!card.mistake.empty())
      mistakes_.add(bad_line(file_, card.line, fmt::format("{} in {}", card.mistake, card.name),
                             "each line with its fields alone, each continuation right behind its "
                             "line, with the same mark"));
    if (card.fields.size() <= last_field(card))
      mistakes_.add(bad_line(file_, card.line, fmt::format("no continuation of {}", card.name),
                             "it right behind its line"));
    const int id = integer(card, 0);
    if (id < 1) return mistake(card, card.field(0), "a number above 0");
    const auto [at, is_new] = (grid ? grid_cards_ : system_cards_).insert({id, card});
    if (!is_new && (at->second.fields != card.fields || at->second.name != card.name))
      mistake(card, card.field(0),
              fmt::format("the data of line {}, or another number", at->second.line));
    if (!is_new || grid) return;
    if (card.name == "CORD2R")
      systems_.rectangular[id] = {integer(card, 1), point(card, 2), point(card, 5), point(card, 8)};
    else
      systems_.others[id] = card.name;
  }

  void place(int id, const BulkCard& card) {
    const detail::Axes* in = system(card, integer(card, 1));
    const detail::Axes* moves = system(card, integer(card, 5));
    const Vector3d p = point(card, 2);
    if (in && moves) grids_.push_back(detail::placed_grid(id, p, *in, *moves));
  }

  /// Null, with a mistake noted, for one that is not there.
  const detail::Axes* system(const BulkCard& user, int id) {
    std::string why;
    const detail::Axes* axes = systems_.find(id, why);
    if (!axes)
      mistakes_.add(bad_line(file_, user.line, why,
                             "a CORD2R, relative to another one or to the basic system"));
    return axes;
  }

  const TextFile& file_;
  FileMistakes mistakes_;
  std::map<int, BulkCard> grid_cards_, system_cards_;
  detail::CoordinateSystems systems_;
  std::vector<Grid> grids_;
};

}  // namespace

std::vector<Grid> read_grids(const std::filesystem::path& path) {
  const TextFile file = read_text(path);
  return BulkReader(file).grids();
}

}  // namespace titop::fe
