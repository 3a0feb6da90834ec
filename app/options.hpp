#pragma once

#include <span>
#include <string>
#include <vector>

#include "arguments.hpp"

/// The options of the command line, a row of a table each.
namespace titop::command_line {

/// The words behind an option. Each function throws Misuse.
class OptionWords {
 public:
  /// `at`: the place of the option; that of the last word that was read, afterwards.
  OptionWords(const std::vector<std::string>& all, std::size_t& at)
      : option(all[at]), all_(all), at_(at) {}
  const std::string& word();
  double number();
  double seconds();  ///< above 0
  int count();       ///< 0 or more

  const std::string& option;  ///< as typed: "--band"

 private:
  const std::vector<std::string>& all_;
  std::size_t& at_;
};

/// An option, the names of its words, its help (lines parted by \n), and how it is read.
struct OptionRow {
  const char *name, *words, *help;
  void (*read)(Arguments& a, OptionWords& w);
};

/// All options, in the order of the help.
std::span<const OptionRow> option_table();

}  // namespace titop::command_line
