#include <fmt/format.h>

#include <array>
#include <cmath>
#include <optional>
#include <titop/blocks/fe/coordinate_systems.hpp>
#include <titop/blocks/fe/op2_results.hpp>
#include <titop/blocks/fe/text_file.hpp>

/// op2_grids: cards of GEOM1, each record a key of three words and entries of one length.
namespace titop::fe {

namespace {

/// A record's first three words tell its card.
using Key = std::array<long long, 3>;

/// CORD1C, CORD1R, CORD1S by grids; CORD2C, CORD2R, CORD2S by points.
std::optional<detail::SystemKind> system_kind(long long code) {
  switch (code) {
    case 1801:
    case 2101: return detail::SystemKind::rectangular;
    case 1701:
    case 2001: return detail::SystemKind::cylindrical;
    case 1901:
    case 2201: return detail::SystemKind::spherical;
    default: return std::nullopt;
  }
}
constexpr long long kGrid = 4501, kFirstByPoints = 2001;

/// Reads a record word by word. Double reals take two words of 4 bytes, or one of 8.
class RecordReader {
 public:
  RecordReader(const Op2File& file, const std::string& bytes) : file_(file), bytes_(bytes) {}

  bool at_end() const { return at_ + file_.layout.word > bytes_.size(); }
  long long integer() { return file_.layout.integer(take(file_.layout.word)); }
  double real(bool wide) {
    const double value = wide || file_.layout.word == 8
                             ? file_.layout.value<double>(take(8))
                             : static_cast<double>(file_.layout.value<float>(take(4)));
    if (!std::isfinite(value))
      refuse_file(file_.name, "GEOM1 has a coordinate that is no number", "");
    return value;
  }
  Vector3d point(bool wide) {
    const double x = real(wide), y = real(wide);
    return {x, y, real(wide)};
  }

 private:
  const char* take(std::size_t bytes) {
    if (bytes_.size() - at_ < bytes)
      refuse_file(file_.name, "GEOM1 ends within an entry", "the file may be truncated");
    at_ += bytes;
    return &bytes_[at_ - bytes];
  }

  const Op2File& file_;
  const std::string& bytes_;
  std::size_t at_ = 0;
};

int number(const Op2File& file, long long value) {
  if (value < -2'000'000'000 || value > 2'000'000'000)
    refuse_file(file.name, fmt::format("GEOM1 has the number {}", value), "");
  return static_cast<int>(value);
}

/// Reals have two words of 4 bytes each where that alone makes whole entries, or where it does,
/// too, and the third word of the key is not that of single precision.
bool is_wide(const Op2File& file, std::size_t words, std::size_t narrow, std::size_t reals,
             bool narrow_key) {
  if (file.layout.word == 8) return true;
  const bool fits = words % narrow == 0, fits_wide = words % (narrow + reals) == 0;
  if (!fits && !fits_wide)
    refuse_file(file.name, fmt::format("GEOM1 has {} words of entries of {}", words, narrow),
                "the file may be truncated");
  return fits_wide && !(fits && narrow_key);
}

/// Cards of GEOM1.
struct Geometry {
  detail::CoordinateSystems systems;

  void read(const Op2File& file, const std::string& record) {
    RecordReader entries(file, record);
    const std::size_t words = record.size() / file.layout.word;
    if (words < 3) return;
    Key key{};
    for (long long& k : key) k = entries.integer();
    if (key[0] == kGrid) {
      const bool wide = is_wide(file, words - 3, 8, 3, key[2] == 1);
      while (!entries.at_end()) read_grid(file, entries, wide);
    } else if (const auto kind = system_kind(key[0]); kind && key[0] >= kFirstByPoints) {
      const bool wide = is_wide(file, words - 3, 13, 9, key[2] >= 8 && key[2] <= 10);
      while (!entries.at_end()) read_by_points(file, entries, *kind, wide);
    } else if (kind) {
      while (!entries.at_end()) read_by_grids(file, entries, *kind);
    }
  }

 private:
  void read_grid(const Op2File& file, RecordReader& entries, bool wide) {
    const int id = number(file, entries.integer());
    detail::GridCard card;
    card.in = number(file, entries.integer());
    card.point = entries.point(wide);
    card.moves = number(file, entries.integer());
    entries.integer(), entries.integer();  // constraints, superelement
    if (card.moves < 0) return;            // a point of a fluid
    const auto [at, is_new] = systems.grids.insert({id, card});
    if (!is_new && (at->second.in != card.in || at->second.point != card.point ||
                    at->second.moves != card.moves))
      refuse_file(file.name, fmt::format("GEOM1 has grid {} twice, with different data", id),
                  "write the tables of one superelement");
  }
  void read_by_points(const Op2File& file, RecordReader& entries, detail::SystemKind kind,
                      bool wide) {
    detail::SystemCard& system = systems.systems[number(file, entries.integer())];
    system.kind = kind;
    entries.integer(), entries.integer();  // its kind, 2
    system.in = number(file, entries.integer());
    for (Vector3d& point : system.points) point = entries.point(wide);
  }
  void read_by_grids(const Op2File& file, RecordReader& entries, detail::SystemKind kind) {
    detail::SystemCard& system = systems.systems[number(file, entries.integer())];
    system.kind = kind;
    entries.integer(), entries.integer();  // its kind, 1
    system.grids.emplace();
    for (int& grid : *system.grids) grid = number(file, entries.integer());
  }
};

}  // namespace

std::vector<Grid> op2_grids(const Op2File& file) {
  Geometry geometry;
  for (const Op2Table& table : file.tables)
    if (table.name == "GEOM1" || table.name == "GEOM1S" || table.name == "GEOM1N")
      for (std::size_t i = 1; i < table.records.size(); ++i) geometry.read(file, table.records[i]);
  if (geometry.systems.grids.empty())
    refuse_file(file.name, "it has no table GEOM1 with grids",
                "write PARAM,POSTEXT,YES in the bulk data");
  std::vector<Grid> grids;
  std::string why;
  for (const auto& [id, card] : geometry.systems.grids) {
    const auto grid = geometry.systems.place(id, why);
    if (!grid)
      refuse_file(file.name, fmt::format("grid {}: {}", id, why),
                  "write its system as a CORD1R, CORD1C, CORD1S, CORD2R, CORD2C or CORD2S");
    grids.push_back(*grid);
  }
  return grids;
}

}  // namespace titop::fe
