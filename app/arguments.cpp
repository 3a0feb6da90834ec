#include "arguments.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <titop/emit/text/csv.hpp>

#include "options.hpp"

namespace titop::command_line {
namespace {

constexpr const char* kCommands = R"(usage:
  titop check DIAGRAM.json                 compiles; prints the numbers of states, inputs, outputs
  titop compile DIAGRAM.json               log, poles and certificate
  titop certify DIAGRAM.json               the full certificate; with -o also as JSON
  titop draw DIAGRAM.json FILE             the diagram: FILE.dot, text for Graphviz; drawn by it:
                                           FILE.svg, FILE.png, FILE.pdf
  titop draw --compiled DIAGRAM.json FILE  the same after all passes
  titop draw --mode LINE DIAGRAM.json FILE.svg  the structure in a mode
  titop report DIAGRAM.json                one HTML page to read and print: DIAGRAM.html, or -o
  titop export DIAGRAM.json FILE           the model in the format of FILE's extension:
      NAME.hpp     C++17 header, and its test NAME_test.cpp
      NAME.m       MATLAB or Octave function
      FILE.mat     MAT-file of A, B, C, D and the names
      NAME.py      Python module, and its arrays NAME_A.npy ...
      FILE.json    the model with its poles, certificate and notes
      FILE.csv     frequency response; needs --omega
  titop import FILE                        contents of a file of a finite-element program, its checks
                                           and ports: OP4, OP2, f06, DMIG punch, MAT-file, CSV of
                                           modes, CalculiX; with -o and --parent a body: BODY.json,
                                           a diagram of it alone, or BODY.csv, its modal data
  titop margins DIAGRAM.json               stability margins of the loop at every loop point
  titop simulate DIAGRAM.json FILE.csv     outputs over time; needs --step, --until, and --record or
                                           --unit-step
  titop sweep DIAGRAM.json POINTS.csv FILE.csv  poles at every row of POINTS, whose first line names
                                           parameters; with --omega frequency responses
  titop reduce DIAGRAM.json FILE           a reduced model of the band, FILE.m, FILE.mat, FILE.py or
                                           FILE.hpp, its steps and its error bound; needs --band
  titop --version
)";

constexpr const char* kExitCodes =
    R"(exit code: 0 done, 1 refused (errors on stderr), 2 invalid command line,
           3 certify: a check failed (the lines that begin with FAULT); margins: not stable
)";

/// "  --until SECONDS        report: ...", as many lines as its help.
std::string help_of(const OptionRow& option) {
  const std::string typed =
      fmt::format("{}{}{}", option.name, option.words[0] ? " " : "", option.words);
  std::string text = fmt::format("  {:<39}  ", typed);
  for (const char* c = option.help; *c; ++c)
    text += *c == '\n' ? fmt::format("\n{:43}", "") : std::string(1, *c);
  return text + "\n";
}

/// Notes the option; throws Misuse for one that does not exist or is there twice.
const OptionRow& option_of(const std::string& typed, std::vector<std::string>& given) {
  const std::span<const OptionRow> all = option_table();
  const auto row = std::ranges::find_if(all, [&](const OptionRow& o) { return typed == o.name; });
  if (row == all.end()) throw Misuse{fmt::format("there is no option {}", typed)};
  if (std::ranges::find(given, typed) != given.end() && typed != "--set")
    throw Misuse{fmt::format("{} is there twice", typed)};
  given.push_back(typed);
  return *row;
}

}  // namespace

std::string usage() {
  std::string text = fmt::format("{}options:\n", kCommands);
  for (const OptionRow& option : option_table()) text += help_of(option);
  return text + kExitCodes;
}

std::vector<std::string> separated(const std::string& list) {
  if (std::ranges::count(list, '"') % 2 != 0)
    throw Misuse{fmt::format("a quote is not closed in {}", list)};
  std::vector<std::string> words = emit::csv_fields(list);
  if (words.back().empty()) words.pop_back();
  return words;
}

Arguments parse(const std::vector<std::string>& all) {
  Arguments a;
  for (std::size_t i = 0; i < all.size(); ++i) {
    if (!all[i].starts_with("-")) {
      a.words.push_back(all[i]);
      continue;
    }
    const OptionRow& option = option_of(all[i], a.given);
    OptionWords words(all, i);
    option.read(a, words);
  }
  return a;
}

}  // namespace titop::command_line
