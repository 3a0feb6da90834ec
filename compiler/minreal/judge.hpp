#pragma once

#include <titop/compiler/minreal/minimize.hpp>
#include <titop/compiler/minreal/modes.hpp>

/// Selection of modes: visibility against its own rounding bound (compiler/minreal/minimize.hpp).
namespace titop::minreal {

struct Verdict {
  double visibility = 1, bound = 0;
  bool unreachable = false;  ///< the weak side is the inputs' (else the outputs')
  bool drop = false;
  bool doubtful = false;  ///< kept, but may be rounding only
};

/// One verdict per mode. O(n^2 ports).
std::vector<Verdict> judge(const ModeSet& modes, double resolution);

/// Drops only the least visible modes until `order` states have become `exact`; never one of
/// visibility above 1e-6. False if that number cannot be reached: then only those that
/// are dropped already, as far as `exact` allows. Clusters that are judged as a whole lose the
/// states that they have found, or none if that is too many.
bool drop_down_to(int exact, int order, ModeSet& modes, std::vector<Verdict>& verdicts);

/// Sum of the verdicts, for a model of `order` states.
OrderVerdict sum_up(const std::vector<Verdict>& verdicts, const ModeSet& modes, int order);

}  // namespace titop::minreal
