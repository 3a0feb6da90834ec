#pragma once

#include <map>
#include <optional>
#include <string>
#include <titop/blocks/fe/f06.hpp>
#include <titop/blocks/fe/text_file.hpp>
#include <vector>

/// Tables of an f06 as its lines have them. For the folder's own files.
namespace titop::fe::detail {

using ByNumber = std::map<int, Vector6>;  ///< six components by grid, or by mode

struct F06Eigenvalue {
  double value = 0, omega = 0, mass = 0;
};

/// Of one mode, which the table does not name.
struct F06Forces {
  double eigenvalue = 0;
  ByNumber values = {};
};

struct F06Tables {
  std::map<int, F06Eigenvalue> eigenvalues;  ///< by mode
  std::map<int, ByNumber> vectors;           ///< by mode
  std::vector<F06Forces> forces;
  ByNumber factors, effective;
  int about = 0;  ///< grid of the reference point of factors and rigid; 0: the origin
  std::optional<F06Mass> rigid, weight;
  std::string bulk;   ///< cards of the sorted echo
  bool ends = false;  ///< END OF JOB
};

/// Adds rows that do not fit their table, and a fatal message of the run, to `mistakes`.
F06Tables f06_tables(const TextFile& file, FileMistakes& mistakes);

}  // namespace titop::fe::detail
