#pragma once

#include <filesystem>
#include <string>
#include <titop/compiler/system/system.hpp>

namespace titop {

/// Coordinates of the state in generated code.
enum class CppStates {
  automatic,  ///< modes if that takes fewer operations and is as accurate (looked at up to 400
              ///< states), else the model's own
  model,      ///< those of System::state_space(), by name
  modes,      ///< throws bad_value if modes are less accurate (free rigid motion), or if there is
              ///< no input or no output, so that the accuracy cannot be measured
};

/// Options of `generate_cpp`.
struct CppOptions {
  std::string name = "model";  ///< of the namespace and of the files: a C++ identifier
                               ///< other than the C library's (sin, link, NULL)
  double sample_time = 0;      ///< of `step` [s]; 0: no `step`
  CppStates states = CppStates::automatic;
};

/// A model as C++17 source, and its test. The header needs the standard library only, the test also
/// doctest.
struct CppModel {
  std::string name;
  std::string header;      ///< NAME.hpp
  std::string test;        ///< NAME_test.cpp, with doctest's main (or TITOP_TEST_WITHOUT_MAIN)
  bool modal = false;      ///< the states are modal; to_states() gives the model's
  double error = 0;        ///< of its transfer against the factored system, at eight s near the
                           ///< poles: worst entry over the largest of its row and column
  long long products = 0;  ///< multiplications of derivative + output (+ step)
};

/// Writes System::state_space() as a header without dependencies:
///
///     NAME::State x{};  NAME::Input u{};  u[NAME::in::tau_m] = 0.1;
///     NAME::State xdot = NAME::derivative(x, u);
///     NAME::Output y = NAME::output(x, u);      y[NAME::out::theta]
///     x = NAME::step(x, u);                     // exact for u held over NAME::sample_time
///
/// All functions are constexpr; data are exact to the last bit. Each matrix is stored dense, sparse
/// or as 2 x 2 blocks, whichever is cheapest.
///
/// The test recovers the matrices by calling the header and checks them against independent values:
/// transfer and static gain of the factored system, the poles, their number; and a trajectory in
/// long double against `step`, and `step` against the Taylor series of `derivative` if that is
/// affordable. Its tolerances follow the errors measured here, up to 1e-6; a check that would need
/// more is replaced by a comment.
///
/// Throws bad_value: not an identifier, a sample time that is negative or not finite, modes
/// requested but not accurate, a dense model with fewer than six digits. O(n^3).
CppModel generate_cpp(const System& system, const CppOptions& options = {});

/// Writes NAME.hpp and NAME_test.cpp; a file that has this content already is not touched, so that
/// its dependents are not rebuilt. Throws bad_file.
void write(const CppModel& model, const std::filesystem::path& folder);

}  // namespace titop
