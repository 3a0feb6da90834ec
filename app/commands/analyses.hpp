#pragma once

#include "arguments.hpp"

/// Commands that analyse a diagram. Each throws Misuse or the errors of the library.
namespace titop::command_line {

/// margins: stability margins of every loop point. Returns the exit code: 3 if a loop is not
/// stable, or the diagram has an unstable pole that no loop has.
int margins_of_loops(const Arguments& a);

/// simulate: the outputs over time as CSV, for a record of inputs or a step of one of them.
void simulate_inputs(const Arguments& a);

/// sweep: poles, or with --omega frequency responses, of every point of a table of parameter
/// values as CSV, of the rows of --part only; under mpirun (TITOP_MPI) each process has a part of
/// them, and the first one writes the file, the same as of one process. Rows that are refused are
/// reported on stderr and left out; returns the exit code, 1 if there are any.
int sweep_table(const Arguments& a);

/// reduce: the reduced model of a scene as .m, .py or .hpp; prints its steps and its bound.
void reduce_scene(const Arguments& a);

}  // namespace titop::command_line
