#include <fmt/format.h>

#include <cmath>
#include <optional>
#include <titop/analysis/simulation/hold.hpp>
#include <titop/emit/cpp/cpp.hpp>
#include <titop/emit/cpp/form.hpp>
#include <titop/emit/cpp/header.hpp>
#include <titop/emit/cpp/test.hpp>
#include <titop/emit/text/identifier.hpp>
#include <titop/emit/text/literals.hpp>
#include <titop/emit/text/write_file.hpp>
#include <titop/graph/error.hpp>
#include <titop/graph/linalg/rounding.hpp>

namespace titop {

using emit::ModelForm;

namespace {

constexpr int kMostForModes = 400;  // states; sharp eigenvectors cost 100 n^3 in long double

void check(const CppOptions& options) {
  std::vector<Mistake> mistakes;
  if (!emit::is_namespace(options.name))
    mistakes.push_back({Code::bad_value,
                        fmt::format("\"{}\" cannot be the name of generated code", options.name),
                        {},
                        "give a C++ identifier that is no keyword and no name of the C library, "
                        "such as satellite_2"});
  if (!(options.sample_time >= 0) || !std::isfinite(options.sample_time))
    mistakes.push_back({Code::bad_value,
                        fmt::format("a sample time of {} s", options.sample_time),
                        {},
                        "give a positive time in seconds, or 0 for code without step"});
  if (!mistakes.empty()) throw Error(std::move(mistakes));
}

/// Accurate enough compared with the model's own states: no more than a digit lost.
bool serves(const ModelForm& modes, const ModelForm& own) {
  constexpr double kEnough = 1e-12;  // as of a transfer
  const auto alike = [&](double error, double before) {
    return error <= std::max(kEnough, before / linalg::kOneDigit);
  };
  return alike(modes.error, own.error) && alike(modes.step_error, own.step_error);
}

ModelForm choose(ModelForm own, ModelForm modes, const CppOptions& options) {
  if (options.states == CppStates::modes && !serves(modes, own))
    throw Error(Code::bad_value,
                fmt::format("modes of {} lose digits: error {:.1e}, in the model's own states "
                            "{:.1e}",
                            options.name, std::max(modes.error, modes.step_error),
                            std::max(own.error, own.step_error)),
                "take CppStates::automatic; free rigid motion has no modes of its own");
  if (options.states == CppStates::modes) return modes;
  if (options.states == CppStates::model || !serves(modes, own)) return own;
  return emit::products(modes) < emit::products(own) ? modes : own;
}

std::optional<Eigen::MatrixXd> static_gain(const System& system) {
  try {
    return system.static_gain();
  } catch (const Error& error) {
    if (error.has(Code::singular)) return std::nullopt;
    throw;
  }
}

emit::Expected expectations(const System& system, double sample_time) {
  const StateSpace& m = system.state_space();
  emit::Expected e;
  e.poles = system.poles();
  if (m.inputs.empty() || m.outputs.empty()) return e;
  e.points = emit::response_points(system, e.poles);
  if (e.points.s.empty())
    throw Error(
        Code::bad_value,
        fmt::format("the accuracy of the code of {} cannot be measured: its transfer has no "
                    "digit at any of the points",
                    system.stage().source->name),
        "look at the warnings of the log, or reduce the model to the band that matters: "
        "compile(d, Scene{.band_hz = {low, high}})");
  e.static_gain = static_gain(system);
  if (sample_time > 0) {
    e.inputs = emit::trajectory_inputs(m.B.cols(), 60);
    e.outputs = held_response(m, sample_time, e.inputs);
  }
  return e;
}

void measure(ModelForm& form, const emit::Expected& e, double sample_time) {
  if (sample_time > 0) emit::add_hold(form, sample_time);
  if (e.points.s.empty()) return;
  form.error = emit::response_error(form, e.points);
  if (e.static_gain) form.static_error = emit::static_error(form, *e.static_gain, e.points);
  if (sample_time > 0) form.step_error = emit::step_error(form, e.inputs, e.outputs, e.points);
}

void refuse_unmeasured_modes(const emit::Expected& expected, const CppOptions& options) {
  if (options.states != CppStates::modes || !expected.points.s.empty()) return;
  throw Error(
      Code::bad_value,
      fmt::format("the accuracy of the modes of {} cannot be measured without inputs and outputs",
                  options.name),
      "take CppStates::automatic, or declare an input and an output");
}

void refuse_few_digits(const ModelForm& form, const std::string& name) {
  if (emit::is_provable(form.error)) return;
  throw Error(Code::bad_value,
              fmt::format("written as A, B, C, D the model {} is off by {:.1e}", name, form.error),
              "System::transfer, apply and simulate keep the digits; or reduce the model to the "
              "required band, compile(d, Scene{.band_hz = {low, high}}): it is small, has an error "
              "bound, and as an Lti of another diagram it becomes C++");
}

}  // namespace

CppModel generate_cpp(const System& system, const CppOptions& options) {
  check(options);
  const StateSpace& m = system.state_space();
  const emit::Naming names{system.stage().graph.name, options.name, m.states, m.inputs, m.outputs,
                           options.sample_time};
  const emit::Expected expected = expectations(system, options.sample_time);
  refuse_unmeasured_modes(expected, options);
  ModelForm own = emit::own_form(m), modes = own;
  measure(own, expected, options.sample_time);
  const bool wanted = options.states == CppStates::modes ||
                      (options.states == CppStates::automatic && m.order() <= kMostForModes);
  if (wanted && !expected.points.s.empty() && m.order() > 0) {
    modes = emit::modal_form(m);
    measure(modes, expected, options.sample_time);
  }
  const ModelForm form = choose(std::move(own), std::move(modes), options);
  refuse_few_digits(form, options.name);
  return {options.name,
          emit::header_text(names, form),
          emit::test_text(names, form, expected),
          form.modal,
          form.error,
          emit::products(form)};
}

void write(const CppModel& model, const std::filesystem::path& folder) {
  emit::write_file(folder / (model.name + ".hpp"), model.header);
  emit::write_file(folder / (model.name + "_test.cpp"), model.test);
}

}  // namespace titop
