#include "signals.hpp"

namespace titop::python {
namespace {

using Path = std::filesystem::path;
using LowHigh = std::array<double, 2>;

void bind_diagram_files(py::module_& m) {
  m.def("diagram_json", &diagram_json, "diagram"_a, "The diagram as JSON text, to the last bit.");
  m.def("write_diagram", &write_diagram, "diagram"_a, "file"_a, "The same into a file.");
  m.def(
      "parse_diagram",
      [](const std::string& json, const std::string& file) {
        return std::make_shared<Diagram>(parse_diagram(json, file));
      },
      "json"_a, "file"_a = "diagram", "The diagram of such a text.");
  m.def(
      "read_diagram",
      [](const Path& file) { return std::make_shared<Diagram>(read_diagram(file)); }, "file"_a,
      "The diagram of such a file.");
  m.def(
      "diagram_of_model",
      [](const StateSpace& model, const std::string& name) {
        return std::make_shared<Diagram>(diagram_of_model(model, name));
      },
      "model"_a, "name"_a, "A diagram of a StateSpace alone, with its inputs and outputs.");
  m.def(
      "to_dot", [](const Diagram& d, int fold) { return to_dot(d, DotOptions{fold}); }, "diagram"_a,
      "fold"_a = 0, "Graphviz text of a diagram; about `fold` boxes, 0: every block.");
  m.def(
      "to_dot", [](const System& s, int fold) { return to_dot(s.stage(), DotOptions{fold}); },
      "system"_a, "fold"_a = 0, "The same after all passes.");
}

template <class Model>
void def_written(py::module_& m) {
  m.def("write_mat", py::overload_cast<const Model&, const Path&>(&write_mat), "system"_a, "file"_a,
        Unlocked(), "A MAT-file (version 5) with A, B, C, D and the names.");
  m.def("write_numpy",
        py::overload_cast<const Model&, const Path&, const std::string&>(&write_numpy), "system"_a,
        "folder"_a, "name"_a, Unlocked(),
        "A Python module FOLDER/NAME.py with A, B, C, D, names, transfer(s) and poles().");
}

void bind_model_files(py::module_& m) {
  m.def("model_json", &model_json, "system"_a, Unlocked(),
        "The whole model and its properties as one JSON object.");
  m.def("write_json", py::overload_cast<const System&, const Path&>(&write_json), "system"_a,
        "file"_a, Unlocked(), "The same into a file.");
  m.def("write_json", py::overload_cast<const FullCertificate&, const Path&>(&write_json),
        "system"_a, "file"_a, "A full certificate as JSON.");
  m.def("write_json", py::overload_cast<const Lft&, const Path&>(&write_json), "system"_a, "file"_a,
        "An Lft as JSON.");
  m.def("certificate_json", &certificate_json, "certificate"_a, "A full certificate as JSON.");
  m.def("lft_json", &lft_json, "lft"_a, "An Lft as JSON.");
  m.def("dense_warnings", &dense_warnings, "system"_a, Unlocked(),
        "The log's warnings of state_space(): lost digits of A, B, C, D.");
  m.def("write_matlab", py::overload_cast<const System&, const Path&>(&write_matlab), "system"_a,
        "file"_a, Unlocked(), "A MATLAB or Octave function with the model.");
  m.def("write_matlab", py::overload_cast<const StateSpace&, const Path&>(&write_matlab),
        "system"_a, "file"_a, "The same of a StateSpace.");
  m.def("write_matlab", py::overload_cast<const Lft&, const Path&>(&write_matlab), "system"_a,
        "file"_a, "The same of an Lft, with a uss.");
  def_written<System>(m);
  def_written<StateSpace>(m);
  m.def("write_numpy", py::overload_cast<const Lft&, const Path&, const std::string&>(&write_numpy),
        "system"_a, "folder"_a, "name"_a, "The same of an Lft, with at(parameter=value).");
  m.def(
      "write_csv",
      [](const System& s, const std::vector<double>& omega, const Path& file) {
        write_csv(s, omega, file);
      },
      "system"_a, "omega"_a, "file"_a, Unlocked(), "Frequency response as CSV, omega [rad/s].");
  m.def(
      "write_cpp",
      [](const System& s, const Path& folder, const std::string& name, double sample_time,
         const std::string& states) {
        const auto kept = named<CppStates>(states, "states",
                                           {{"automatic", CppStates::automatic},
                                            {"model", CppStates::model},
                                            {"modes", CppStates::modes}});
        write(generate_cpp(s, {name, sample_time, kept}), folder);
      },
      "system"_a, "folder"_a, "name"_a, "sample_time"_a = 0.0, "states"_a = "automatic", Unlocked(),
      "The model as a C++17 header NAME.hpp without dependencies, and its test NAME_test.cpp; with "
      "a sample time [s] also `step`. states: automatic, model or modes.");
}

using Pairs = std::vector<std::pair<std::string, std::string>>;

void bind_reports(py::module_& m) {
  m.def(
      "report_html",
      [](const System& s, const std::string& title, const std::string& remark, bool diagrams,
         int fold, const LowHigh& band_hz, double until, const Pairs& pairs, const Pairs& units,
         int full_up_to) {
        return report_html(
            s, {title, remark, diagrams, fold, band_hz, until, pairs, units, full_up_to});
      },
      "system"_a, py::kw_only(), "title"_a = "", "remark"_a = "", "diagrams"_a = true,
      "fold"_a = ReportOptions{}.fold, "band_hz"_a = LowHigh{0, 0}, "until"_a = 0.0,
      "pairs"_a = Pairs(), "units"_a = Pairs(), "full_up_to"_a = ReportOptions{}.full_up_to,
      Unlocked(),
      "A report as one self-contained HTML text: diagrams (by Graphviz, of at most `fold` boxes), "
      "poles, Bode plots, step responses, certificate. band_hz [Hz] and until [s]: 0, by the "
      "poles; pairs [(output, input)] to show; units [(signal, unit)]; margins and mode shapes up "
      "to full_up_to states.");
}

PlotOptions plot_options(const std::string& title, const LowHigh& band_hz, double until) {
  return {title, band_hz, until};
}

void bind_plots(py::module_& m) {
  m.def(
      "plot_bode",
      [](const System& s, const std::string& output, const std::string& input,
         const std::string& title, const LowHigh& band_hz) {
        return plot_bode(s, output, input, plot_options(title, band_hz, 0));
      },
      "system"_a, "output"_a, "input"_a, py::kw_only(), "title"_a = "", "band_hz"_a = LowHigh{0, 0},
      Unlocked(),
      "Magnitude and phase of one output for one input, by their names, as SVG; band [Hz].");
  m.def(
      "plot_step",
      [](const System& s, const std::string& output, const std::string& input,
         const std::string& title, double until) {
        return plot_step(s, output, input, plot_options(title, LowHigh{0, 0}, until));
      },
      "system"_a, "output"_a, "input"_a, py::kw_only(), "title"_a = "", "until"_a = 0.0, Unlocked(),
      "Response of one output to a unit step of one input, as SVG, until a time [s].");
  m.def(
      "plot_sigma",
      [](const System& s, const std::string& title, const LowHigh& band_hz) {
        return plot_sigma(s, plot_options(title, band_hz, 0));
      },
      "system"_a, py::kw_only(), "title"_a = "", "band_hz"_a = LowHigh{0, 0}, Unlocked(),
      "Singular values of the whole transfer, as SVG; band [Hz].");
  m.def(
      "plot_nyquist",
      [](const ControlLoop& l, const std::string& title) {
        return plot_nyquist(l, plot_options(title, LowHigh{0, 0}, 0));
      },
      "loop"_a, py::kw_only(), "title"_a = "", Unlocked(),
      "L(j omega) of each loop point with the others closed, as SVG.");
  m.def(
      "plot_poles",
      [](const System& s, const std::string& title, const LowHigh& band_hz) {
        return plot_poles(s, plot_options(title, band_hz, 0));
      },
      "system"_a, py::kw_only(), "title"_a = "", "band_hz"_a = LowHigh{0, 0}, Unlocked(),
      "Poles and transmission zeros, as SVG; band [Hz].");
  m.def(
      "plot_mode",
      [](const System& s, int pole, const std::string& title, double azimuth, double elevation,
         double amplitude) {
        return plot_mode(s, pole, {title, azimuth, elevation, amplitude});
      },
      "system"_a, "pole"_a, py::kw_only(), "title"_a = "", "azimuth"_a = ModePlotOptions{}.azimuth,
      "elevation"_a = ModePlotOptions{}.elevation, "amplitude"_a = ModePlotOptions{}.amplitude,
      Unlocked(),
      "The structure in the mode of this index in system.poles(), as SVG: its points at rest and\n"
      "displaced, seen from this direction [deg], the largest displacement relative to its size.");
}

}  // namespace

void bind_files(py::module_& m) {
  bind_diagram_files(m);
  bind_model_files(m);
  bind_reports(m);
  bind_plots(m);
}

}  // namespace titop::python
