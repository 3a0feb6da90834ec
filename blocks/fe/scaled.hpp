#pragma once

#include <titop/blocks/fe/modal_data.hpp>

namespace titop {

/// The units that data are in, in SI: mm, kg, s is {.length = 1e-3}; inch, lbf, s is
/// {.length = 0.0254, .mass = 175.12683524647636}, where the unit of mass is lbf s^2/inch.
struct DataUnits {
  double length = 1;  ///< [m]
  double mass = 1;    ///< [kg]
  double time = 1;    ///< [s]
};

/// The data in SI units. Modes stay mass-normalised: their coordinates become m sqrt(kg). Throws
/// bad_value unless all three are positive and finite.
ModalData scaled(ModalData data, const DataUnits& units);

}  // namespace titop
