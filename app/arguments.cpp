#include "arguments.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <system_error>
#include <tuple>

namespace titop::command_line {

const char* const kUsage = R"(usage:
  titop check DIAGRAM.json                 compiles; prints the numbers of states, inputs, outputs
  titop compile DIAGRAM.json               log, poles and certificate
  titop certify DIAGRAM.json               the full certificate; with -o also as JSON
  titop draw DIAGRAM.json FILE             the diagram: FILE.dot, text for Graphviz; drawn by it:
                                           FILE.svg, FILE.png, FILE.pdf
  titop draw --compiled DIAGRAM.json FILE  the same after all passes
  titop report DIAGRAM.json                one HTML page to read and print: DIAGRAM.html, or -o
  titop export DIAGRAM.json FILE           the model in the format of FILE's extension:
      NAME.hpp     C++17 header, and its test NAME_test.cpp
      NAME.m       MATLAB or Octave function
      FILE.mat     MAT-file of A, B, C, D and the names; needs libmatio
      NAME.py      Python module, and its arrays NAME_A.npy ...
      FILE.json    the model with its poles, certificate and notes
      FILE.csv     frequency response; needs --omega
  titop import FILE                        what is in a file of a finite-element program, its checks
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
options:
  --set NAME=VALUE                         value of a parameter; once for each
  --fold COUNT                             draw, report: at most so many boxes, each whole subtrees;
                                           draw: all if left out; report: 40, 0 for all
  -o FILE                                  report: the HTML file; certify: also writes JSON;
                                           import: the body
  --parent PORT --children PORT,PORT       import: ports of the body
  --grids FILE                             import: bulk data with positions, FILE.asm if left out;
                                           of an f06 its own echo, or FILE.bdf, .dat, .nas
  --matrices K,M                           import: names of stiffness and mass
  --units METRE KILOGRAM SECOND            import: of the file, 1e-3 1 1 for mm, kg, s
  --mass M X Y Z JX JY JZ                  import: of a planar model, the whole body's mass, centre of
                                           mass from the parent and inertia there, in units of FILE
  --modes COUNT                            import: lowest modes that are kept, and residual vectors
                                           of all ports; all modes if left out
  --xi RATIO                               import: damping ratio of all modes
  --band LOW HIGH                          report: of the frequency responses, Hz; reduce
  --inputs NAME,NAME --outputs NAME,NAME   reduce: those that the model has; all if left out
  --accuracy ERROR                         reduce: relative to the peaks, 1e-3 if left out
  --until SECONDS                          report: of the step responses; simulate
  --step SECONDS                           simulate: between the times of the result
  --record FILE.csv                        simulate: inputs over time: a column time, in seconds, and
                                           inputs by name; linear in between, jumps are two equal times
  --unit-step INPUT                        simulate: this input is 1, the others are 0
  --delay SECONDS                          margins: an additional delay in the loop
  --part I/N                               sweep: the I-th of N parts of the rows
  --no-diagrams                            report: without drawings, which need Graphviz
  --sample-time SECONDS                    for .hpp: also `step`
  --omega LOW HIGH COUNT                   for .csv: rad/s, logarithmic
  --minimize-up-to STATES                  100 if left out; 0: never
exit code: 0 done, 1 refused (errors on stderr), 2 invalid command line,
           3 certify: a check failed (the lines that begin with FAULT); margins: not stable
)";

namespace {

constexpr int kMost = 1'000'000;  ///< upper limit of counts

double number(const std::string& option, const std::string& text) {
  double value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc() || end != text.data() + text.size() || !std::isfinite(value))
    throw Misuse{fmt::format("{}: '{}' is no number", option, text)};
  return value;
}

double seconds(const std::string& option, double value) {
  if (!(value > 0)) throw Misuse{option + " needs a time above 0"};
  return value;
}

int count(const std::string& option, double value, int least = 0) {
  if (!(value >= least) || value > kMost || value != std::floor(value))
    throw Misuse{fmt::format("{} needs a whole number from {} to {}", option, least, kMost)};
  return static_cast<int>(value);
}

/// From `low` to `high`, both exactly; no quotient of the two, which may overflow.
std::vector<double> logarithmic(double low, double high, int count) {
  std::vector<double> list;
  for (int i = 0; i < count; ++i) {
    const double part = count == 1 ? 0 : double(i) / (count - 1);
    list.push_back(std::clamp(std::pow(low, 1 - part) * std::pow(high, part), low, high));
  }
  return list;
}

/// NAME=VALUE.
std::pair<std::string, double> assignment(const std::string& option, const std::string& text) {
  const std::size_t at = text.find('=');
  if (at == 0 || at == std::string::npos)
    throw Misuse{fmt::format("{} needs NAME=VALUE, not '{}'", option, text)};
  return {text.substr(0, at), number(option, text.substr(at + 1))};
}

/// I/N.
std::pair<int, int> part(const std::string& option, const std::string& text) {
  const std::size_t at = text.find('/');
  if (at == std::string::npos) throw Misuse{fmt::format("{} needs I/N, not '{}'", option, text)};
  const int parts = count(option, number(option, text.substr(at + 1)), 1),
            part = count(option, number(option, text.substr(0, at)), 1);
  if (part > parts) throw Misuse{fmt::format("{}: there is no part {} of {}", option, part, parts)};
  return {part, parts};
}

}  // namespace

std::vector<std::string> separated(const std::string& list) {
  std::vector<std::string> words;
  for (std::size_t at = 0; at < list.size();) {
    const std::size_t end = std::min(list.find(',', at), list.size());
    std::string word = list.substr(at, end - at);
    word.erase(0, std::min(word.find_first_not_of(' '), word.size()));
    word.erase(word.find_last_not_of(' ') + 1);
    words.push_back(std::move(word));
    at = end + 1;
  }
  return words;
}

Arguments parse(const std::vector<std::string>& all) {
  Arguments a;
  for (std::size_t i = 0; i < all.size(); ++i) {
    const std::string& option = all[i];
    const auto word = [&]() -> const std::string& {
      if (++i == all.size() || all[i].starts_with("--"))
        throw Misuse{fmt::format("{} needs more", option)};
      return all[i];
    };
    const auto next = [&] { return number(option, word()); };
    if (option == "-o" || option.starts_with("--")) {
      const bool again = std::find(a.given.begin(), a.given.end(), option) != a.given.end();
      if (again && option != "--set") throw Misuse{fmt::format("{} is there twice", option)};
      a.given.push_back(option);
    }
    if (option == "--compiled") {
      a.compiled = true;
    } else if (option == "--no-diagrams") {
      a.diagrams = false;
    } else if (option == "--fold") {
      a.fold = count(option, next());
    } else if (option == "-o") {
      a.to = word();
    } else if (option == "--band") {
      a.band = {next(), next()};
      if (!(a.band[0] >= 0 && a.band[1] > a.band[0])) throw Misuse{"--band needs 0 <= LOW < HIGH"};
    } else if (option == "--until") {
      a.until = seconds(option, next());
    } else if (option == "--sample-time") {
      a.sample_time = seconds(option, next());
    } else if (option == "--minimize-up-to") {
      a.minimize_up_to = count(option, next());
    } else if (option == "--omega") {
      const double low = next(), high = next();
      if (!(low > 0 && high >= low)) throw Misuse{"--omega needs 0 < LOW <= HIGH"};
      a.omega = logarithmic(low, high, count("COUNT of --omega", next(), 1));
    } else if (option == "--parent") {
      a.parent = word();
    } else if (option == "--children") {
      a.children = word();
    } else if (option == "--grids") {
      a.grids = word();
    } else if (option == "--matrices") {
      a.matrices = word();
    } else if (option == "--units") {
      a.units = {next(), next(), next()};
    } else if (option == "--mass") {
      for (int k = 0; k < 7; ++k) a.mass.push_back(next());
    } else if (option == "--modes") {
      a.modes = count(option, next());
    } else if (option == "--xi") {
      a.xi = next();
    } else if (option == "--set") {
      a.set.push_back(assignment(option, word()));
      for (std::size_t k = 0; k + 1 < a.set.size(); ++k)
        if (a.set[k].first == a.set.back().first)
          throw Misuse{fmt::format("--set {} is there twice", a.set[k].first)};
    } else if (option == "--inputs") {
      a.inputs = word();
    } else if (option == "--outputs") {
      a.outputs = word();
    } else if (option == "--accuracy") {
      a.accuracy = next();
    } else if (option == "--record") {
      a.record = word();
    } else if (option == "--unit-step") {
      a.unit_step = word();
    } else if (option == "--step") {
      a.step = seconds(option, next());
    } else if (option == "--delay") {
      a.delay = seconds(option, next());
    } else if (option == "--part") {
      std::tie(a.part, a.parts) = part(option, word());
    } else if (option.starts_with("-")) {
      throw Misuse{fmt::format("there is no option {}", option)};
    } else {
      a.words.push_back(option);
    }
  }
  return a;
}

}  // namespace titop::command_line
