#pragma once

#include "arguments.hpp"

/// The diagram of the command line.
namespace titop::command_line {

/// The diagram file, its parameters at the values of --set. Throws the errors of read_diagram, and
/// unknown_name, with the diagram's parameters.
Diagram diagram_of(const Arguments& a);

/// The same, compiled.
System compiled(const Arguments& a);

/// Warnings of digits that the dense model loses, on stderr: an export does not print the log.
void warn_of_lost_digits(const System& system);

}  // namespace titop::command_line
