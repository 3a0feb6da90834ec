#pragma once

#include <map>
#include <string>
#include <vector>

#include "wild/oracle/oracle.hpp"
#include "wild/oracle/scene.hpp"

/// A scene through all roads of the library, against the oracle.
namespace wild {

enum class Verdict {
  right,
  refused_rightly,
  refused_falsely,  ///< the oracle has an answer, proper and well conditioned
  wrong_but_said,   ///< a warning or a fault of the default certificate
  wrong_in_silence,
  not_judged  ///< the oracle has no digits there
};
std::string_view to_string(Verdict verdict);

struct Judgement {
  Verdict verdict = Verdict::right;
  std::string road;  ///< of the worst error: transfer, dense, apply, simulate
  double error = 0;  ///< in allowed errors: above 1 is wrong
  std::string text;  ///< the error's codes, the place, the warnings
  std::vector<Complex> s;
};

/// The points at which scenes are judged: three about omega, one of them on the axis.
std::vector<Complex> points_of(const Scene& scene, unsigned seed);

/// `with_time`: simulate as well. An error found in long double is judged again in 50 digits.
Judgement judge(const Scene& scene, unsigned seed, bool with_time);

}  // namespace wild
