#pragma once

#include <complex>
#include <string>
#include <titop/compiler/certificate/certificate.hpp>
#include <titop/compiler/definition/exact_order.hpp>
#include <titop/compiler/minreal/minimize.hpp>
#include <vector>

namespace titop {

class System;

/// Extent of the checks in addition to the default certificate.
struct Full {
  int points = 24;          ///< of the grid in s; 0: none
  int dense_up_to = 2000;   ///< states; larger models are not written, with a note
  int written_up_to = 300;  ///< scalar signals; larger diagrams are not solved as written
  /// For the order without rounding.
  ExactOptions exact = {.states = 100, .unknowns = 1000};
};

/// One item that may not have been checked, with the reason.
struct Checked {
  bool done = false;
  std::string why_not;
};

/// The certificate on request: each item has its own oracle against the factored system. Every
/// number is dimensionless.
struct FullCertificate {
  Certificate basic;  ///< as by System::dense_certificate() if the dense model is checked

  /// Over a grid s = (0.05 + j) w, w from a tenth of the lowest to ten times the highest pole:
  /// largest difference of transfers, per block of output and input (three translations or
  /// rotations of a port together) over its largest value on the grid. Only a block that may be
  /// rounding alone, as by symmetry, is measured by 1e-3 of the terms that cancel in it
  /// (compiler/definition/compare.hpp).
  struct Grid : Checked {
    int points = 0;  ///< where the factors have a transfer; `why_not`: other requested points
    double lowest = 0, highest = 0;  ///< w [rad/s]
    /// The minimal dense model against the factors, also at the frequencies w of its poles (up to
    /// as many as `points`).
    double dense = -1;
    std::complex<double> dense_s;
    /// `transfer` of the diagram as written against the factors. Here every block is measured by
    /// 1e-3 of the terms that cancel in it if these are larger, because that solution has rounding
    /// of its own. -1: more than Full::written_up_to signals, or not solvable as written
    /// (over-constrained chains).
    double written = -1;
    std::complex<double> written_s;
  } grid;

  /// Poles of the dense model before `minimize`; `why_not` names states that the model lacks
  /// because the structure alone shows that no input moves or no output sees them. The error of a
  /// pole s with left and right vectors w, v is |w (A_factored v - s v)| / |w v|, over |s|:
  /// first-order perturbation by the factors.
  struct Poles : Checked {
    int count = 0;
    int measured = 0;  ///< the others (multiple, or at 0 while others are not) move by 1e-8
                       ///< or more under rounding of A alone
    double error = 0;
    std::complex<double> where;
    int right = 0;  ///< poles right of the axis by more than 1e-9 |s| and ten times their error; of
                    ///< those not measured, by more than ten times their change by rounding of A
    int hidden = 0;  ///< of those right, unreachable or unobservable ones: `minimize` removes them,
                     ///< but the system is unstable
    std::complex<double> rightmost;  ///< largest Re(s) / |s|
  } poles;

  /// For the inputs that are forces with an output that is the acceleration where they act: the
  /// smallest eigenvalue of the Hermitian part of G(s) / s, rows and columns scaled to diagonal 1,
  /// over the grid and around the poles right of the axis that affect a transfer. Negative: the
  /// model can deliver energy (a controller may do that; a structure may not). A force that moves
  /// another's point and not its own counts as -1. 64 units of rounding of the
  /// largest entry in its unit are added to the diagonal; if that is not enough, also 1e-3 of the
  /// terms that cancel, by double against long double.
  struct Passivity : Checked {
    int pairs = 0;
    double least = 0;
    std::complex<double> where;
    /// True for a passive structure: then a negative `least` is a fault. Conditions: no one-way
    /// block drives a body, forces that depend on motions are those of springs, dampers and
    /// gyroscopes, and every point that moves with another returns its wrench there.
    bool structure = false;
  } passivity;

  /// Reciprocity (Maxwell and Betti) of the same pairs, scalar by scalar: difference of G_ij, the
  /// acceleration at force i due to force j, and G_ji. Largest over the same points of
  /// |G_ij - G_ji| / sqrt(|G_ii| |G_jj|), or over |G_ij| or |G_ji| if one is larger (at a
  /// held point G_ii is 0), at the same s; three translations or rotations of a port share their
  /// size. Independent of the units of the forces. Entries at rounding level are measured by 1e-3
  /// of the terms that cancel. Inputs that are no such forces are 0 here: an imposed motion is
  /// held.
  ///
  /// All bodies and joints of the library are reciprocal: their masses, stiffnesses and dampings
  /// are symmetric (to 1e-9, or refused when they are added). With
  /// gyroscopic terms (`Rotor`, `momentum`, antisymmetric gains from rates to forces) G_ji is that
  /// of the same structure with all momenta h reversed, G(s; h)' = G(s; -h) [Casimir 1945], by a
  /// second compile. A user's block may have gyroscopic terms inside: then reciprocity of the whole
  /// is not required.
  struct Reciprocity : Checked {
    int forces = 0;  ///< scalar
    double asymmetry = 0;
    std::complex<double> where;
    std::string first, second;  ///< the two, as System::inputs() calls them; empty at 0
    /// A structure, as for passivity, whose blocks are all reciprocal: their responses at one s are
    /// symmetric to 1e-12 (blocks symmetric only to 1e-9 do not count). Then an asymmetry above
    /// 1e-8 is a fault.
    bool structure = false;
    std::string why_no_structure;  ///< "hub.parent.force is driven by K.out"
    bool reversed = false;         ///< compared with reversed momenta
    /// Points with gyroscopic terms: "w1.parent", with the momentum there [N m s]; 0 for
    /// antisymmetric gains that are none, such as from rates of translation to forces.
    std::vector<std::pair<std::string, double>> momenta;
  } reciprocity;

  /// Verdict on the minimal dense model. If exact arithmetic finds states that were removed as
  /// rounding (two frequencies one ulp apart), the interval extends to the exact order.
  OrderVerdict order;
  ExactOrder exact;  ///< independent of all passes, if the diagram is small

  /// The failed checks, in words; empty if all pass: equations and transfers as written to 1e-8,
  /// entries of the dense model too, its rounding error (basic.dense_error, grid.dense) to 3e-7,
  /// the limit of generated C++, poles to 1e-6, a structure passive to 1e-9 and reciprocal to 1e-8,
  /// without poles right of the axis (unless one-way blocks that read it have states and are not
  /// only integrators), and the exact order inside the verdict's interval. A removal that changed
  /// the transfer and was put back is no fault of the model: OrderVerdict::change reports it.
  std::vector<std::string> faults;
  bool holds() const { return faults.empty(); }
};

/// Computes all items above, with the dense model and its poles. A check that cannot be made is
/// reported as `why_not`; throws the errors of System::state_space. O(n^3) in the states, and
/// points * O(bodies). Does not change the system, except for its dense model, which is kept.
FullCertificate certify(const System& system, const Full& options = {});

/// One line per item; for a check that was not made, the reason.
std::string to_string(const FullCertificate& certificate);

}  // namespace titop
