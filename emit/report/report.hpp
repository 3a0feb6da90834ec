#pragma once

#include <array>
#include <filesystem>
#include <optional>
#include <string>
#include <titop/analysis/bracket/interface_bracket.hpp>
#include <titop/compiler/system/system.hpp>
#include <utility>
#include <vector>

/// A report of a compiled diagram.
namespace titop {

/// Options of `report_html` and `write_report`.
struct ReportOptions {
  std::string title = {};   ///< empty: the diagram's name
  std::string remark = {};  ///< a paragraph below it: purpose, revision, date
  /// The scene before and after the passes, drawn by Graphviz (`dot`); the only program needed.
  bool diagrams = true;
  int fold = 40;  ///< at most so many boxes per diagram (DotOptions::fold); 0: all blocks
  std::array<double, 2> band_hz = {0, 0};  ///< of frequency responses [Hz]; {0, 0}: by the poles
  double until = 0;                        ///< end of time responses [s]; 0: by the poles
  /// Responses to show, as scalars {"tip1(3)", "W(3)"}: output, input. Empty: of every pair of
  /// vectors (three translations or rotations of one signal) the entry with the highest peak.
  std::vector<std::pair<std::string, std::string>> pairs = {};
  /// Units of inputs and outputs, if they do not follow from the connected ports (behind a gain, of
  /// a controller's signals): {"r", "rad"}, or of one scalar, {"U(3)", "N"}.
  std::vector<std::pair<std::string, std::string>> units = {};
  /// Up to this many states (System::order()) the full certificate and the margins of loop points
  /// are made, too, and mode shapes up to four times as many: O(n^3).
  int full_up_to = 100;
  /// interface_bracket of the same scene: a section shows how much the lumping of its interfaces of
  /// many nodes costs, mode by mode.
  std::optional<InterfaceBracket> bracket = {};
};

/// A report as one self-contained HTML text: no script, no network. It contains the scene before
/// and after the passes, inputs and outputs with their units, poles with the blocks that take part,
/// shapes of the six slowest modes (of the band, if given), singular values, Bode plots and step
/// responses, margins and Nyquist curves of loop points (up to ReportOptions::full_up_to states),
/// the certificate in words, the order with the removed states and the reasons, and result and time
/// of every pass. All text of any origin is escaped. For screens, light and dark, and for paper;
/// lines also differ without colour.
///
/// The text is the same on every run except for the times and for the drawings of another version
/// of Graphviz.
///
/// Throws bad_file, with the way out, if `dot` is missing or fails; unknown_name for `pairs` and
/// `units` that name no input or output; bad_value for an invalid band or end. Cost:
/// O(n^3) of the dense model, some hundred transfers, and one simulation per shown input.
std::string report_html(const System& system, const ReportOptions& options = {});

/// The same into a file. Throws bad_file.
void write_report(const System& system, const std::filesystem::path& file,
                  const ReportOptions& options = {});

}  // namespace titop
