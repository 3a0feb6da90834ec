#pragma once

#include <Eigen/Core>
#include <complex>
#include <vector>

/// References of the examples: structures written by hand as M, D, K. Nothing of titop is used
/// here, so that a mistake of titop cannot appear on both sides.
namespace by_hand {

using Complex = std::complex<double>;
using Eigen::Index;
using Eigen::MatrixXcd;
using Eigen::MatrixXd;
using Eigen::VectorXd;
using Matrix6 = Eigen::Matrix<double, 6, 6>;

/// M xdd + D xd + K x = B u, y = C x: positions; times s^2, accelerations.
struct Structure {
  MatrixXd M, D, K;  ///< n x n
  MatrixXd B;        ///< n x inputs, forces
  MatrixXd C;        ///< outputs x n
};

/// n coordinates, nothing in it yet.
Structure empty(Index n, Index inputs, Index outputs);

/// C (s^2 M + s D + K)^-1 B by LU.
MatrixXcd position_transfer(const Structure& a, Complex s);
/// s^2 times that.
MatrixXcd accel_transfer(const Structure& a, Complex s);

/// The same structure without its first `rigid` coordinates, which have no stiffness (K and D have
/// zero rows there: rigid motion, a free joint's angle): the mass of the others is M_ee - M_er
/// M_rr^-1 M_re. Its poles are those of the whole except for the zeros.
Structure elastic(const Structure& a, Index rigid);

/// Poles with Im s >= 0. Undamped: by K x = omega^2 M x.
std::vector<Complex> poles(const Structure& a);
/// Eigenvalues of A with Im s >= 0.
std::vector<Complex> poles(const MatrixXd& A);

/// Smallest order of a model of the outputs' accelerations: per frequency, twice the rank of the
/// modes' residue from the inputs to the outputs (Gilbert). Undamped.
int least_order(const Structure& a);

/// Kinematic model of a rigid body: xdd_C = tau(CP) xdd_P, CP from C to P.
Matrix6 tau(const Eigen::Vector3d& CP);

/// diag(T, T).
Matrix6 dual(const Eigen::Matrix3d& T);

/// Free beam along x, nodes 0 ... elements, six degrees of freedom each (x, y, z, rx, ry, rz): bars
/// for axial and torsion, cubic shapes for bending, consistent mass. EI the same about y and z.
struct Beam {
  double length, EA, EI, GJ;  ///< [m], [N], [N m^2], [N m^2]
  double mass, inertia_x;     ///< per length [kg/m], [kg m]
  int elements;
};
struct FreeBeam {
  MatrixXd M, K;  ///< 6 (elements + 1) square
};
FreeBeam free_beam(const Beam& beam);

/// Circular tube of a material (G = E / 2.5: Poisson's ratio 0.25).
Beam tube(double length, double outer, double inner, double E, double rho, int elements);

/// Displacements of the beam's nodes per unit rigid motion of node 0: six columns.
MatrixXd rigid_motion(const Beam& beam);

// --- how far apart -------------------------------------------------------------------------------

/// "To 1e-x": per block of `rows` x `cols` scalars, the largest difference over all points s over
/// the block's largest entry over all of them; blocks that are zero by nature against the geometric
/// mean of the largest blocks of their row and column.
double transfer_error(const std::vector<MatrixXcd>& a, const std::vector<MatrixXcd>& exact,
                      Index rows = 1, Index cols = 1);

/// (zeta + j sqrt(1 - zeta^2)) omega up to this frequency, in so many equal steps: where a scene of
/// that damping floor is compared.
std::vector<Complex> ray(double zeta, double hertz, int points);

/// Largest distance of a pole to its partner in the other list, each relative to its own modulus;
/// 1 if the lists differ in length. Lists of poles with Im s >= 0.
double pole_error(std::vector<Complex> a, const std::vector<Complex>& exact);

/// Poles as the library lists them (pairs once, by the one with Im s > 0), zeros left out.
template <class Poles>
std::vector<Complex> moving(const Poles& poles) {
  std::vector<Complex> list;
  for (const auto& p : poles)
    if (p.omega > 0) list.push_back(p.s);
  return list;
}

/// A verdict line: the error itself is rounding noise, which differs from machine to machine; it
/// is printed if it is too large, and to stderr if SHOW_ERRORS is set.
bool agrees(const char* subject, double error, double limit);

}  // namespace by_hand
