#pragma once

#include <map>
#include <titop/blocks/fe/beam.hpp>
#include <titop/blocks/fe/modal_data.hpp>
#include <titop/blocks/line_port.hpp>
#include <titop/blocks/rigid_body.hpp>
#include <titop/graph/diagram.hpp>

namespace titop {

/// Numbers or parameters in place of some of a body's modal data. Modes count from 1, as in eta1;
/// components from 1: x, y, z, rx, ry, rz.
struct ModeValues {
  /// An entry of L_P or of a Phi_C.
  struct Entry {
    int mode = 0, component = 0;
    Value value;
  };
  std::map<int, Value> omega = {};  ///< natural frequencies by mode [rad/s], > 0
  std::map<int, Value> xi = {};     ///< damping ratios by mode [-], >= 0
  std::vector<Entry> L_P = {};      ///< participations [sqrt(kg), m sqrt(kg)]
  std::map<std::string, std::vector<Entry>> Phi_C = {};  ///< shapes at a child, by its name
                                                         ///< [1/sqrt(kg), 1/(m sqrt(kg))]

  bool empty() const { return omega.empty() && xi.empty() && !of_shapes(); }
  bool of_shapes() const { return !L_P.empty() || !Phi_C.empty(); }
};

/// Flexible body, the two-port M_PC and its N-port form: [Alazard 2015] eq. (14). With N
/// mass-normalised modes clamped at P and W = [Phi_C' ... , -L_P] (N x inputs),
///
///     etadd = -diag(omega^2) eta - diag(2 xi omega) etad + W u        u = [F_C; ...; xdd_P]
///     y     = W' (etadd) + [[0, tau_CP], [tau_CP', -D_P]] u           y = [xdd_C; ...; F_P]
///
/// with the direct terms of (14): between two children Phi_C1 Phi_C2', from P (tau_CP - Phi_C L_P),
/// at P -D_P0 with the residual mass D_P0 = D_P - L_P' L_P. States: eta1 ... etaN [m sqrt(kg)],
/// then their rates. Frame: the node's own. No child: the clamped-free appendage of Fig. 15. Every
/// shape of a line (ModalData::lines) is a scalar channel between the children and P, with a row of
/// Phi in W and no rigid term (blocks/line_port.hpp).
///
/// The data are checked once, when it is made, and then shared by all nodes that use it. Throws,
/// with the line that makes it, bad_modes (shapes, omega <= 0, xi < 0 or all above 1, D_P0 negative
/// beyond the data's digits, with the degree of freedom), bad_inertia (D_P not symmetric, negative,
/// or different from the mass matrix of every rigid body by more than 5 % and the data's digits),
/// bad_value (digits), not_finite, duplicate_name. `compile` and `update` throw improper if P is
/// freed in any directions in which D_P0 is zero by the data's digits, and if a child is driven
/// though no mode moves it there. Cost of a compile: O(N (6 + 6 children)); of its transfer at s:
/// the same.
///
///     FlexibleBody{boom, {.omega = {{1, w1}, {3, 2.0 * w1}}, .xi = {{1, z}}}}
///
/// is boom with other frequencies and damping ratios for some modes, w1 and z being parameters;
/// `.L_P = {{.mode = 1, .component = 5, .value = l}}` replaces one participation, and `.Phi_C =
/// {{"tip", {{1, 5, p}}}}` one entry of the shapes at the child "tip". All else is boom's, and
/// shared with it. Values are checked when it is added, and by `update` for new ones: bad_modes (no
/// such mode or component, an entry given twice, omega <= 0, xi < 0, more mass in the modes than
/// D_P has), unknown_name (no such child), not_finite. New values cost O(N^2 + N inputs^2), once
/// for all nodes that use the same FlexibleBody. A beam of another E has all its omegas times one
/// parameter, sqrt(E / E0); of another density or length it has other shapes too.
class FlexibleBody {
 public:
  FlexibleBody(ModalData data, SourceLine at = std::source_location::current());
  /// Through modal_data(beam).
  FlexibleBody(const Beam& beam, SourceLine at = std::source_location::current());
  /// No modes; parameters at their nominal values.
  FlexibleBody(const RigidBody& body, SourceLine at = std::source_location::current());
  /// Values of `body` are kept for modes that `values` does not name. Throws bad_modes for one that
  /// is damped by a matrix or has a loss factor.
  FlexibleBody(const FlexibleBody& body, const ModeValues& values);

  /// The same body with -Z etad in place of -diag(2 xi omega) etad: damping that couples the modes
  /// clamped at P, such as that of the modes of a free body (analysis/damping). Z: N x N,
  /// symmetric, positive semidefinite [rad/s]. Throws size, not_finite, and bad_modes for a Z that
  /// is not symmetric or not semidefinite, or if some modes have ModeValues. O(N^3).
  FlexibleBody damped_by(const Eigen::MatrixXd& Z) const;
  /// Z, or diag(2 xi omega): the modes' damping matrix, N x N, parameters at their nominal values.
  /// Throws not_rational for a body with a loss factor.
  Eigen::MatrixXd damping() const;
  /// The same body with structural damping in place of xi: its stiffness at s = j omega is (1 + j
  /// eta sign(omega)) diag(omega^2) [Craig and Kurdila 2006, 4]. This stiffness is no rational
  /// function of s and has no state-space model: `compile` throws not_rational; use
  /// `frequency_response` of the diagram (analysis/damping/structural_damping.hpp). At resonances
  /// it equals modal damping of xi = eta / 2. Throws bad_value unless eta > 0 and finite, bad_modes
  /// if the body has a damping matrix or some modes have ModeValues.
  FlexibleBody with_loss_factor(double eta) const;

  /// Data from which its block is made.
  struct Spec {
    std::shared_ptr<const ModalData> data;
    ModeValues values = {};
    Eigen::MatrixXd damping = {};  ///< Z of `damped_by`; 0 x 0: by xi
    double loss_factor = 0;        ///< eta of `with_loss_factor`; 0: by xi
  };
  const Spec& spec() const { return *spec_; }
  const ModalData& data() const {
    return *spec_->data;
  }  ///< as given, without other values,
     ///< damping matrix and loss factor
  /// With the spec's values, parameters at their nominal ones; xi is not the damping of a body with
  /// a damping matrix or a loss factor.
  ModalData nominal() const;
  const BlockPtr& block() const { return block_; }

  using Handle = FlexibleBodyHandle;

 private:
  std::shared_ptr<const Spec> spec_;
  BlockPtr block_;
};

BlockPtr as_block(const FlexibleBody& body);

/// A diagram of this body alone, to be read, checked and copied from: one block `name`, whose
/// parent has the acceleration "a_P" as input and its force "F_P" as output; each child C has the
/// force "F_C" as input and the acceleration "a_C" as output, 6 components each. This is the block
/// as it stands in [Alazard 2015] eq. (14), so that it always compiles. Throws the errors of
/// `FlexibleBody`.
Diagram diagram_of_body(const ModalData& data, const std::string& name = "body");

/// The modes' input matrix W = [Phi_C' ..., Phi' of lines ..., -L_P], N x (6 children + shapes +
/// 6).
Eigen::MatrixXd modal_input(const ModalData& data);

/// Number of shapes of all lines.
Eigen::Index shapes_of_lines(const ModalData& data);

/// Name of the scalar channel of a shape, "C.z2".
std::string channel_of(const ModalLine& line, const LineShape& shape);

}  // namespace titop
