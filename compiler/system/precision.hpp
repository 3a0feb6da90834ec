#pragma once

namespace titop {

/// Arithmetic of a transfer, coarse to fine. All use the same elimination on the same plan; blocks
/// are evaluated in it too, from data that are doubles.
enum class Precision {
  standard,  ///< double: 16 digits; one step of refinement after the elimination; not as accurate
             ///< as the others where the scene is ill-conditioned
  refined,   ///< factors in double, blocks and residuals in long double: refined until the outputs
             ///< settle, or refused; see System::transfer
  twofold,   ///< the same in double-double: 32 digits, on any machine
  digits50,  ///< 50 digits (Boost.Multiprecision), some hundred times slower
  as_needed  ///< double; if its error, estimated from pivots, rounding and refinement, exceeds
             ///< 1e-12: refined or twofold if they converge, else 50 digits. If double finds no
             ///< pivot although s is no pole, as in wide grids: double-double or 50 digits;
             ///< singular if rounding of the data alone changes all digits (far below all modes of
             ///< a closed chain)
};

}  // namespace titop
