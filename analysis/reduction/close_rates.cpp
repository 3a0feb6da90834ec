#include <fmt/format.h>

#include <algorithm>
#include <set>
#include <titop/analysis/reduction/rate_feedback.hpp>
#include <titop/graph/linalg/dense.hpp>
#include <titop/graph/linalg/eigen.hpp>
#include <titop/graph/linalg/index.hpp>
#include <titop/graph/linalg/rounding.hpp>
#include <titop/graph/linalg/symmetric.hpp>
#include <utility>

namespace titop::detail {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;
using linalg::at;

[[noreturn]] void refuse_asymmetry(const std::string& what) {
  throw NoStructure(
      Code::bad_value, what + ": no motion of a structure",
      "look for a block there whose data are not symmetric, or whose motion has no mass");
}

/// The modal vectors of w and of z; equal if motions are mass-normalised.
struct Ports {
  MatrixXd b, c;  ///< n x z each
};

/// Sizes of the rates, and the one below which a rate is rounding beside the others, as at a point
/// that is held.
std::pair<Eigen::RowVectorXd, double> sizes_of(const MatrixXd& b, const MatrixXd& c) {
  const Eigen::RowVectorXd size = b.colwise().norm() + c.colwise().norm();
  return {size, size.size() > 0 ? linalg::kAxisRounding * size.maxCoeff() : 0};
}

void require_reciprocal(const MatrixXd& b, const MatrixXd& c,
                        const std::vector<std::string>& ports) {
  const auto [size, least] = sizes_of(b, c);
  for (Index j = 0; j < b.cols(); ++j)
    if (!((b.col(j) - c.col(j)).norm() <= std::max(kSymmetric * size(j), least)))
      refuse_asymmetry(
          fmt::format("a force at {} and the rate there are not reciprocal", ports[at(j)]));
}

/// Mass matrix's inverse X of the motions without stiffness: X c = b on the span of c, the identity
/// on its complement. Rates that are rounding beside the others do not count. Empty if there are
/// more such motions than coordinates, since forces and rates are not reciprocal.
MatrixXd mobility(const MatrixXd& b, const MatrixXd& c) {
  const MatrixXd S = (c.transpose() * b + b.transpose() * c) / 2;
  const auto [size, least] = sizes_of(b, c);
  VectorXd d = S.diagonal().cwiseMax(0).cwiseSqrt();
  d = (size.transpose().array() > least).select(d, 0);
  d = (d.array() > 0).select(d.cwiseInverse(), 0);
  const SymmetricModes m = eigh(d.asDiagonal() * S * d.asDiagonal());
  MatrixXd X = MatrixXd::Zero(b.rows(), b.rows());
  MatrixXd seen(c.rows(), 0);
  for (Index k = 0; k < m.lambda.size(); ++k) {
    if (!(m.lambda(k) > kSymmetric)) continue;
    const VectorXd v = d.asDiagonal() * m.V.col(k);
    X += (b * v) * (b * v).transpose() / m.lambda(k);
    seen.conservativeResize(Eigen::NoChange, seen.cols() + 1);
    seen.rightCols<1>() = c * v;
  }
  if (seen.cols() == 0) return MatrixXd::Identity(c.rows(), c.rows());
  if (seen.cols() > c.rows()) return {};
  const Eigen::ColPivHouseholderQR<MatrixXd> qr(seen);
  const MatrixXd across = MatrixXd(qr.householderQ()).rightCols(c.rows() - seen.cols());
  return X + across * across.transpose();
}

/// Motions without stiffness x = T y, T T' = X: y are mass-normalised.
void normalise(Whole& w, Ports& p, const std::vector<std::string>& ports) {
  const Index loose = w.loose;
  if (loose == 0) return;
  const MatrixXd X = mobility(p.b.bottomRows(loose), p.c.bottomRows(loose));
  const Eigen::LLT<MatrixXd> factors(X);
  if (X.size() == 0 || factors.info() != Eigen::Success)
    refuse_asymmetry(fmt::format("rates at {} do not determine their inertia",
                                 fmt::join(std::set(ports.begin(), ports.end()), ", ")));
  const MatrixXd T = factors.matrixL();
  w.b.bottomRows(loose) = factors.matrixL().solve(MatrixXd(w.b.bottomRows(loose)));
  for (MatrixXd* m : {&w.ca, &w.cv, &w.cq}) m->rightCols(loose) = m->rightCols(loose) * T;
  p.b.bottomRows(loose) = factors.matrixL().solve(MatrixXd(p.b.bottomRows(loose)));
  p.c.bottomRows(loose) = T.transpose() * p.c.bottomRows(loose);
}

/// The factor of the masses of this part by which b = c at the port with the largest mobility b c
/// there; 1 if ports reach the part by rounding only. With motions without stiffness, whose rates
/// are c_l: B = G c - K^-1 A_l' c_l in these coordinates.
double mass_factor(const Coordinates& c, const std::vector<int>& part, Index z) {
  const Index loose = c.size() - c.n_elastic;
  const MatrixXd G = c.G(part, part), K = c.K(part, part);
  const MatrixXd w = c.B.rightCols(z), rates = c.C_v.bottomRows(z).transpose();
  const MatrixXd in = w(part, Eigen::all);
  const MatrixXd out =
      G * rates(part, Eigen::all) -
      solve_definite(K, c.A_loose(Eigen::all, part).transpose() * rates.bottomRows(loose));
  Index port = 0;
  const double both = in.cwiseProduct(out).colwise().sum().maxCoeff(&port);
  if (!(both > 0)) return 1;
  const VectorXd b = in.col(port);
  const double factor = both / b.squaredNorm();
  const double mobility = factor * b.dot(VectorXd(solve_definite(G, b)));
  return mobility > linalg::kAxisRounding * w.col(port).dot(rates.col(port)) ? factor : 1;
}

/// Accelerations that follow w at once, by those of the motions without stiffness: D_w = g P, of
/// which the rest is left in D_w.
void read_loose(Whole& w, const MatrixXd& P, MatrixXd& D_w) {
  if (w.loose == 0) return;
  const MatrixXd P_loose = P.bottomRows(w.loose);
  const Eigen::CompleteOrthogonalDecomposition<MatrixXd> qr(P_loose.transpose());
  for (Index i = 0; i < D_w.rows(); ++i) {
    if (w.is_position[at(i)]) continue;
    const Eigen::RowVectorXd g = qr.solve(MatrixXd(D_w.row(i).transpose())).transpose();
    w.ca.row(i).tail(w.loose) += g;
    w.D0.row(i) -= g * w.b.bottomRows(w.loose);
    const Eigen::RowVectorXd left = D_w.row(i) - g * P_loose;
    const bool rounding = left.norm() <= kSymmetric * D_w.row(i).norm();
    D_w.row(i) = rounding ? Eigen::RowVectorXd::Zero(left.size()) : left;
  }
}

/// Directions of the motions without stiffness in which no rate has an effect on these motions.
Index resting(const Whole& w) {
  if (w.loose == 0) return 0;
  const MatrixXd among = w.Z.bottomRightCorner(w.loose, w.loose);
  const VectorXd sigma = Eigen::JacobiSVD<MatrixXd>(among).singularValues();
  return (sigma.array() <= linalg::kAxisRounding * sigma(0)).count();
}

}  // namespace

void scale_masses(Coordinates& c, const RateFeedback& f) {
  for (const std::vector<int>& part : c.unscaled) {
    const double factor = mass_factor(c, part, f.F.rows());
    c.G(part, part) /= factor;
    c.K(part, part) *= factor;
    if (c.D.size() > 0) c.D(part, part) *= factor;
  }
  c.unscaled.clear();
}

void close(Whole& w, const RateFeedback& f) {
  const Index z = f.F.rows(), inputs = w.b.cols() - z, outputs = w.cv.rows() - z;
  Ports p{w.b.rightCols(z), w.cv.bottomRows(z).transpose()};
  normalise(w, p, f.ports);
  require_reciprocal(p.b, p.c, f.ports);
  const MatrixXd P = (p.b + p.c) / 2;
  MatrixXd D_w = w.D0.topRightCorner(outputs, z);
  for (MatrixXd* m : {&w.ca, &w.cv, &w.cq}) m->conservativeResize(outputs, Eigen::NoChange);
  w.b.conservativeResize(Eigen::NoChange, inputs);
  w.D0.conservativeResize(outputs, inputs);
  w.silent.conservativeResize(outputs, Eigen::NoChange);
  w.is_position.resize(at(outputs));
  read_loose(w, P, D_w);
  w.cv -= D_w * f.F * P.transpose();
  const MatrixXd damping = (f.F + f.F.transpose()) / 2, momenta = (f.F - f.F.transpose()) / 2;
  MatrixXd Z = P * damping * P.transpose(), N = P * momenta * P.transpose();
  if (w.Z.size() > 0) Z += w.Z;
  w.Z = (Z + Z.transpose()) / 2 + (N - N.transpose()) / 2;
  w.proportional = false;
  w.loose_coupled = true;
  w.resting = resting(w);
}

}  // namespace titop::detail
