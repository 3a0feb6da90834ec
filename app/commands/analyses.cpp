#include "commands/analyses.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <titop/emit/text/write_file.hpp>

#include "commands/diagram.hpp"
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
    throw Error(Code::unknown_name, fmt::format("{}: there is no input {}", from, name),
                fmt::format("the inputs are {}", fmt::join(names, ", ")));
  return found - names.begin();
}

/// A table of "time" and inputs, those that are left out at 0.
Excitation recorded_inputs(const System& system, const std::string& file) {
  const Table table = read_table(file);
  if (table.names.front() != "time")
    throw Error(Code::bad_file,
                fmt::format("{}: the first column is {}", file, table.names.front()),
                "begin with a column named time [s], ascending");
  const auto columns = static_cast<Eigen::Index>(table.rows.size());
  Eigen::MatrixXd u = Eigen::MatrixXd::Zero(std::ssize(system.inputs()), columns);
  std::vector<double> times;
  for (const std::vector<double>& row : table.rows) times.push_back(row.front());
  for (std::size_t c = 1; c < table.names.size(); ++c) {
    const Eigen::Index input = place_of_input(system, table.names[c], file);
    for (Eigen::Index k = 0; k < columns; ++k)
      u(input, k) = table.rows[static_cast<std::size_t>(k)][c];
  }
  return Excitation::recorded(std::move(times), std::move(u));
}

Excitation excitation_of(const System& system, const Arguments& a) {
  if (a.record.empty() == a.unit_step.empty())
    throw Misuse{"simulate needs --record FILE.csv or --unit-step INPUT"};
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

std::string numbers(const std::vector<double>& row) {
  return fmt::format("{}", fmt::join(row, ","));
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
    names.insert(names.end(), {"hertz", "damping", "re", "im"});
    return names;
  }
  names.push_back("rad_per_s");
  for (const std::string& out : system.outputs())
    for (const std::string& in : system.inputs())
      for (const char* part : {"re", "im"})
        names.push_back(fmt::format("{}({}/{})", part, out, in));
  return names;
}

}  // namespace

void margins_of_loops(const Arguments& a) {
  const System system = compiled(a);
  const std::vector<std::string> points = loop_points(system);
  if (points.empty())
    throw Error(Code::unknown_name, fmt::format("{}: the diagram has no loop point", a.words[1]),
                "write one where the loop is to be cut, d.loop_point(\"attitude\", law.out), a "
                "block of type LoopPoint in the file");
  for (const std::string& point : points)
    print(fmt::format("loop at {}\n{}", point,
                      to_string(margins(loop(system, point), {.delay = a.delay}))));
}

void simulate_inputs(const Arguments& a) {
  require_csv(a.words[2]);
  if (a.step == 0 || a.until == 0) throw Misuse{"simulate needs --step SECONDS --until SECONDS"};
  const System system = compiled(a);
  const Trajectory t =
      simulate(system, excitation_of(system, a), {.step = a.step, .until = a.until});
  std::vector<std::string> names = {"time"};
  names.insert(names.end(), t.outputs.begin(), t.outputs.end());
  std::string text = header_of(names) + "\n";
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

void sweep_table(const Arguments& a) {
  require_csv(a.words[3]);
  const Table table = read_table(a.words[2]);
  const auto [first, end] = part_of(a, table.rows.size());
  std::vector<ParameterList> points;
  for (std::size_t r = first; r < end; ++r) {
    ParameterList& point = points.emplace_back();
    for (std::size_t c = 0; c < table.names.size(); ++c)
      point.emplace_back(table.names[c], table.rows[r][c]);
  }
  const System system = compiled(a);
  std::vector<std::string> lines(points.size());
  const auto visit = [&](std::size_t i, const System& at) {
    const std::string point = fmt::format("{},{}", first + i + 1, numbers(table.rows[first + i]));
    lines[i] = a.omega.empty() ? poles_at(at, point) : responses_at(at, a.omega, point);
  };
  sweep(system, points, visit, {.progress = progress_line()});
  std::string text = header_of(columns_of(system, a, table.names)) + "\n";
  for (const std::string& line : lines) text += line;
  emit::write_file(a.words[3], text);
}

void reduce_scene(const Arguments& a) {
  const fs::path file = a.words[2], folder = file.parent_path();
  const std::string name = file.stem().string(), kind = file.extension().string();
  if (kind != ".m" && kind != ".py" && kind != ".hpp")
    throw Misuse{fmt::format("'{}' has an unknown extension: .m, .py or .hpp", a.words[2])};
  if (a.sample_time != 0 && kind != ".hpp") throw Misuse{"--sample-time is for a file .hpp"};
  if (a.band.empty()) throw Misuse{"reduce needs --band LOW HIGH"};
  const ReducedSystem reduced = compile(diagram_of(a), Scene{.inputs = separated(a.inputs),
                                                             .outputs = separated(a.outputs),
                                                             .band_hz = {a.band[0], a.band[1]},
                                                             .accuracy = a.accuracy});
  print(to_string(reduced));
  const StateSpace model = reduced.state_space();
  if (kind == ".m") return write_matlab(model, file);
  if (kind == ".py") return write_numpy(model, folder, name);
  const System system = compile(diagram_of_model(model, name), {.minimize_up_to = 0});
  warn_of_lost_digits(system);
  write(generate_cpp(system, {.name = name, .sample_time = a.sample_time}), folder);
}

}  // namespace titop::command_line
