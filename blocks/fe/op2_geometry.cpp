#include <fmt/format.h>

#include <array>
#include <cmath>
#include <titop/blocks/fe/coordinate_systems.hpp>
#include <titop/blocks/fe/op2_results.hpp>
#include <titop/graph/error.hpp>

/// op2_grids: cards of GEOM1, each record a key of three words and entries of one length.
namespace titop::fe {

namespace {

using Key = std::array<long long, 3>;
constexpr Key kGrid = {4501, 45, 1}, kGridDouble = {4501, 45, 1120001}, kCord2r = {2101, 21, 8},
              kCord2rDouble = {2101, 21, 220};

/// Other kinds of coordinate systems.
const char* other_system(const Key& key) {
  switch (key[0]) {
    case 1701: return "CORD1C";
    case 1801: return "CORD1R";
    case 1901: return "CORD1S";
    case 2001: return "CORD2C";
    case 2201: return "CORD2S";
    default: return nullptr;
  }
}

[[noreturn]] void refuse(const Op2File& file, const std::string& found, const char* hint) {
  throw Error(Code::bad_file, fmt::format("{}: {}", file.name, found), hint);
}

/// Entries of a record, word by word. Double reals take two words of 4 bytes, or one of 8.
class Entries {
 public:
  Entries(const Op2File& file, const std::string& bytes) : file_(file), bytes_(bytes) {}

  bool at_end() const { return at_ + file_.layout.word > bytes_.size(); }
  long long integer() { return file_.layout.integer(take(file_.layout.word)); }
  double real(bool wide) {
    const double value = wide || file_.layout.word == 8
                             ? file_.layout.value<double>(take(8))
                             : static_cast<double>(file_.layout.value<float>(take(4)));
    if (!std::isfinite(value)) refuse(file_, "GEOM1 has a coordinate that is no number", "");
    return value;
  }
  Vector3d point(bool wide) {
    const double x = real(wide), y = real(wide);
    return {x, y, real(wide)};
  }

 private:
  const char* take(std::size_t bytes) {
    if (bytes_.size() - at_ < bytes)
      refuse(file_, "GEOM1 ends within an entry", "the file may be truncated");
    at_ += bytes;
    return &bytes_[at_ - bytes];
  }

  const Op2File& file_;
  const std::string& bytes_;
  std::size_t at_ = 0;
};

struct GridCard {
  int in = 0, moves = 0;
  Vector3d point;
};

int number(const Op2File& file, long long value) {
  if (value < -2'000'000'000 || value > 2'000'000'000)
    refuse(file, fmt::format("GEOM1 has the number {}", value), "");
  return static_cast<int>(value);
}

struct Geometry {
  std::map<int, GridCard> grids;
  detail::CoordinateSystems systems;

  void read(const Op2File& file, const std::string& record) {
    Entries entries(file, record);
    if (record.size() < 3 * file.layout.word) return;
    Key key{};
    for (long long& k : key) k = entries.integer();
    const bool wide = key == kGridDouble || key == kCord2rDouble;
    if (key == kGrid || key == kGridDouble) {
      while (!entries.at_end()) read_grid(file, entries, wide);
    } else if (key == kCord2r || key == kCord2rDouble) {
      while (!entries.at_end()) read_cord2r(file, entries, wide);
    } else if (const char* name = other_system(key); name && !entries.at_end()) {
      systems.others[number(file, entries.integer())] = name;
    }
  }

 private:
  void read_grid(const Op2File& file, Entries& entries, bool wide) {
    const int id = number(file, entries.integer());
    GridCard card;
    card.in = number(file, entries.integer());
    card.point = entries.point(wide);
    card.moves = number(file, entries.integer());
    entries.integer(), entries.integer();   // constraints, superelement
    if (card.moves >= 0) grids[id] = card;  // -1: a point of a fluid
  }
  void read_cord2r(const Op2File& file, Entries& entries, bool wide) {
    const int id = number(file, entries.integer());
    entries.integer(), entries.integer();  // its kind
    detail::Cord2r& system = systems.rectangular[id];
    system.in = number(file, entries.integer());
    system.A = entries.point(wide);
    system.B = entries.point(wide);
    system.C = entries.point(wide);
  }
};

}  // namespace

std::vector<Grid> op2_grids(const Op2File& file) {
  Geometry geometry;
  for (const Op2Table& table : file.tables)
    if (table.name == "GEOM1" || table.name == "GEOM1S" || table.name == "GEOM1N")
      for (std::size_t i = 1; i < table.records.size(); ++i) geometry.read(file, table.records[i]);
  if (geometry.grids.empty())
    refuse(file, "it has no table GEOM1 with grids", "write PARAM,POSTEXT,YES in the bulk data");
  std::vector<Grid> grids;
  std::string why;
  for (const auto& [id, card] : geometry.grids) {
    const detail::Axes* in = geometry.systems.find(card.in, why);
    const detail::Axes* moves = in ? geometry.systems.find(card.moves, why) : nullptr;
    if (!moves) refuse(file, fmt::format("grid {}: {}", id, why), "write its system as a CORD2R");
    grids.push_back(detail::placed_grid(id, card.point, *in, *moves));
  }
  return grids;
}

}  // namespace titop::fe
