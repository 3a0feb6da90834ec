#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <set>
#include <titop/blocks/body_interface.hpp>
#include <titop/blocks/opened_rigid_body.hpp>
#include <titop/blocks/rigid_body.hpp>
#include <titop/blocks/specified.hpp>
#include <titop/graph/linalg/eigen.hpp>
#include <titop/graph/linalg/rounding.hpp>

namespace titop {

using Eigen::MatrixXd;

BodyHandle::BodyHandle(Graph* graph, int node)
    : child(graph, node),
      parent(detail::channel<6>(graph, node, detail::find_channel(*graph, node, "parent"))) {}

void check_inertia(double mass, const Matrix3d& inertia) {
  if (!std::isfinite(mass) || !inertia.allFinite())
    throw Error(Code::not_finite, "the mass or the inertia is not finite", "give finite numbers");
  if (mass < 0)
    throw Error(Code::bad_inertia, fmt::format("the mass is {} kg", mass),
                "give a mass of 0 or more");
  const double size = inertia.cwiseAbs().maxCoeff();
  const double off = (inertia - inertia.transpose()).cwiseAbs().maxCoeff();
  if (off > linalg::kMatrixDigits * size)
    throw Error(Code::bad_inertia,
                fmt::format("the inertia is not symmetric, by {:.2g} kg m^2", off),
                "give the full symmetric matrix about the centre of mass");
  const Eigen::SelfAdjointEigenSolver<Matrix3d> solver((inertia + inertia.transpose()) / 2,
                                                       Eigen::EigenvaluesOnly);
  const Vector3d I = solver.eigenvalues();  // ascending
  if (I(0) < -linalg::kMatrixDigits * I.cwiseAbs().maxCoeff())
    throw Error(
        Code::bad_inertia,
        fmt::format("the inertia is not positive: its smallest principal moment is {:.6g} kg m^2",
                    I(0)),
        "check the signs of the products of inertia");
  if (I(2) > (I(0) + I(1)) * (1 + linalg::kMatrixDigits))
    throw Error(
        Code::bad_inertia,
        fmt::format(
            "principal moments {:.6g}, {:.6g} and {:.6g} kg m^2 violate the triangle inequality",
            I(0), I(1), I(2)),
        "no mass distribution has them: the largest may not exceed the sum of the others; is "
        "the inertia really about the centre of mass?");
}

Interface body_interface(const std::vector<std::string>& children, int modes,
                         const std::vector<std::string>& shapes) {
  Interface face;
  std::set<std::string> seen;
  const auto add = [&](const std::string& name, int size) {
    if (name.empty() || name == "parent" || !seen.insert(name).second)
      throw Error(Code::duplicate_name, fmt::format("a second point is called \"{}\"", name),
                  "give every child point a name of its own, other than \"parent\"");
    face.channels.push_back({name, size, Takes::force});
  };
  for (const std::string& name : children) add(name, 6);
  for (const std::string& name : shapes) add(name, 1);
  face.channels.push_back({"parent", 6, Takes::accel});
  if (face.channels.size() > 17) {
    face.by_name.resize(face.channels.size());
    std::iota(face.by_name.begin(), face.by_name.end(), 0);
    std::sort(face.by_name.begin(), face.by_name.end(), [&](int a, int b) {
      return face.channels[static_cast<std::size_t>(a)].name <
             face.channels[static_cast<std::size_t>(b)].name;
    });
  }
  for (const char* suffix : {"", "_rate"})
    for (int i = 1; i <= modes; ++i) face.states.push_back(fmt::format("eta{}{}", i, suffix));
  face.rates = rates_follow(modes);
  return face;
}

namespace {

/// A mass matrix is symmetric; rounding of its data may not be.
Matrix6 symmetric(const Matrix6& D_P) { return (D_P + D_P.transpose()) / 2; }

}  // namespace

MatrixXd rigid_part(const std::vector<Vector3d>& PC, const Matrix6& D_P, Eigen::Index shapes) {
  const auto n = static_cast<Eigen::Index>(6 * PC.size()) + shapes;
  MatrixXd D = MatrixXd::Zero(n + 6, n + 6);
  for (std::size_t i = 0; i < PC.size(); ++i) {
    const Matrix6 tau_CP = tau(-PC[i]);
    const auto row = static_cast<Eigen::Index>(6 * i);
    D.block<6, 6>(row, n) = tau_CP;
    D.block<6, 6>(n, row) = tau_CP.transpose();
  }
  D.bottomRightCorner<6, 6>() = -symmetric(D_P);
  return D;
}

Kinematics body_kinematics(const std::vector<Vector3d>& PC, const std::vector<MatrixXd>& Phi_C,
                           const MatrixXd& Phi) {
  Kinematics k;
  k.reference = static_cast<int>(PC.size()) + static_cast<int>(Phi.rows());
  const auto modes = Phi_C.empty() ? Phi.cols() : Phi_C.front().cols();
  const auto add = [&](const MatrixXd& tau_CP, const MatrixXd& by_modes) {
    k.tau.push_back(tau_CP);
    k.Phi.emplace_back(MatrixXd::Zero(by_modes.rows(), 2 * modes));
    k.Phi.back().leftCols(modes) = by_modes;
  };
  for (std::size_t c = 0; c < PC.size(); ++c) add(tau(-PC[c]), Phi_C[c]);
  for (Eigen::Index i = 0; i < Phi.rows(); ++i) add(MatrixXd::Zero(1, 6), Phi.row(i));
  add(Matrix6::Identity(), MatrixXd::Zero(6, modes));
  return k;
}

namespace {

/// `rigid_part` by its nonzero blocks.
std::vector<Gains> rigid_gains(const std::vector<Vector3d>& PC, const Matrix6& D_P) {
  const int n = static_cast<int>(6 * PC.size());
  std::vector<Gains> result;
  for (int i = 0; i < n; i += 6)
    result.push_back({i, n, tau(-PC[static_cast<std::size_t>(i / 6)])});
  for (int i = 0; i < n; i += 6)
    result.push_back({n, i, tau(-PC[static_cast<std::size_t>(i / 6)]).transpose()});
  result.push_back({n, n, -symmetric(D_P)});
  return result;
}

class RigidBodyBlock : public Block, public Specified<RigidBody> {
 public:
  explicit RigidBodyBlock(const RigidBody& spec) : spec_(spec) {
    std::vector<std::string> names;
    for (const ChildPoint& c : spec.children) {
      names.push_back(c.name);
      PC_.push_back(c.PC.nominal());
      moves_ = moves_ || !c.PC.values().empty();
    }
    face_ = body_interface(names, 0);
  }
  const RigidBody& spec() const override { return spec_; }
  std::string_view type() const override { return "RigidBody"; }
  const Interface& interface() const override { return face_; }
  std::shared_ptr<const Dynamics> dynamics(ParameterValues values) const override {
    const double m = spec_.mass.at(values);
    const Matrix3d I_A = spec_.inertia.at(values);
    check_inertia(m, I_A);
    auto d = std::make_shared<Dynamics>();
    const Matrix6 D_P = rigid_mass(m, I_A, -spec_.PA.at(values));
    if (is_algebraic())
      d->sparse = rigid_gains(points(values), D_P);
    else
      d->D = rigid_part(points(values), D_P);
    const auto n = static_cast<Eigen::Index>(6 * PC_.size() + 6);
    d->A.resize(0, 0);
    d->B.resize(0, n);
    d->C.resize(n, 0);
    return d;
  }
  /// Wrenches do not feed through to accelerations: between children there is no direct term.
  Pattern feedthrough() const override {
    const auto n = static_cast<Eigen::Index>(6 * PC_.size());
    Pattern p = Pattern::Constant(n + 6, n + 6, true);
    p.topLeftCorner(n, n).setConstant(false);
    return p;
  }
  std::optional<Kinematics> kinematics(ParameterValues values) const override {
    return body_kinematics(points(values), std::vector<MatrixXd>(PC_.size(), MatrixXd(6, 0)));
  }
  std::vector<Value> values() const override {
    std::vector<Value> all = spec_.inertia.values();
    all.push_back(spec_.mass);
    const auto add = [&](const Position& p) {
      for (const Value& v : p.values()) all.push_back(v);
    };
    add(spec_.PA);
    for (const ChildPoint& c : spec_.children) add(c.PC);
    return all;
  }
  std::optional<Opened> opened(ParameterValues values,
                               std::span<const int> parameters) const override {
    return opened_rigid_body(spec_, *dynamics(values), values, parameters);
  }
  /// A hub of many ports becomes equations: each point moves with P, each wrench acts on P. A hub
  /// of few remains a block, so that its pivots are chosen among all its rows (a digit more).
  bool is_algebraic() const override { return PC_.size() > 7; }
  std::optional<Cause> why_singular(int channel, ParameterValues values) const override {
    if (channel != static_cast<int>(PC_.size()))
      return Cause{"is rigid: its child points cannot be driven by themselves",
                   "impose the motion of its parent point, or give the body modes"};
    if (spec_.mass.at(values) == 0)
      return Cause{"has mass 0", "give RigidBody{.mass = ...}, or impose parent.accel instead"};
    return Cause{"has a singular inertia",
                 "give RigidBody{.inertia = ...} about every axis, or impose the motion about it"};
  }

 private:
  std::vector<Vector3d> points(ParameterValues values) const {
    if (!moves_) return PC_;
    std::vector<Vector3d> result;
    for (const ChildPoint& c : spec_.children) result.push_back(c.PC.at(values));
    return result;
  }

  RigidBody spec_;
  std::vector<Vector3d> PC_;  ///< at nominal values
  bool moves_ = false;        ///< some PC has a parameter
  Interface face_;
};

}  // namespace

BlockPtr as_block(const RigidBody& spec) {
  check_inertia(spec.mass.nominal(), spec.inertia.nominal());
  bool finite = spec.PA.nominal().allFinite();
  for (const ChildPoint& c : spec.children) finite = finite && c.PC.nominal().allFinite();
  if (!finite)
    throw Error(Code::not_finite, "a position is not finite", "check PA and the child points");
  return std::make_shared<RigidBodyBlock>(spec);
}

}  // namespace titop
