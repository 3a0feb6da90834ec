#include <fmt/format.h>

#include <titop/emit/report/figures.hpp>

namespace titop::report {

Responses responses(const Subject& s) {
  if (s.inputs.empty() || s.outputs.empty()) {
    const std::string none =
        fmt::format("<p>The scene has no {}: there is no response to show.</p>\n",
                    s.inputs.empty() ? "inputs" : "outputs");
    return {{}, none, none};
  }
  const std::vector<UnitGroup> outputs = groups(s.outputs), inputs = groups(s.inputs);
  const Sweep w = sweep(s);
  Responses r;
  r.pairs = s.options.pairs.empty() ? strongest(s, w, outputs, inputs) : asked(s, outputs, inputs);
  if (r.pairs.empty()) {
    r.frequency = r.time = "<p>No input reaches any output: all responses are 0.</p>\n";
    return r;
  }
  r.frequency = singular_value_plots(w, outputs, inputs) + bode_plots(s, w, r.pairs);
  r.time = step_plots(s, r.pairs);
  return r;
}

}  // namespace titop::report
