#pragma once

#include <string>
#include <titop/titop.hpp>
#include <vector>

/// The words and options of the command line.
namespace titop::command_line {

/// Words and options as typed; options that were left out have the values below.
struct Arguments {
  std::vector<std::string> words;  ///< without options
  bool compiled = false, diagrams = true;
  int mode = 0;   ///< of draw: line of the table of poles, from 1; 0: the diagram
  int fold = -1;  ///< not given
  std::string to;
  std::string parent, children, grids, matrices;
  std::vector<double> units, mass;
  int modes = -1;  ///< not given
  double xi = 0;
  std::vector<double> band;  ///< LOW HIGH
  double until = 0;
  double sample_time = 0;
  std::vector<double> omega;    ///< all frequencies
  ParameterList set;            ///< values of parameters, in the order of the options
  std::string inputs, outputs;  ///< of a scene, between commas; empty: all
  double accuracy = Scene{}.accuracy;
  std::string record;              ///< file with the inputs over time
  std::string unit_step;           ///< name of the input that is 1
  double step = 0, delay = 0;      ///< [s]
  int part = 1, parts = 1;         ///< of the rows of a sweep: this part of so many
  std::vector<std::string> given;  ///< options, as typed
  int minimize_up_to = Options{}.minimize_up_to;
};

/// The command line is not valid: description of the mistake.
struct Misuse {
  std::string subject;
};

/// Reads all words behind the program's name. Throws Misuse for an option that does not exist, is
/// there twice, lacks a value or has a wrong one.
Arguments parse(const std::vector<std::string>& all);

/// The words of a list between commas, as fields of CSV files: a word with a comma is in quotation
/// marks.
std::vector<std::string> separated(const std::string& list);

/// The text of titop --help, without that of `generate`.
std::string usage();

}  // namespace titop::command_line
