#include <fmt/format.h>

#include <cctype>
#include <cmath>
#include <map>
#include <titop/blocks/fe/dmig.hpp>
#include <titop/blocks/fe/fortran.hpp>
#include <titop/blocks/fe/text_file.hpp>
#include <utility>

namespace titop::fe {

namespace {

/// A field with the line that it stands on.
struct Field {
  std::string_view text;
  int line = 0;
};

/// A card without its name: fields 2 to 9, then those of its continuations.
struct DmigCard {
  std::vector<Field> fields;
  int line = 0;
};

struct DmigEntry {
  double value = 0;
  int line = 0;
};

/// The data in the file under one name.
struct DmigMatrix {
  int form = 0, type = 0;
  int digits = 0;  ///< of its longest number
  std::map<std::pair<GridDof, GridDof>, DmigEntry> entries;
};

/// Commas and tabs go on with free fields.
bool is_continuation(std::string_view text) {
  return !text.empty() && std::string_view("*+ ,\t").find(text[0]) != std::string_view::npos;
}

void add_fields(DmigCard& card, const TextLine& line, bool wide) {
  const std::size_t width = wide ? 16 : 8, count = wide ? 4 : 8;
  for (std::size_t i = 0; i < count; ++i) {
    const std::size_t at = 8 + i * width;
    card.fields.push_back(
        {at < line.text.size() ? trim(line.text.substr(at, width)) : std::string_view(),
         line.number});
  }
}

/// True for a card called DMIG, in any form.
bool is_dmig(std::string_view text) {
  text = trim(text);
  for (const char c : {'D', 'M', 'I', 'G'}) {
    if (text.empty() || std::toupper(static_cast<unsigned char>(text[0])) != c) return false;
    text.remove_prefix(1);
  }
  return text.empty() || std::string_view(" *,\t").find(text[0]) != std::string_view::npos;
}

/// Free fields are set off by commas from the name on; tabs would shift the columns.
bool is_fixed(std::string_view text) {
  return text.substr(0, 8).find(',') == std::string_view::npos &&
         text.find('\t') == std::string_view::npos;
}

/// Digits of a number from its first that is not 0 to its exponent.
int significant_digits(std::string_view text) {
  int count = 0;
  for (std::size_t i = 0; i < text.size(); ++i) {
    if (std::isdigit(static_cast<unsigned char>(text[i])))
      count += count > 0 || text[i] != '0';
    else if (i > 0 && text[i] != '.')
      break;  // the exponent
  }
  return count;
}

/// Decimal digits of the entries: as printed, at most those of their precision. No program prints
/// fewer than five: shorter numbers ("2.", "1.+6") were typed by hand and are taken as exact.
int digits_of(const DmigMatrix& found) {
  const int most = found.type == 1 ? 7 : 15;
  return found.digits < 5 ? most : std::min(most, found.digits);
}

/// All cards called DMIG, with their continuations.
std::vector<DmigCard> cards_in(const TextFile& file, FileMistakes& mistakes) {
  std::vector<DmigCard> cards;
  bool open = false;
  for (const TextLine& line : lines_of(file)) {
    if (line.text.empty() || line.text[0] == '$') continue;
    const bool starts = is_dmig(line.text);
    const std::string_view name = trim(line.text.substr(0, 8));
    const bool known = !starts || (line.text[0] == 'D' && (name == "DMIG" || name == "DMIG*"));
    const bool goes_on = open && is_continuation(line.text);
    if ((starts || goes_on) && !(known && is_fixed(line.text))) {
      mistakes.add(bad_line(file, line.number, fmt::format("'{}'", line.text),
                            "DMIG in capitals in column 1 and fields of 8 or 16 columns, set off "
                            "neither by commas nor by tabs"));
      open = false;
      continue;
    }
    if (starts) cards.push_back({{}, line.number});
    if (starts || goes_on) add_fields(cards.back(), line, name == "DMIG*" || line.text[0] == '*');
    open = starts || (open && is_continuation(line.text));
  }
  return cards;
}

class DmigReader {
 public:
  explicit DmigReader(const TextFile& file) : file_(file) {
    require_line_end(file, mistakes_);
    for (const DmigCard& card : cards_in(file, mistakes_)) read(card);
    mistakes_.finish();
  }

  std::map<std::string, DmigMatrix> matrices;

 private:
  void mistake(const Field& field, const std::string& expected) {
    mistakes_.add(bad_line(file_, field.line, fmt::format("'{}'", field.text), expected));
  }

  void read(const DmigCard& card) {
    const std::string name(card.fields[0].text);
    int column = 0;
    if (!parse(card.fields[1].text, column))
      return mistake(card.fields[1], "a grid, or 0 in the header");
    if (column == 0 && !matrices.contains(name)) return read_header(card, name);
    const auto at = matrices.find(name);
    if (at == matrices.end())
      return mistake(card.fields[0],
                     "the matrix's header (its third field is 0) before its columns");
    if (at->second.form == 1 || at->second.form == 6) read_column(card, at->second);
  }

  void read_header(const DmigCard& card, const std::string& name) {
    DmigMatrix& found = matrices[name];
    if (!parse(card.fields[2].text, found.form)) mistake(card.fields[2], "a form: 1, 6, 2 or 9");
    if (!parse(card.fields[3].text, found.type)) mistake(card.fields[3], "a type from 1 to 4");
  }

  bool read_dof(const Field& grid, const Field& component, GridDof& dof) {
    if (!parse(grid.text, dof.grid) || dof.grid < 1) {
      mistake(grid, "the number of a grid");
      return false;
    }
    dof.component = 0;
    if (component.text.empty() ||
        (parse(component.text, dof.component) && dof.component >= 0 && dof.component <= 6))
      return true;
    mistake(component, "a component from 0 to 6");
    return false;
  }

  /// Rows come in fours: grid, component, real and imaginary part.
  void read_column(const DmigCard& card, DmigMatrix& found) {
    GridDof column;
    if (!read_dof(card.fields[1], card.fields[2], column)) return;
    for (std::size_t i = 4; i + 3 < card.fields.size(); i += 4) {
      const Field &grid = card.fields[i], &real = card.fields[i + 2];
      if (grid.text.empty() && real.text.empty()) continue;
      GridDof row;
      double value = 0;
      if (!read_dof(grid, card.fields[i + 1], row)) continue;
      if (!parse_fortran(real.text, value)) {
        mistake(real, "a finite number");
        continue;
      }
      found.digits = std::max(found.digits, significant_digits(real.text));
      put(found, row, column, {value, real.line});
    }
  }

  void put(DmigMatrix& found, const GridDof& row, const GridDof& column, const DmigEntry& entry) {
    const auto [at, is_new] = found.entries.insert({{row, column}, entry});
    const auto mirror = found.form == 6 ? found.entries.find({column, row}) : found.entries.end();
    const DmigEntry* other = !is_new                         ? &at->second
                             : mirror != found.entries.end() ? &mirror->second
                                                             : nullptr;
    if (other && other->value != entry.value)
      mistakes_.add(bad_line(file_, entry.line,
                             fmt::format("{} at ({} {}, {} {})", entry.value, row.grid,
                                         row.component, column.grid, column.component),
                             fmt::format("the value {} of line {}", other->value, other->line)));
  }

  const TextFile& file_;
  FileMistakes mistakes_;
};

const DmigMatrix& chosen(const TextFile& file, const DmigReader& reader, const std::string& name) {
  const auto at = reader.matrices.find(name);
  if (at == reader.matrices.end()) {
    std::string all;
    for (const auto& [other, found] : reader.matrices) all += (all.empty() ? "" : ", ") + other;
    throw Error(Code::unknown_name, fmt::format("{} has no DMIG matrix {}", file.name, name),
                all.empty() ? "it has none at all" : "its matrices are " + all);
  }
  const DmigMatrix& found = at->second;
  if (found.form != 1 && found.form != 6)
    throw Error(Code::bad_file, fmt::format("{}: {} has form {}", file.name, name, found.form),
                "a square (1) or symmetric (6) matrix is needed");
  if (found.type != 1 && found.type != 2)
    throw Error(Code::bad_file, fmt::format("{}: {} has type {}", file.name, name, found.type),
                "a real matrix (type 1 or 2) is needed: punch it without damping");
  if (found.entries.empty())
    throw Error(Code::bad_file, fmt::format("{}: {} has no entries", file.name, name),
                "let the program that wrote it run to its end");
  return found;
}

Eigen::MatrixXd filled(const DmigMatrix& found, const std::map<GridDof, Eigen::Index>& row) {
  const auto n = static_cast<Eigen::Index>(row.size());
  Eigen::MatrixXd S = Eigen::MatrixXd::Zero(n, n);
  for (const auto& [place, entry] : found.entries) {
    const Eigen::Index i = row.at(place.first), j = row.at(place.second);
    S(i, j) = entry.value;
    if (found.form == 6) S(j, i) = entry.value;
  }
  return S;
}

}  // namespace

std::vector<std::string> dmig_names(const std::filesystem::path& path) {
  const TextFile file = read_text(path);
  require_text(file);
  const DmigReader reader(file);
  std::vector<std::string> names;
  for (const auto& [name, found] : reader.matrices) names.push_back(name);
  return names;
}

GridMatrices read_dmig(const std::filesystem::path& path, const std::string& stiffness,
                       const std::string& mass) {
  const TextFile file = read_text(path);
  require_text(file);
  const DmigReader reader(file);
  const DmigMatrix &K = chosen(file, reader, stiffness), &M = chosen(file, reader, mass);
  std::map<GridDof, Eigen::Index> row;
  for (const DmigMatrix* found : {&K, &M})
    for (const auto& [place, entry] : found->entries) row[place.first] = row[place.second] = 0;
  if (row.size() > 10000)
    throw Error(Code::bad_file, fmt::format("{}: {} degrees of freedom", file.name, row.size()),
                "reduce models of more than 10000 in Nastran (ASET, Craig-Bampton)");
  GridMatrices result;
  result.name = file.name;
  for (auto& [dof, index] : row) {
    index = static_cast<Eigen::Index>(result.dofs.size());
    result.dofs.push_back(dof);
  }
  result.K = filled(K, row);
  result.M = filled(M, row);
  result.digits = std::min(digits_of(K), digits_of(M));
  return result;
}

}  // namespace titop::fe
