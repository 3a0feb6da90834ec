#pragma once

#include <complex>
#include <titop/analysis/reduction/coordinates.hpp>

/// The whole structure in its own modes. For the library's own files only.
namespace titop::detail {

/// The modes of an assembly, mass-normalised, with their input and output matrices:
///
///     q_j'' + sum_k Z_jk q_k' + lambda_j q_j = b_j u
///     y = D0 u + sum_j (ca_j q_j'' + cv_j q_j' + cq_j q_j)
///
/// Every output is written with accelerations of the modes with stiffness (cq_j = 0 there): D0 is
/// then its static gain without the motions that have none, and an omitted mode keeps its static
/// part in D0.
struct Whole {
  Eigen::VectorXd lambda;  ///< n, ascending [rad^2/s^2], the last `loose` are 0; n - loose: the
                           ///< elastic coordinates less those that are `far`
  Eigen::Index loose = 0;  ///< motions without stiffness (free hinges, integrators): always kept
  Eigen::MatrixXd b;       ///< n x inputs
  Eigen::MatrixXd ca, cv, cq;     ///< outputs x n
  Eigen::MatrixXd D0;             ///< outputs x inputs
  Eigen::MatrixXd Z;              ///< n x n, symmetric part semidefinite; 0 x 0: no damping
  bool proportional = true;       ///< Z is diagonal, to rounding
  bool loose_coupled = false;     ///< Z has rotors' momenta (it is not symmetric then) and their
                                  ///< friction, also on motions without stiffness
  Eigen::Index resting = 0;       ///< of these: independent rates that stay as they are, poles at 0
  Eigen::Index far = 0;           ///< modes that rounding hides: in D0 only
  std::vector<char> is_position;  ///< per output
  std::vector<std::complex<double>> poles;  ///< of coupled modes, by `couple`; upper half plane
  Eigen::MatrixXd silent;                   ///< as Coordinates has it
  std::vector<std::string> blocks;          ///< that have coordinates
  std::vector<Eigen::Index> owner;          ///< block of each motion without stiffness, or -1
  Eigen::MatrixXd shares;                   ///< blocks x elastic coordinates: whose they are
  Eigen::MatrixXd shapes;                   ///< elastic coordinates, scaled to stiffness 1, x modes
  Eigen::MatrixXd pulls;                    ///< their forces; 0 x 0: the same (no chain is closed)

  Eigen::Index order() const { return lambda.size(); }
  Eigen::Index elastic() const { return lambda.size() - loose; }
  /// Damping coefficient of mode j alone.
  double damping(Eigen::Index j) const { return Z.size() ? Z(j, j) : 0; }
};

/// Modes of these coordinates; of clusters of equal frequency, the combinations that inputs and
/// outputs distinguish. Of modes so far above the first ones that rounding hides them (mu = 1 /
/// lambda below n eps of their coordinates' own) only the static part is kept. D0 is the factored
/// system's transfer at one real s minus that of the modes, so that it includes the missing ones.
/// Throws the errors of `coordinates`. O(n^3).
Whole whole(const System& system, const Coordinates& c, std::vector<char> is_position);

/// Finds `poles` if damping or momenta couple the modes: one eigenproblem of twice their number,
/// O(8 n^3).
void couple(Whole& whole);

/// Eigenvalues of A with Im >= 0; the `zeros` of smallest modulus are 0 but for rounding.
std::vector<std::complex<double>> upper_poles(const Eigen::MatrixXd& A, Eigen::Index zeros);

/// Blocks x columns: each block's part of the elastic energy of the motions V (modes x columns), of
/// sum 1; motions without stiffness belong to their own block. O(n^2 columns).
Eigen::MatrixXd participation(const Whole& whole, const Eigen::MatrixXd& V);

/// Marks the outputs of a graph that are positions (plus rates and inputs only), scalar by scalar,
/// as declared.
std::vector<char> positions_read(const Graph& graph);

}  // namespace titop::detail
