// The command line. Exit codes: 0 done, 1 the diagram or a file is refused (the errors are on
// stderr), 2 not understood, 3 compiled, but the full certificate does not hold, or a loop is not
// stable.
#include <fmt/format.h>

#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <stdexcept>
#include <string>
#include <string_view>
#include <system_error>
#include <titop/blocks/diagram_file/diagram_file.hpp>
#include <titop/emit/report/program.hpp>
#include <titop/emit/text/write_file.hpp>
#include <titop/titop.hpp>
#include <vector>

#include "arguments.hpp"
#include "commands/analyses.hpp"
#include "commands/diagram.hpp"
#include "generate/command.hpp"

namespace {

namespace fs = std::filesystem;
using namespace titop;
using namespace titop::command_line;

Misuse unknown_ending(const Arguments& a) {
  return {fmt::format("'{}' has an unknown extension", a.words[2])};
}

void check(const Arguments& a) {
  const System system = compiled(a);
  std::fputs(fmt::format("{}: {} states, {} inputs, {} outputs\n", system.stage().graph.name,
                         system.order(), system.inputs().size(), system.outputs().size())
                 .c_str(),
             stdout);
}

void show(const Arguments& a) {
  const System system = compiled(a);
  const std::string poles = to_string(system.poles());
  std::fputs(
      (system.log() + system.dense_log() + poles + to_string(system.dense_certificate())).c_str(),
      stdout);
}

/// Returns 3 if the certificate fails, as against the exit code of a scene that is refused.
int certify_scene(const Arguments& a) {
  const FullCertificate certificate = certify(compiled(a));
  std::fputs(to_string(certificate).c_str(), stdout);
  if (!a.to.empty()) write_json(certificate, a.to);
  return certificate.holds() ? 0 : 3;
}

/// By Graphviz, whose name of a format is the file's ending.
std::string drawn(const std::string& text, const std::string& file, const std::string& format) {
  const report::Finished dot = report::run({"dot", "-T" + format}, text);
  if (dot.found && dot.code == 0) return dot.out;
  const std::string why =
      dot.found ? fmt::format("dot ends with {}", dot.code) : "the program dot is not installed";
  throw Error(
      Code::bad_file, fmt::format("{}: cannot be drawn: {}", file, why),
      fmt::format("install Graphviz (Debian package graphviz), or write a FILE.dot and draw "
                  "it where there is one: dot -T{0} FILE.dot -o FILE.{0}",
                  format),
      dot.err.empty() ? std::vector<std::string>{}
                      : std::vector{dot.err.substr(0, dot.err.find('\n'))});
}

/// The structure in the mode of a line of the table of poles.
void draw_mode(const Arguments& a) {
  if (fs::path(a.words[2]).extension() != ".svg") throw unknown_ending(a);
  if (a.compiled || a.fold >= 0) throw Misuse{"draw --mode takes neither --compiled nor --fold"};
  const System system = compiled(a);
  if (const std::size_t lines = system.poles().size(); static_cast<std::size_t>(a.mode) > lines)
    throw Error(Code::unknown_name, fmt::format("--mode {}: there is no such pole", a.mode),
                fmt::format("the table of titop compile has {} lines", lines));
  write_plot(plot_mode(system, a.mode - 1), a.words[2]);
}

void draw(const Arguments& a) {
  if (a.mode > 0) return draw_mode(a);
  const std::string kind = fs::path(a.words[2]).extension().string();
  const bool picture = kind == ".svg" || kind == ".png" || kind == ".pdf";
  if (!picture && !kind.empty() && kind != ".dot" && kind != ".gv") throw unknown_ending(a);
  const DotOptions options{.fold = std::max(a.fold, 0)};
  const std::string text =
      a.compiled ? to_dot(compiled(a).stage(), options) : to_dot(diagram_of(a), options);
  emit::write_file(a.words[2], picture ? drawn(text, a.words[2], kind.substr(1)) : text);
}

void report(const Arguments& a) {
  ReportOptions options{.diagrams = a.diagrams, .until = a.until};
  if (a.fold >= 0) options.fold = a.fold;
  if (!a.band.empty() && a.band[0] == 0) throw Misuse{"report needs --band 0 < LOW < HIGH"};
  if (!a.band.empty()) options.band_hz = {a.band[0], a.band[1]};
  write_report(compiled(a), a.to, options);
}

void export_model(const Arguments& a) {
  const fs::path file = a.words[2], folder = file.parent_path();
  const std::string name = file.stem().string(), kind = file.extension().string();
  if (kind == ".csv" && a.omega.empty()) throw Misuse{"a .csv needs --omega LOW HIGH COUNT"};
  if (kind == ".csv") return write_csv(compiled(a), a.omega, file);  // by the factors
  if (kind != ".json" && kind != ".m" && kind != ".mat" && kind != ".py" && kind != ".hpp")
    throw unknown_ending(a);
  const System system = compiled(a);
  warn_of_lost_digits(system);
  if (kind == ".json") return write_json(system, file);
  if (kind == ".m") return write_matlab(system, file);
  if (kind == ".mat") return write_mat(system, file);
  if (kind == ".py") return write_numpy(system, folder, name);
  write(generate_cpp(system, {.name = name, .sample_time = a.sample_time}), folder);
}

fe::ImportOptions import_options(const Arguments& a) {
  fe::ImportOptions options{
      .parent = a.parent, .children = separated(a.children), .grids = a.grids};
  if (!a.units.empty()) options.units = {a.units[0], a.units[1], a.units[2]};
  if (a.xi != 0) options.modes.xi = {a.xi};
  if (const auto& m = a.mass; !m.empty())
    options.modes.rigid =
        rigid_mass(m[0], Vector3d(m[4], m[5], m[6]).asDiagonal(), -Vector3d(m[1], m[2], m[3]));
  if (a.modes >= 0) {
    options.modes.kept = a.modes;
    options.modes.residual = options.children;
    options.modes.residual.push_back(a.parent);
  }
  const std::vector<std::string> names = separated(a.matrices);
  if (!names.empty() && names.size() != 2) throw Misuse{"--matrices needs two names, K,M"};
  if (names.size() == 2) options.stiffness = names[0], options.mass = names[1];
  return options;
}

void import_file(const Arguments& a) {
  const std::string kind = fs::path(a.to).extension().string();
  if (!a.to.empty() && kind != ".json" && kind != ".csv")
    throw Misuse{fmt::format("'{}' has an unknown extension: .json or .csv", a.to)};
  const fe::Import found = fe::import_body(a.words[1], import_options(a));
  std::fputs(found.text.c_str(), stdout);
  if (a.to.empty()) return;
  if (!found.body) throw Misuse{"a body needs --parent, one of the ports above"};
  if (kind == ".csv") return emit::write_file(a.to, fe::modal_csv(*found.body));
  write_diagram(diagram_of_body(*found.body), a.to);
}

void generate_scene(const std::vector<std::string>& words) try {
  generate::command(words);
} catch (const std::invalid_argument& misuse) {
  throw Misuse{misuse.what()};
}

struct Command {
  const char* name;
  std::size_t words;             ///< with its own
  std::size_t read;              ///< of these: its own and the files that it reads
  int (*run)(const Arguments&);  ///< exit code
  std::string_view options;      ///< that it takes, each between blanks
};
constexpr std::string_view kModel = " --set --minimize-up-to ",
                           kHeader = " --set --minimize-up-to --sample-time ",
                           kResponse = " --set --minimize-up-to --omega ";

/// Refuses options without effect on this command, and output over a file that is read.
void check_words(const Command& command, const Arguments& a) {
  if (a.words.size() != command.words)
    throw Misuse{fmt::format("{} takes {} file{}", command.name, command.words - 1,
                             command.words == 2 ? "" : "s")};
  std::string_view options = command.options;
  const std::string kind = a.words.size() > 2 ? fs::path(a.words[2]).extension().string() : "";
  if (std::string_view(command.name) == "export")
    options = kind == ".hpp" ? kHeader : kind == ".csv" ? kResponse : kModel;
  for (const std::string& option : a.given)
    if (options.find(" " + option + " ") == std::string_view::npos)
      throw Misuse{fmt::format(
          "{}{} does not have the option {}", command.name,
          kind.empty() || std::string_view(command.name) != "export" ? "" : " to a file " + kind,
          option)};
  const auto own = a.words.begin() + static_cast<std::ptrdiff_t>(command.read);
  std::vector<std::string> written(own, a.words.end()), read(a.words.begin() + 1, own);
  if (!a.to.empty()) written.push_back(a.to);
  if (!a.record.empty()) read.push_back(a.record);
  for (const std::string& to : written)
    for (const std::string& from : read)
      if (std::error_code none; fs::equivalent(to, from, none))
        throw Misuse{fmt::format("{} is the file that is read: write to another one", to)};
}

template <void (*F)(const Arguments&)>
int done(const Arguments& a) {
  F(a);
  return 0;
}
constexpr Command kCommands[] = {
    {"check", 2, 2, done<check>, kModel},
    {"compile", 2, 2, done<show>, kModel},
    {"certify", 2, 2, certify_scene, " --set --minimize-up-to -o "},
    {"draw", 3, 2, done<draw>, " --set --compiled --fold --mode --minimize-up-to "},
    {"report", 2, 2, done<report>,
     " --set --fold -o --band --until --no-diagrams --minimize-up-to "},
    {"export", 3, 2, done<export_model>, kModel},
    {"margins", 2, 2, margins_of_loops, " --set --delay --minimize-up-to "},
    {"simulate", 3, 2, done<simulate_inputs>, " --set --step --until --record --unit-step "},
    {"sweep", 4, 3, sweep_table, " --set --omega --part --minimize-up-to "},
    {"reduce", 3, 2, done<reduce_scene>,
     " --set --band --inputs --outputs --accuracy --sample-time "},
    {"import", 2, 2, done<import_file>,
     " -o --parent --children --grids --matrices --units --mass --modes --xi "}};

bool asks_for_help(const std::vector<std::string>& all) {
  const auto typed = [&](const char* word) {
    return std::find(all.begin(), all.end(), word) != all.end();
  };
  return typed("--help") || typed("-h") || (!all.empty() && all[0] == "help");
}

std::string whole_usage() { return command_line::usage() + generate::kUsage; }

int run(const std::vector<std::string>& all) {
  if (asks_for_help(all)) {
    std::fputs(whole_usage().c_str(), stdout);
    return 0;
  }
  if (all.size() == 1 && all[0] == "--version") {
    std::fputs("titop " TITOP_VERSION "\n", stdout);
    return 0;
  }
  if (!all.empty() && all[0] == "generate") {
    generate_scene({all.begin() + 1, all.end()});
    return 0;
  }
  Arguments a = parse(all);
  if (a.words.empty()) throw Misuse{"no command given"};
  for (const Command& command : kCommands) {
    if (a.words[0] != command.name) continue;
    if (a.words[0] == "report" && a.words.size() == 2 && a.to.empty())
      a.to = fs::path(a.words[1]).replace_extension(".html").string();
    check_words(command, a);
    return command.run(a);
  }
  throw Misuse{fmt::format("there is no command {}", a.words[0])};
}

}  // namespace

int main(int argc, char** argv) try {
  const int code = run({argv + 1, argv + argc});
  if (std::fflush(stdout) != 0 || std::ferror(stdout))
    throw Error(Code::bad_file, "standard output could not be written completely",
                "check that its disk is not full and that its reader stays to the end");
  return code;
} catch (const Misuse& misuse) {
  std::fputs(fmt::format("titop: {}\ntitop --help prints the usage\n", misuse.subject).c_str(),
             stderr);
  return 2;
} catch (const std::exception& error) {
  std::fputs(fmt::format("{}\n", error.what()).c_str(), stderr);
  return 1;
}
