#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <titop/analysis/lft/close.hpp>
#include <titop/analysis/lft/reduced_lft.hpp>
#include <titop/analysis/reduction/scene.hpp>
#include <titop/graph/linalg/dense.hpp>
#include <titop/graph/linalg/eigen.hpp>
#include <titop/graph/linalg/index.hpp>
#include <titop/graph/linalg/rounding.hpp>
#include <titop/graph/nodes/lti.hpp>

namespace titop {
namespace {

using Eigen::Index;
using Eigen::MatrixXcd;
using Eigen::MatrixXd;
using linalg::at;

/// Places of these signals among the names from `first` on: "U" has all of "U(1)", "U(2)", ...
std::vector<Index> places(const std::vector<std::string>& names, Index first,
                          const std::vector<std::string>& asked, const char* kind) {
  std::vector<char> taken(names.size(), asked.empty() ? 1 : 0);
  std::vector<Mistake> mistakes;
  for (const std::string& a : asked) {
    bool found = false;
    for (std::size_t i = at(first); i < names.size(); ++i)
      if (names[i] == a || names[i].starts_with(a + "(")) {
        found = true;
        taken[i] = 1;
      }
    if (!found)
      mistakes.push_back({Code::unknown_name,
                          fmt::format("the LFT has no {} {}", kind, a),
                          {},
                          "take names of Lft::m() after its w and z"});
  }
  if (!mistakes.empty()) throw Error(std::move(mistakes));
  std::vector<Index> result;
  for (Index i = 0; i < std::ssize(names); ++i)
    if (i < first || taken[at(i)]) result.push_back(i);
  return result;
}

StateSpace part(const StateSpace& m, const std::vector<Index>& in, const std::vector<Index>& out) {
  StateSpace p{.A = m.A,
               .B = m.B(Eigen::all, in),
               .C = m.C(out, Eigen::all),
               .D = m.D(out, in),
               .states = m.states,
               .inputs = {},
               .outputs = {}};
  for (const Index i : in) p.inputs.push_back(m.inputs[at(i)]);
  for (const Index i : out) p.outputs.push_back(m.outputs[at(i)]);
  return p;
}

/// M as one block.
Diagram diagram_of_matrix(const StateSpace& m) {
  Diagram d{"M of the LFT"};
  auto block = d.add("M", Lti{.A = m.A, .B = m.B, .C = m.C, .D = m.D});
  block.in = d.input("in", static_cast<int>(m.B.cols()));
  d.output("out", static_cast<int>(m.C.rows())) = block.out;
  return d;
}

/// M has a pole at 0 but for rounding, which moves that of a double integrator by its root.
bool has_pole_at_0(const StateSpace& m) {
  if (m.order() == 0) return false;
  const Eigen::VectorXd size = linalg::eigenvalues(m.A).cwiseAbs();
  return size.minCoeff() <= linalg::kHalfDigits * size.maxCoeff();
}

ReducedSystem reduced_block(const StateSpace& m, const Scene& scene, const Options& options) {
  detail::check(scene);
  try {
    return compile(diagram_of_matrix(m), scene, options);
  } catch (const Error& error) {
    if (scene.band_hz[0] > 0 || !has_pole_at_0(m)) throw;
    throw Error(Code::singular,
                "M of the LFT has a pole at 0, where the band begins: a free position or rate",
                "let Scene::band_hz begin above 0, or leave out the outputs that read it "
                "(Scene::outputs)",
                {"the reduction: " + error.mistakes().front().message});
  }
}

/// The sum of all powers of a matrix without negative entries; infinite entries if it diverges.
MatrixXd neumann(const MatrixXd& m) {
  const Index n = m.rows();
  const double radius = n > 0 ? linalg::eigenvalues(m).cwiseAbs().maxCoeff() : 0;
  if (!(radius < 1)) return MatrixXd::Constant(n, n, std::numeric_limits<double>::infinity());
  return linalg::inverse(MatrixXd::Identity(n, n) - m).matrix;
}

/// left * right of sizes, 0 times infinite counting as 0.
MatrixXd product(const MatrixXd& left, const MatrixXd& right) {
  MatrixXd result = MatrixXd::Zero(left.rows(), right.cols());
  for (Index i = 0; i < left.rows(); ++i)
    for (Index j = 0; j < right.cols(); ++j)
      for (Index k = 0; k < left.cols(); ++k)
        if (left(i, k) != 0 && right(k, j) != 0) result(i, j) += left(i, k) * right(k, j);
  return result;
}

}  // namespace

struct ReducedLft::Sizes {
  MatrixXcd M;  ///< of the reduced model
  MatrixXd E;   ///< bound of the error
  Index r, ny, nu;

  /// [left, I] E [right; I], left ny x r, right r x nu.
  MatrixXd between(const MatrixXd& left, const MatrixXd& right) const {
    MatrixXd a(ny, r + ny), b(r + nu, nu);
    a << left, MatrixXd::Identity(ny, ny);
    b << right, MatrixXd::Identity(nu, nu);
    return product(product(a, E), b);
  }
  MatrixXd E_zw() const { return E.topLeftCorner(r, r); }
  /// Bound of the full model's |M_zu|.
  MatrixXd M_zu() const { return M.topRightCorner(r, nu).cwiseAbs() + E.topRightCorner(r, nu); }
  MatrixXcd M_yw() const { return M.bottomLeftCorner(ny, r); }
};

std::complex<double> ReducedLft::on_ray(double omega) const {
  const double zeta = scene_.damping_floor;
  return {zeta * omega, std::sqrt(1 - zeta * zeta) * omega};
}

ReducedLft::Sizes ReducedLft::sizes(double omega) const {
  const double rounding = 4 * linalg::kEpsilon;  // of the band's ends in rad/s
  const double hz = omega / (2 * std::numbers::pi);
  const auto& [low, high] = scene_.band_hz;
  if (!(hz >= low * (1 - rounding) && hz <= high * (1 + rounding)))
    throw Error(
        Code::bad_value,
        fmt::format("{:.6g} rad/s is outside of the band, {:.6g} to {:.6g} Hz", omega, low, high),
        "the error is known inside of it: reduce for a wider band");
  const Index r = lft_.occurrences();
  MatrixXcd M = lft_.m().transfer(on_ray(omega));
  const Index ny = M.rows() - r, nu = M.cols() - r;
  return {std::move(M), bound_.pairs.cwiseProduct(bound_.peak), r, ny, nu};
}

MatrixXd ReducedLft::error(double omega) const {
  const Sizes s = sizes(omega);
  const MatrixXd loop = s.M.topLeftCorner(s.r, s.r).cwiseAbs();
  return s.between(product(s.M_yw().cwiseAbs(), neumann(loop)),
                   product(neumann(loop + s.E_zw()), s.M_zu()));
}

MatrixXd ReducedLft::error(double omega, const ParameterList& values) const {
  const Sizes s = sizes(omega);
  const Eigen::VectorXd delta = lft_.deltas_at(values);
  const MatrixXcd loop = s.M.topLeftCorner(s.r, s.r) * delta.asDiagonal();
  const MatrixXcd I = MatrixXcd::Identity(s.r, s.r);
  const linalg::Solution n = linalg::solve(MatrixXcd(I - loop), I);
  if (!(n.rcond > detail::kWellPosed))
    throw Error(Code::singular,
                fmt::format("omega = {:.6g} rad/s is at a pole of the reduced LFT there", omega),
                "take another omega, or other values");
  const MatrixXcd by_z = delta.asDiagonal() * n.z;  // w per addition to z
  const MatrixXd size = by_z.cwiseAbs();
  // N = N_r (I - E_zw Delta N_r)^-1
  const MatrixXd full = product(size, neumann(product(s.E_zw(), size)));
  return s.between(MatrixXcd(s.M_yw() * by_z).cwiseAbs(), product(full, s.M_zu()));
}

ReducedLft reduce(const Lft& f, const Scene& scene, const Options& options) {
  const Index r = f.occurrences();
  const StateSpace m = part(f.m(), places(f.m().inputs, r, scene.inputs, "input"),
                            places(f.m().outputs, r, scene.outputs, "output"));
  Scene of_block = scene;
  of_block.inputs.clear(), of_block.outputs.clear();
  const ReducedSystem small = reduced_block(m, of_block, options);
  StateSpace reduced = small.state_space();
  reduced.inputs = m.inputs, reduced.outputs = m.outputs;
  Lft result = f;
  result.take_reduced(std::move(reduced));
  return {std::move(result), small.bound(), scene};
}

}  // namespace titop
