#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <titop/blocks/fe/file_kind.hpp>
#include <titop/blocks/fe/text_file.hpp>
#include <utility>

namespace titop::fe {

namespace {

constexpr const char* kAskNastran =
    "ask Nastran for EXTSEOUT(ASMBULK,EXTBULK,MATOP4=31), or for "
    "EXTSEOUT(ASMBULK,EXTBULK,DMIGPCH), "
    "and import the OP4 or punch file that it writes";

/// Four integers in fields of eight columns, and a name.
bool is_op4_header(std::string_view line) {
  if (line.size() < 33) return false;
  for (std::size_t i = 0; i < 4; ++i) {
    int value = 0;
    if (!parse(trim(line.substr(8 * i, 8)), value)) return false;
  }
  return true;
}

bool is_modal_csv(std::string_view line) {
  constexpr std::array<std::string_view, 6> keywords = {"units", "digits", "D_P",
                                                        "at P",  "child",  "mode"};
  return std::ranges::find(keywords, comma_fields(line).front()) != keywords.end();
}

[[noreturn]] void refuse(const TextFile& file, const std::string& found, const char* hint) {
  throw Error(Code::bad_file,
              fmt::format("{}: found {}, expected OP4, OP2, f06, DMIG punch, a MAT-file, modal "
                          "data as CSV, or a file of CalculiX (.sti, .mas, .dof, .inp)",
                          file.name, found),
              hint);
}

FileKind kind_of_text(const TextFile& file) {
  bool first = true, deck = false;
  for (const TextLine& line : lines_of(file)) {
    const std::string_view text = trim(line.text.substr(0, line.text.find('#')));
    if (text.empty()) continue;
    if (first && is_op4_header(line.text)) return FileKind::op4;
    if (first && is_modal_csv(text)) return FileKind::modal_csv;
    first = false;
    if (line.text.starts_with("DMIG")) return FileKind::dmig;
    if (line.text.find("R E A L   E I G E N V A L U E S") != std::string::npos)
      return FileKind::f06;
    deck = deck || line.text.starts_with("BEGIN BULK") || line.text.starts_with("GRID");
  }
  if (deck)
    refuse(file, "bulk data without DMIG",
           "they say where grids are (--grids FILE): import the OP4 or punch file of the run, "
           "which EXTSEOUT(ASMBULK,EXTBULK,MATOP4=31) or (ASMBULK,EXTBULK,DMIGPCH) writes");
  refuse(file, "another text",
         "of Abaqus and ANSYS write the modes, L_P and D_P as CSV (read_modal_csv)");
}

}  // namespace

FileKind kind_of_file(const std::filesystem::path& path) {
  for (const char* extension : {".sti", ".mas", ".dof", ".inp"})
    if (path.extension() == extension) return FileKind::calculix;
  if (path.extension() == ".f06" || path.extension() == ".F06") return FileKind::f06;
  if (path.extension() == ".mat") return FileKind::mat;
  const TextFile file = read_text(path);
  if (file.content.starts_with("MATLAB ")) return FileKind::mat;
  if (file.content.find('\0') == std::string::npos) return kind_of_text(file);
  // The length of the first Fortran record in either byte order: the head of a matrix, a marker.
  const std::string_view head = std::string_view(file.content).substr(0, 4);
  for (const auto& [length, kind] :
       {std::pair{char{24}, FileKind::op4}, std::pair{char{48}, FileKind::op4},
        std::pair{char{4}, FileKind::op2}, std::pair{char{8}, FileKind::op2}})
    if (head == std::string{length, 0, 0, 0} || head == std::string{0, 0, 0, length}) return kind;
  if (head.starts_with("\x1f\x8b")) refuse(file, "a file compressed by gzip", "gunzip it");
  refuse(file, "a binary file of another kind", kAskNastran);
}

}  // namespace titop::fe
