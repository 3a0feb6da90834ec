#include "fe/dynamics.hpp"

namespace fe_test {

Eigen::MatrixXcd modal_transfer(const titop::ModalData& d, Complex s) {
  const Eigen::Index N = d.omega.size(), m = 6 * static_cast<Eigen::Index>(d.children.size());
  Eigen::MatrixXd B(N, m + 6), D = Eigen::MatrixXd::Zero(m + 6, m + 6);
  B.rightCols(6) = -d.L_P;
  for (Eigen::Index i = 0; i < m / 6; ++i) {
    const auto& C = d.children[static_cast<std::size_t>(i)];
    B.middleCols(6 * i, 6) = C.Phi_C.transpose();
    D.block(6 * i, m, 6, 6) = titop::tau(-C.PC);
    D.block(m, 6 * i, 6, 6) = titop::tau(-C.PC).transpose();
  }
  D.bottomRightCorner(6, 6) = -d.D_P;
  const Eigen::ArrayXcd denominator = s * s +
                                      s * (2 * d.xi.array() * d.omega.array()).cast<Complex>() +
                                      d.omega.array().square().cast<Complex>();
  // D contains the rigid part; B' eta'' adds the rest, with eta'' = s^2 / (...) B u.
  const Eigen::VectorXcd gain = (s * s / denominator).matrix();
  return D.cast<Complex>() + B.transpose() * gain.asDiagonal() * B;
}

template <class Real>
Eigen::MatrixXcd direct_transfer(const titop::fe::Mesh& mesh, const std::string& parent,
                                 const std::vector<std::string>& children, Complex s_double,
                                 double beta) {
  using C = std::complex<Real>;
  using MatrixC = Eigen::Matrix<C, -1, -1>;
  using MatrixR = Eigen::Matrix<Real, -1, -1>;
  const C s = s_double;
  const Eigen::Index n = mesh.M.rows(), m = 6 * static_cast<Eigen::Index>(children.size());
  const auto rows_P = titop::fe::interface_rows(mesh, parent);
  const Vector3d P = mesh.points[titop::fe::find_point(mesh, parent)].position;
  const MatrixR R = titop::fe::rigid_motions(mesh, P).template cast<Real>();
  std::vector<Eigen::Index> f;
  for (Eigen::Index i = 0; i < n; ++i)
    if (std::find(rows_P.begin(), rows_P.end(), i) == rows_P.end()) f.push_back(i);
  MatrixR S = MatrixR::Zero(m, n);
  for (Eigen::Index i = 0; i < m / 6; ++i) {
    const auto rows = titop::fe::interface_rows(mesh, children[static_cast<std::size_t>(i)]);
    for (std::size_t k = 0; k < 6; ++k) S(6 * i + static_cast<Eigen::Index>(k), rows[k]) = 1;
  }
  const MatrixR M = mesh.M.template cast<Real>(), K = mesh.K.template cast<Real>();
  const MatrixC Z =
      s * s * M.template cast<C>() + (C(1) + s * C(Real(beta))) * K.template cast<C>();
  MatrixC load = MatrixC::Zero(n, m + 6);
  load.leftCols(m) = S.transpose().template cast<C>();
  load.rightCols(6) = -(M * R).template cast<C>();  // xdd_P = 1, K R = 0
  MatrixC q = MatrixC::Zero(n, m + 6);
  const MatrixC q_f = MatrixC(Z(f, f)).partialPivLu().solve(MatrixC(load(f, Eigen::all)));
  q(f, Eigen::all) = q_f;
  MatrixC G(m + 6, m + 6);
  const MatrixC Sc = S.template cast<C>(), Rc = R.template cast<C>();
  G.topRows(m) = s * s * Sc * q;
  G.topRightCorner(m, 6) += Sc * Rc;
  // F_A/P = -R'(inertia of the whole) + R'F: equation of motion of the body, all reduced at P.
  G.bottomRows(6) = -Rc.transpose() * (s * s * M.template cast<C>() * q);
  G.bottomLeftCorner(6, m) += Rc.transpose() * Sc.transpose();
  G.bottomRightCorner(6, 6) -= Rc.transpose() * M.template cast<C>() * Rc;
  return G.template cast<Complex>();
}

template Eigen::MatrixXcd direct_transfer<double>(const titop::fe::Mesh&, const std::string&,
                                                  const std::vector<std::string>&, Complex, double);
template Eigen::MatrixXcd direct_transfer<long double>(const titop::fe::Mesh&, const std::string&,
                                                       const std::vector<std::string>&, Complex,
                                                       double);

}  // namespace fe_test
