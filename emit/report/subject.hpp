#pragma once

#include <string>
#include <titop/analysis/certify/certify_full.hpp>
#include <titop/emit/report/report.hpp>
#include <titop/emit/report/units.hpp>

namespace titop::report {

/// The subject of a report: computed once, read by all sections.
struct Subject {
  const System& system;
  const ReportOptions& options;
  std::vector<ScalarSignal> inputs, outputs;
  std::vector<Pole> poles;
};

/// Throws unknown_name, bad_value for invalid options.
Subject subject(const System& system, const ReportOptions& options);

/// Neighbouring scalars of one signal with one unit: three translations, three rotations, a scalar.
struct UnitGroup {
  std::string signal, unit;
  std::vector<int> at;  ///< rows or columns
};
std::vector<UnitGroup> groups(const std::vector<ScalarSignal>& scalars);

/// An output and an input whose response is shown, with their groups.
struct IoPair {
  int output = 0, input = 0;
  int output_group = 0, input_group = 0;
};

/// "m/s² / N"; an unknown unit is the user's, "rad / user's unit"; both: "user's units".
std::string ratio(const std::string& output_unit, const std::string& input_unit);
std::string or_users(const std::string& unit);

/// Singular values and Bode plots; step responses. `pairs`: those of ReportOptions::pairs, or the
/// default described there. Each returns the section's HTML.
struct Responses {
  std::vector<IoPair> pairs;
  std::string frequency, time;
};
Responses responses(const Subject& subject);

/// The other sections: HTML.
std::string scene_section(const Subject& subject);
std::string poles_section(const Subject& subject);
/// The first modes; empty for a diagram without points in space.
std::string modes_section(const Subject& subject);
/// The bracket of ReportOptions; empty without one.
std::string bracket_section(const Subject& subject);
/// Margins of every loop point; empty without any, or beyond ReportOptions::full_up_to.
std::string margins_section(const Subject& subject);
std::string certificate_section(const Subject& subject, const FullCertificate* full);
std::string order_section(const Subject& subject, const FullCertificate* full);
std::string passes_section(const Subject& subject, const FullCertificate* full);

/// The summary: stability, order, whether all checks hold; warnings.
std::string summary(const Subject& subject, const FullCertificate* full);

}  // namespace titop::report
