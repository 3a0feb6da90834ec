#pragma once

#include <titop/graph/block.hpp>

namespace titop {

/// Accuracy of a modal block's numbers. The direct term of its ports is
/// D = rigid + W' W (struct Modal). Column j of W is known to `shapes` times size(j), entry (i, j)
/// of `rigid` between ports that take an acceleration to `mass` times size(i) size(j). Sizes make
/// the ports comparable: of an input times its size the unit is the same for all. A size of 0:
/// these numbers are exact (a row of zeros).
struct DataDigits {
  Eigen::VectorXd size;         ///< per scalar input
  double shapes = 0, mass = 0;  ///< fractions; smaller ones count as zero
};

/// A block whose numbers are measured, or read from a file, derives from this too. `compile` then
/// refuses (improper) every scene in which numbers that are zero by these digits would decide on a
/// motion or a force: a port freed in any directions where D leaves no mass, and one that is driven
/// where W moves nothing.
class FromData {
 public:
  virtual const DataDigits& digits() const = 0;
  /// The message on this channel ("has ...", as in Block::why_singular), and the way out.
  /// `direction`: of the channel's input (acceleration or force) that is not determined. `left`:
  /// remaining fraction of the mass, or of the motion by the modes.
  virtual Block::Cause beyond_digits(int channel, const Eigen::VectorXd& direction,
                                     double left) const = 0;

 protected:
  ~FromData() = default;
};

}  // namespace titop
