#include "commands/analyses.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <titop/emit/text/csv.hpp>
#include <titop/emit/text/write_file.hpp>
#include <titop/graph/linalg/rounding.hpp>

#include "commands/diagram.hpp"
#include "commands/ranks.hpp"
#include "commands/table.hpp"

namespace titop::command_line {
namespace {

namespace fs = std::filesystem;

void print(const std::string& text) { std::fputs(text.c_str(), stdout); }

void require_csv(const std::string& file) {
  if (fs::path(file).extension() != ".csv")
    throw Misuse{fmt::format("'{}' has an unknown extension: .csv", file)};
}

/// Place of an input by its name, "U" or "U(2)"; `from` names the place in the message.
Eigen::Index place_of_input(const System& system, const std::string& name,
                            const std::string& from) {
  const std::vector<std::string>& names = system.inputs();
  const auto found = std::find(names.begin(), names.end(), name);
  if (found == names.end())
    throw Error(
        Code::unknown_name, fmt::format("{}: there is no input {}", from, name),
        names.empty() ? "it has none" : fmt::format("the inputs are {}", fmt::join(names, ", ")));
  return found - names.begin();
}

/// A table of "time" and inputs, those that are left out at 0.
Excitation recorded_inputs(const System& system, const std::string& file) {
  const CsvTable table = read_table(file);
  if (table.names.front() != "time" && table.names.front() != "time [s]")
    throw Error(Code::bad_file,
                fmt::format("{}: the first column is {}", file, table.names.front()),
                "call the first column time; it has seconds, ascending");
  if (table.names.size() == 1 && !system.inputs().empty())
    throw Error(Code::bad_file, fmt::format("{}: no column but {}", file, table.names.front()),
                fmt::format("add a column for each input that is not 0: the inputs are {}",
                            fmt::join(system.inputs(), ", ")));
  const auto columns = static_cast<Eigen::Index>(table.rows.size());
  Eigen::MatrixXd u = Eigen::MatrixXd::Zero(std::ssize(system.inputs()), columns);
  std::vector<double> times;
  for (std::size_t r = 0; r < table.rows.size(); ++r) {
    times.push_back(table.rows[r].front());
    if (r > 0 && times[r] < times[r - 1])
      throw Error(
          Code::bad_file,
          fmt::format("{}: the time {} s after {} s", table.place(r), times[r], times[r - 1]),
          "give ascending times; a jump is two equal times");
  }
  for (std::size_t c = 1; c < table.names.size(); ++c) {
    const Eigen::Index input = place_of_input(system, table.names[c], file);
    for (Eigen::Index k = 0; k < columns; ++k)
      u(input, k) = table.rows[static_cast<std::size_t>(k)][c];
  }
  return Excitation::recorded(std::move(times), std::move(u));
}

Excitation excitation_of(const System& system, const Arguments& a) {
  if (!a.record.empty()) return recorded_inputs(system, a.record);
  Eigen::VectorXd u = Eigen::VectorXd::Zero(std::ssize(system.inputs()));
  u(place_of_input(system, a.unit_step, "--unit-step")) = 1;
  return Excitation::step(u);
}

/// Rows of the table that belong to --part.
std::pair<std::size_t, std::size_t> part_of(const Arguments& a, std::size_t rows) {
  const auto part = static_cast<std::size_t>(a.part), parts = static_cast<std::size_t>(a.parts);
  return {rows * (part - 1) / parts, rows * part / parts};
}

ParameterList point_of(const CsvTable& table, const std::vector<double>& row) {
  ParameterList point;
  for (std::size_t c = 0; c < table.names.size(); ++c) point.emplace_back(table.names[c], row[c]);
  return point;
}

/// Every column must be a parameter.
void require_parameters(const System& system, const CsvTable& table) {
  std::vector<std::string> names;
  for (const auto& parameter : system.parameters()) names.push_back(parameter.first);
  for (const std::string& column : table.names)
    if (std::find(names.begin(), names.end(), column) == names.end())
      throw Error(Code::unknown_name,
                  fmt::format("{}: the diagram has no parameter {}", table.file, column),
                  names.empty() ? "it has none"
                                : fmt::format("its parameters are {}", fmt::join(names, ", ")));
}

/// A line for each pole, or pair of them.
std::string poles_at(const System& system, const std::string& point) {
  std::string text;
  for (const Pole& p : system.poles())
    text += fmt::format("{},{},{},{},{}\n", point, p.hertz, p.damping, p.s.real(), p.s.imag());
  return text;
}

/// A line for each frequency.
std::string responses_at(const System& system, const std::vector<double>& omega,
                         const std::string& point) {
  std::string text;
  const std::vector<Eigen::MatrixXcd> response = system.frequency_response(omega);
  for (std::size_t k = 0; k < omega.size(); ++k) {
    text += fmt::format("{},{}", point, omega[k]);
    for (Eigen::Index i = 0; i < response[k].rows(); ++i)
      for (Eigen::Index j = 0; j < response[k].cols(); ++j)
        text += fmt::format(",{},{}", response[k](i, j).real(), response[k](i, j).imag());
    text += "\n";
  }
  return text;
}

std::vector<std::string> columns_of(const System& system, const Arguments& a,
                                    const std::vector<std::string>& parameters) {
  std::vector<std::string> names = {"point"};
  names.insert(names.end(), parameters.begin(), parameters.end());
  if (a.omega.empty()) {
    names.insert(names.end(), {"pole_hertz", "pole_damping", "pole_re", "pole_im"});
  } else {
    names.push_back("rad_per_s");
    for (const std::string& out : system.outputs())
      for (const std::string& in : system.inputs())
        for (const char* part : {"re", "im"})
          names.push_back(fmt::format("{}({}/{})", part, out, in));
  }
  for (auto i = names.begin(); i != names.end(); ++i)
    if (std::find(names.begin(), i, *i) != i)
      throw Error(Code::duplicate_name, fmt::format("two columns of the result are called {}", *i),
                  "give the parameter, input or output another name");
  return names;
}

/// Rows of a sweep: the lines of their results, and the errors of those that are refused.
struct SweptRows {
  std::string lines, faults;
};

/// Each row for itself: one that is refused leaves the others.
SweptRows swept(const System& system, const CsvTable& table, const Arguments& a,
                const Ranks& ranks) {
  const auto [from, to] = part_of(a, table.rows.size());
  const auto [begin, end] = ranks.part(from, to);
  std::vector<std::string> lines(end - begin), faults(end - begin);
  const auto visit = [&, begin = begin](std::size_t i, const System&) {
    const std::vector<double>& row = table.rows[begin + i];
    const std::string point = fmt::format("{},{}", begin + i + 1, fmt::join(row, ","));
    try {
      const System at = system.update(point_of(table, row));
      lines[i] = a.omega.empty() ? poles_at(at, point) : responses_at(at, a.omega, point);
    } catch (const Error& error) {
      faults[i] = fmt::format("{}: {}\n", table.place(begin + i), error.what());
    }
  };
  SweepOptions options;
  if (ranks.first()) options.progress = progress_line();
  sweep(system, std::vector<ParameterList>(lines.size()), visit, options);
  return {fmt::format("{}", fmt::join(lines, "")), fmt::format("{}", fmt::join(faults, ""))};
}

/// By all processes; the first one writes the file and the errors.
int sweep_of(const Arguments& a, const Ranks& ranks) {
  require_csv(a.words[2]);
  require_csv(a.words[3]);
  const CsvTable table = read_table(a.words[2]);
  const System system = compiled(a);
  require_parameters(system, table);
  const std::string names = emit::csv_line(columns_of(system, a, table.names)) + "\n";
  SweptRows rows;
  try {
    rows = swept(system, table, a, ranks);
  } catch (const std::exception& error) {
    ranks.abort(error.what());
    throw;
  }
  const std::string lines = ranks.joined(rows.lines), faults = ranks.joined(rows.faults);
  if (!ranks.first()) return 0;
  emit::write_file(a.words[3], names + lines);
  std::fputs(faults.c_str(), stderr);
  return faults.empty() ? 0 : 1;
}

/// A pole right of the axis by more than the rounding of its modulus.
bool has_unstable_pole(const System& system) {
  for (const Pole& p : system.poles())
    if (p.s.real() > linalg::kPoleOnAxis * p.omega) return true;
  return false;
}

}  // namespace

int margins_of_loops(const Arguments& a) {
  const System system = compiled(a);
  const std::vector<std::string> points = loop_points(system);
  if (points.empty())
    throw Error(Code::unknown_name, fmt::format("{}: the diagram has no loop point", a.words[1]),
                "write one where the loop is to be cut, d.loop_point(\"attitude\", law.out), a "
                "block of type LoopPoint in the file");
  bool stable = true;
  for (const std::string& point : points) {
    const Margins m = margins(loop(system, point), {.delay = a.delay});
    stable &= m.stable;
    print(fmt::format("loop at {}\n{}", point, to_string(m)));
  }
  // Modes that a loop does not move, or does not see, are not in its L.
  const bool hidden = stable && has_unstable_pole(system);
  if (hidden)
    print("the diagram has a pole right of the axis that no loop has: titop compile lists it\n");
  return stable && !hidden ? 0 : 3;
}

void simulate_inputs(const Arguments& a) {
  require_csv(a.words[2]);
  if (a.step == 0 || a.until == 0) throw Misuse{"simulate needs --step SECONDS --until SECONDS"};
  if (a.record.empty() && a.unit_step.empty())
    throw Misuse{"simulate needs --record FILE.csv or --unit-step INPUT"};
  if (!a.record.empty() && !a.unit_step.empty())
    throw Misuse{"simulate takes --record or --unit-step, not both"};
  const System system = compiled(a);
  const Trajectory t =
      simulate(system, excitation_of(system, a),
               {.step = a.step,
                .until = a.until,
                .progress = progress_line(stderr, DrawLine::on_terminals, "steps")});
  std::vector<std::string> names = {"time"};
  names.insert(names.end(), t.outputs.begin(), t.outputs.end());
  std::string text = emit::csv_line(names) + "\n";
  for (std::size_t k = 0; k < t.time.size(); ++k) {
    text += fmt::format("{}", t.time[k]);
    for (Eigen::Index i = 0; i < t.y.rows(); ++i)
      text += fmt::format(",{}", t.y(i, static_cast<Eigen::Index>(k)));
    text += "\n";
  }
  emit::write_file(a.words[2], text);
  print(fmt::format(
      "{} times, {} outputs, stepper {}{}\n", t.time.size(), t.outputs.size(), to_string(t.stepper),
      t.error.size() ? fmt::format(", estimated error {:.1e}", t.error.maxCoeff()) : ""));
}

int sweep_table(const Arguments& a) {
  const Ranks ranks;
  try {
    return sweep_of(a, ranks);
  } catch (...) {  // before the sweep: all processes have the same error
    if (ranks.first()) throw;
    return 0;  // mpirun would end the first process, which writes the error, after another's 1
  }
}

void reduce_scene(const Arguments& a) {
  const fs::path file = a.words[2], folder = file.parent_path();
  const std::string name = file.stem().string(), kind = file.extension().string();
  if (kind != ".m" && kind != ".mat" && kind != ".py" && kind != ".hpp")
    throw Misuse{fmt::format("'{}' has an unknown extension: .m, .mat, .py or .hpp", a.words[2])};
  if (a.sample_time != 0 && kind != ".hpp") throw Misuse{"--sample-time is for a file .hpp"};
  if (a.band.empty()) throw Misuse{"reduce needs --band LOW HIGH"};
  const ReducedSystem reduced = compile(diagram_of(a), Scene{.inputs = separated(a.inputs),
                                                             .outputs = separated(a.outputs),
                                                             .band_hz = {a.band[0], a.band[1]},
                                                             .accuracy = a.accuracy});
  print(to_string(reduced));
  const StateSpace model = reduced.state_space();
  if (kind == ".m") return write_matlab(model, file);
  if (kind == ".mat") return write_mat(model, file);
  if (kind == ".py") return write_numpy(model, folder, name);
  const System system = compile(diagram_of_model(model, name), {.minimize_up_to = 0});
  warn_of_lost_digits(system);
  write(generate_cpp(system, {.name = name, .sample_time = a.sample_time}), folder);
}

}  // namespace titop::command_line
