#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <string_view>
#include <titop/blocks/fe/f06_tables.hpp>
#include <titop/blocks/fe/fortran.hpp>

namespace titop::fe::detail {

namespace {

using Tokens = std::vector<std::string_view>;

enum class TableKind {
  none,
  eigenvalues,
  vector,
  forces,
  factors,
  effective,
  rigid,
  weight_head,  ///< before its matrix, M O
  weight,
  bulk
};

bool contains(std::string_view text, std::string_view part) {
  return text.find(part) != std::string_view::npos;
}

bool is_number(std::string_view text) {
  return text.find_first_not_of("0123456789") == std::string_view::npos;
}

/// The words from `first` on as numbers, if they are N ones.
template <std::size_t N>
std::optional<std::array<double, N>> numbers(const Tokens& words, std::size_t first,
                                             std::size_t behind = 0) {
  std::array<double, N> result{};
  if (words.size() != first + N + behind) return std::nullopt;
  for (std::size_t i = 0; i < N; ++i)
    if (!parse_fortran(words[first + i], result[i])) return std::nullopt;
  return result;
}

/// The table that a line of text is the title of.
std::optional<TableKind> title(std::string_view text) {
  static constexpr std::array<std::pair<std::string_view, TableKind>, 9> titles = {
      {{"R E A L   E I G E N V A L U E S", TableKind::eigenvalues},
       {"R E A L   E I G E N V E C T O R   N O .", TableKind::vector},
       {"F O R C E S   O F   S I N G L E - P O I N T   C O N S T R A I N T", TableKind::forces},
       {"MODAL PARTICIPATION FACTORS", TableKind::factors},
       {"MODAL EFFECTIVE MASS FRACTION", TableKind::none},
       {"MODAL EFFECTIVE MASS", TableKind::effective},
       {"A-SET RIGID BODY MASS MATRIX", TableKind::rigid},
       {"G R I D   P O I N T   W E I G H T   G E N E R A T O R", TableKind::weight_head},
       {"S O R T E D   B U L K   D A T A   E C H O", TableKind::bulk}}};
  for (const auto& [name, table] : titles)
    if (contains(text, name)) return table;
  return std::nullopt;
}

/// First words of the lines between a title and its rows.
bool is_head(std::string_view word) {
  static constexpr std::array<std::string_view, 7> heads = {"MODE",  "NO.",   "POINT", "***",
                                                            "ENTRY", "COUNT", "(AFTER"};
  return std::ranges::find(heads, word) != heads.end();
}

/// Any text that belongs to no table ends the one before.
class F06Reader {
 public:
  F06Reader(const TextFile& file, FileMistakes& mistakes) : file_(file), mistakes_(mistakes) {
    for (const TextLine& line : lines_of(file)) take(line);
  }
  F06Tables tables = {};

 private:
  void mistake(const TextLine& line, const std::string& expected) {
    mistakes_.add(bad_line(file_, line.number, fmt::format("'{}'", trim(line.text)), expected));
  }

  void take(const TextLine& line) {
    if (line.text.starts_with('1') && contains(line.text, " PAGE ")) {
      header_ = 2;  // the user's titles
    } else if (header_ > 0) {
      --header_;
    } else if (table_ != TableKind::bulk || !echo(line.text)) {
      // The first column controls the printer.
      const std::string_view text = line.text.substr(std::min<std::size_t>(1, line.text.size()));
      if (const Tokens found = words(text); !found.empty()) text_or_row({line.number, text}, found);
    }
  }

  /// "    12-        GRID ...": the card begins in column 31.
  bool echo(std::string_view text) {
    std::string_view count = trim(text.substr(0, 30));
    if (!count.ends_with('-') || !is_number(count.substr(0, count.size() - 1))) return false;
    if (text.size() > 30) tables.bulk += text.substr(30);
    tables.bulk += '\n';
    return true;
  }

  void text_or_row(const TextLine& line, const Tokens& found) {
    const std::string_view text = line.text;
    if (const auto next = title(text)) {
      begin(line, *next, found);
    } else if (contains(text, "FATAL MESSAGE")) {
      mistake(line, "a run without errors: see its message");
    } else if (contains(text, "* * * END OF JOB * * *")) {
      tables.ends = true;
    } else if (contains(text, "REFERENCE POINT")) {
      reference(line, found);
    } else if (contains(text, "BEFORE AUGMENTATION")) {
      table_ = TableKind::none;
    } else if (found[0] == "EIGENVALUE" && found.size() == 3) {
      if (!parse_fortran(found[2], eigenvalue_)) mistake(line, "a number");
    } else if (table_ == TableKind::weight_head && trim(text) == "M O") {
      table_ = TableKind::weight;
    } else if (found[0] == "*" || is_number(found[0])) {
      row(line, found);
    } else if (!is_head(found[0])) {
      table_ = TableKind::none;
    }
  }

  void begin(const TextLine& line, TableKind table, const Tokens& found) {
    table_ = table;
    rows_ = 0;
    if (table == TableKind::vector && !parse(found.back(), mode_))
      mistake(line, "the number of a mode at its end");
    const bool next = tables.forces.empty() || tables.forces.back().eigenvalue != eigenvalue_;
    if (table == TableKind::forces && next) tables.forces.push_back({eigenvalue_});
  }

  /// "REFERENCE POINT AT ORIGIN OF BASIC COORDINATE SYSTEM", "... AT GRID 12", and for weights
  /// "REFERENCE POINT =        0"; those of WEIGHTCHECK are not read.
  void reference(const TextLine& line, const Tokens& found) {
    if (table_ != TableKind::weight_head && !contains(line.text, "REFERENCE POINT AT")) return;
    int grid = 0;
    if (!contains(line.text, "ORIGIN") && (!parse(found.back(), grid) || grid < 0))
      mistake(line, "a grid's number, or the origin");
    (table_ == TableKind::weight_head ? weight_about_ : tables.about) = grid;
  }

  void row(const TextLine& line, const Tokens& found) {
    switch (table_) {
      case TableKind::eigenvalues: return eigenvalue(line, found);
      case TableKind::vector: return grid(line, found, tables.vectors[mode_]);
      case TableKind::forces: return force(line, found);
      case TableKind::factors: return by_mode(line, found, tables.factors);
      case TableKind::effective: return by_mode(line, found, tables.effective);
      case TableKind::rigid: return matrix(line, found, tables.rigid, tables.about);
      case TableKind::weight: return matrix(line, found, tables.weight, weight_about_);
      default: return;
    }
  }

  void once(const TextLine& line, bool is_new) {
    if (!is_new) mistake(line, "each mode once, each grid once in a mode: one METHOD, one subcase");
  }

  /// Mode, order, eigenvalue, radians, cycles, generalised mass and stiffness.
  void eigenvalue(const TextLine& line, const Tokens& found) {
    int mode = 0;
    const auto values = numbers<5>(found, 2);
    if (!parse(found[0], mode) || !values) return mistake(line, "the seven numbers of a mode");
    const auto [value, omega, cycles, mass, stiffness] = *values;
    once(line, tables.eigenvalues.insert({mode, {value, omega, mass}}).second);
  }

  /// Scalar points have other types.
  void grid(const TextLine& line, const Tokens& found, ByNumber& values) {
    int id = 0;
    if (found.size() < 3 || found[1].size() != 1 || !parse(found[0], id) || id < 1)
      return mistake(line, "a point, its type and its components");
    if (found[1] != "G") return;
    const auto value = numbers<6>(found, 2);
    if (!value) return mistake(line, "the six components of a grid");
    once(line, values.insert({id, Vector6::Map(value->data())}).second);
  }

  /// Two modes may have the same printed eigenvalue.
  void force(const TextLine& line, const Tokens& found) {
    int id = 0;
    if (parse(found[0], id) && tables.forces.back().values.contains(id))
      tables.forces.push_back({eigenvalue_});
    grid(line, found, tables.forces.back().values);
  }

  /// Mode, frequency, and a number for each direction.
  void by_mode(const TextLine& line, const Tokens& found, ByNumber& values) {
    int mode = 0;
    const auto value = numbers<6>(found, 2);
    if (!parse(found[0], mode) || !value)
      return mistake(line, "a mode, its frequency and six numbers");
    once(line, values.insert({mode, Vector6::Map(value->data())}).second);
  }

  void matrix(const TextLine& line, const Tokens& found, std::optional<F06Mass>& mass, int about) {
    const auto value = numbers<6>(found, 1, 1);
    if (!value || (mass && rows_ == 0))
      return mistake(line, "six numbers of a rigid mass matrix, which is there once");
    if (!mass) mass = F06Mass{.about = about};
    mass->value.row(rows_) = Vector6::Map(value->data()).transpose();
    if (++rows_ == 6) table_ = TableKind::none;
  }

  const TextFile& file_;
  FileMistakes& mistakes_;
  TableKind table_ = TableKind::none;
  int header_ = 0, rows_ = 0, mode_ = 0, weight_about_ = 0;
  double eigenvalue_ = 0;
};

}  // namespace

F06Tables f06_tables(const TextFile& file, FileMistakes& mistakes) {
  return std::move(F06Reader(file, mistakes).tables);
}

}  // namespace titop::fe::detail
