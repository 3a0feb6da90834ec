#include "options.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <system_error>
#include <tuple>

namespace titop::command_line {
namespace {

constexpr int kMost = 1'000'000;  ///< upper limit of counts

double number_of(const std::string& option, const std::string& text) {
  double value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc() || end != text.data() + text.size() || !std::isfinite(value))
    throw Misuse{fmt::format("{}: '{}' is no number", option, text)};
  return value;
}

int count_of(const std::string& option, double value, int least = 0) {
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

/// NAME=VALUE, each name once.
void read_set(Arguments& a, OptionWords& w) {
  const std::string& text = w.word();
  const std::size_t at = text.find('=');
  if (at == 0 || at == std::string::npos)
    throw Misuse{fmt::format("{} needs NAME=VALUE, not '{}'", w.option, text)};
  const std::string name = text.substr(0, at);
  for (const auto& [before, value] : a.set)
    if (before == name) throw Misuse{fmt::format("--set {} is there twice", name)};
  a.set.emplace_back(name, number_of(w.option, text.substr(at + 1)));
}

/// I/N.
void read_part(Arguments& a, OptionWords& w) {
  const std::string& text = w.word();
  const std::size_t at = text.find('/');
  if (at == std::string::npos) throw Misuse{fmt::format("{} needs I/N, not '{}'", w.option, text)};
  a.parts = count_of(w.option, number_of(w.option, text.substr(at + 1)), 1);
  a.part = count_of(w.option, number_of(w.option, text.substr(0, at)), 1);
  if (a.part > a.parts)
    throw Misuse{fmt::format("{}: there is no part {} of {}", w.option, a.part, a.parts)};
}

void read_band(Arguments& a, OptionWords& w) {
  a.band = {w.number(), w.number()};
  if (!(a.band[0] >= 0 && a.band[1] > a.band[0])) throw Misuse{"--band needs 0 <= LOW < HIGH"};
}

void read_omega(Arguments& a, OptionWords& w) {
  const double low = w.number(), high = w.number();
  if (!(low > 0 && high >= low)) throw Misuse{"--omega needs 0 < LOW <= HIGH"};
  a.omega = logarithmic(low, high, count_of("COUNT of --omega", w.number(), 1));
}

void read_mass(Arguments& a, OptionWords& w) {
  for (int k = 0; k < 7; ++k) a.mass.push_back(w.number());
}

template <std::string Arguments::*to>
void read_word(Arguments& a, OptionWords& w) {
  a.*to = w.word();
}
template <double Arguments::*to>
void read_number(Arguments& a, OptionWords& w) {
  a.*to = w.number();
}
template <double Arguments::*to>
void read_seconds(Arguments& a, OptionWords& w) {
  a.*to = w.seconds();
}
template <int Arguments::*to>
void read_count(Arguments& a, OptionWords& w) {
  a.*to = w.count();
}

constexpr OptionRow kOptions[] = {
    {"--set", "NAME=VALUE", "value of a parameter; once for each", read_set},
    {"--fold", "COUNT",
     "draw, report: at most so many boxes, each whole subtrees;\n"
     "draw: all if left out; report: 40, 0 for all",
     read_count<&Arguments::fold>},
    {"--compiled", "", "draw: the diagram after all passes",
     [](Arguments& a, OptionWords&) { a.compiled = true; }},
    {"--mode", "LINE",
     "draw: not the diagram, but the structure in the mode of\n"
     "this line of the table of poles (compile), as .svg",
     [](Arguments& a, OptionWords& w) { a.mode = count_of(w.option, w.number(), 1); }},
    {"-o", "FILE",
     "report: the HTML file; certify: also writes JSON;\n"
     "import: the body",
     read_word<&Arguments::to>},
    {"--parent", "PORT", "import: parent port of the body", read_word<&Arguments::parent>},
    {"--children", "PORT,PORT", "import: child ports of the body", read_word<&Arguments::children>},
    {"--grids", "FILE",
     "import: bulk data with positions, FILE.asm if left out;\n"
     "of an f06 its own echo, or FILE.bdf, .dat, .nas",
     read_word<&Arguments::grids>},
    {"--matrices", "K,M", "import: names of stiffness and mass", read_word<&Arguments::matrices>},
    {"--units", "METRE KILOGRAM SECOND", "import: of the file, 1e-3 1 1 for mm, kg, s",
     [](Arguments& a, OptionWords& w) {
       a.units = {w.number(), w.number(), w.number()};
     }},
    {"--mass", "M X Y Z JX JY JZ",
     "import: of a planar model, the whole body's mass, centre of\n"
     "mass from the parent and inertia there, in units of FILE",
     read_mass},
    {"--modes", "COUNT",
     "import: lowest modes that are kept, and residual vectors\n"
     "of all ports; all modes if left out",
     read_count<&Arguments::modes>},
    {"--xi", "RATIO", "import: damping ratio of all modes", read_number<&Arguments::xi>},
    {"--band", "LOW HIGH", "report: of the frequency responses, Hz; reduce", read_band},
    {"--inputs", "NAME,NAME",
     "reduce: inputs that the model has; all if left out;\n"
     "NAME has quotation marks if it has a comma: '\"a,b\",c'",
     read_word<&Arguments::inputs>},
    {"--outputs", "NAME,NAME",
     "reduce: outputs that the model has; all if left out;\n"
     "NAME has quotation marks if it has a comma: '\"a,b\",c'",
     read_word<&Arguments::outputs>},
    {"--accuracy", "ERROR", "reduce: relative to the peaks, 1e-3 if left out",
     read_number<&Arguments::accuracy>},
    {"--until", "SECONDS", "report: of the step responses; simulate",
     read_seconds<&Arguments::until>},
    {"--step", "SECONDS", "simulate: between the times of the result",
     read_seconds<&Arguments::step>},
    {"--record", "FILE.csv",
     "simulate: inputs over time: a column time, in seconds, and\n"
     "at least one input by name, the others are 0; linear in\n"
     "between, jumps are two equal times",
     read_word<&Arguments::record>},
    {"--unit-step", "INPUT", "simulate: this input is 1, the others are 0",
     read_word<&Arguments::unit_step>},
    {"--delay", "SECONDS", "margins: an additional delay in the loop",
     read_seconds<&Arguments::delay>},
    {"--part", "I/N", "sweep: the I-th of N parts of the rows", read_part},
    {"--no-diagrams", "", "report: without drawings, which need Graphviz",
     [](Arguments& a, OptionWords&) { a.diagrams = false; }},
    {"--sample-time", "SECONDS", "for .hpp: also `step`", read_seconds<&Arguments::sample_time>},
    {"--omega", "LOW HIGH COUNT", "for .csv: rad/s, logarithmic", read_omega},
    {"--minimize-up-to", "STATES", "100 if left out; 0: never",
     read_count<&Arguments::minimize_up_to>}};

}  // namespace

const std::string& OptionWords::word() {
  if (++at_ == all_.size() || all_[at_].starts_with("--"))
    throw Misuse{fmt::format("{} needs more", option)};
  return all_[at_];
}

double OptionWords::number() { return number_of(option, word()); }

double OptionWords::seconds() {
  const double value = number();
  if (!(value > 0)) throw Misuse{option + " needs a time above 0"};
  return value;
}

int OptionWords::count() { return count_of(option, number()); }

std::span<const OptionRow> option_table() { return kOptions; }

}  // namespace titop::command_line
