#pragma once

#include <exception>
#include <string>
#include <string_view>
#include <titop/graph/source_line.hpp>
#include <vector>

namespace titop {

/// Kind of a mistake. The printed names (`to_string`) are a stable interface: scripts may match
/// them. docs/errors.md has the table of all codes with causes and cures.
enum class Code {
  no_equation,     ///< a channel without equation
  two_equations,   ///< a port is set twice, or both sides of a channel are
  size,            ///< sizes of two sides differ
  quantity,        ///< acceleration, velocity, position, force are mixed
  frame,           ///< components in different frames are mixed
  unknown_name,    ///< no port, input, node or parameter has this name
  duplicate_name,  ///< the name is taken
  not_finite,      ///< a number is infinite or not a number
  not_a_rotation,  ///< a matrix is not a proper rotation
  structure,  ///< every channel is driven, but the equations contradict each other in structure
  ill_posed,  ///< an algebraic loop without a unique solution
  improper,   ///< the transfer would need derivatives of an input
  kinematic_loop,  ///< a closed chain (or the links of a posture) that does not close, that goes
                   ///< through a block without kinematics, or whose internal forces are read
  bad_inertia,     ///< no rigid body has this inertia
  bad_modes,       ///< modal data that contradict themselves
  bad_file,        ///< a file that does not contain the expected data
  bad_value,       ///< a number outside its range
  singular,        ///< a matrix that must be inverted is singular, or s is a pole
  not_rational,    ///< a parameter that `lft` cannot take out of the model; a loss factor, which
                   ///< has no state-space model
};

/// "no-equation", "two-equations", ...
std::string_view to_string(Code code);

/// One mistake: description, place, both sides of the equation, and the way out.
struct Mistake {
  Code code;
  std::string message;               ///< one line: the block, the port, the mistake
  std::vector<std::string> details;  ///< further lines: both sides, where they were written
  std::string hint;                  ///< the way out: the text to write instead
};

/// "examples/fig17.cpp:21"; the last two parts of the path only.
std::string to_string(const SourceLine& where);

/// Thrown for the user's mistakes: all that were found in one stage, together.
/// what() is the whole printed text, one paragraph per mistake:
///
///     error[no-equation]: A1.parent.accel is not driven
///       A1 was added at examples/spacecraft.cpp:21
///       write mount(A1, B.child("C1"), T_ba1) to fix it to B, or A1.parent.accel = 0 to clamp it
class Error : public std::exception {
 public:
  explicit Error(std::vector<Mistake> mistakes);
  explicit Error(Mistake mistake);
  Error(Code code, std::string message, std::string hint, std::vector<std::string> details = {});

  const char* what() const noexcept override { return text_.c_str(); }
  const std::vector<Mistake>& mistakes() const { return mistakes_; }
  /// True if any mistake has this code.
  bool has(Code code) const;

 private:
  std::vector<Mistake> mistakes_;
  std::string text_;
};

}  // namespace titop
