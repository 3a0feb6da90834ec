#include <fmt/format.h>

#include <set>
#include <titop/blocks/joint_block.hpp>
#include <titop/blocks/specified.hpp>
#include <titop/graph/error.hpp>
#include <titop/graph/linalg/index.hpp>
#include <titop/graph/linalg/rounding.hpp>

namespace titop {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using linalg::at;

Interface face_of(const std::vector<AxisNames>& names) {
  Interface face{{{"child", 6, Takes::force}, {"parent", 6, Takes::accel}}, {}, {}, {}};
  std::set<std::string> seen{"child", "parent"};
  for (const AxisNames& n : names) {
    face.channels.push_back({n.channel, 1, Takes::accel, "accel", n.force});
    for (const std::string& name : {n.position, n.rate})
      if (!seen.insert(name).second)
        throw Error(Code::duplicate_name, fmt::format("a second axis is called \"{}\"", name),
                    "give every axis a name of its own, other than \"child\" and \"parent\"");
  }
  for (const AxisNames& n : names) face.outputs.push_back({n.position, 1, Quantity::position});
  for (const AxisNames& n : names) face.outputs.push_back({n.rate, 1, Quantity::velocity});
  for (const PortSpec& p : face.outputs) face.states.push_back(p.name);
  face.rates = rates_follow(static_cast<int>(names.size()));
  return face;
}

/// The twists side by side, 6 x k.
MatrixXd twists(const std::vector<Axis>& axes, const std::vector<AxisNames>& names) {
  if (axes.empty())
    throw Error(Code::bad_value, "the joint leaves no axis free",
                "give it an axis, or mount the body without a joint");
  MatrixXd S(6, static_cast<Index>(axes.size())), basis(6, 0);
  for (Index i = 0; i < S.cols(); ++i) {
    S.col(i) = twist(axes[at(i)]);
    Vector6 rest = S.col(i);
    for (int twice = 0; twice < 2; ++twice) rest -= basis * (basis.transpose() * rest);
    if (rest.norm() < linalg::kMatrixDigits)
      throw Error(Code::bad_value,
                  fmt::format("{} moves as the axes before it do already", names[at(i)].position),
                  "leave it out, or turn it: the axes of a joint must be independent");
    basis.conservativeResize(6, i + 1);
    basis.col(i) = rest.normalized();
  }
  return S;
}

class JointBlock : public Block, public Specified<std::vector<Axis>> {
 public:
  JointBlock(std::string_view type, const std::vector<Axis>& axes,
             const std::vector<AxisNames>& names, std::string carries)
      : type_(type),
        carries_(std::move(carries)),
        axes_(axes),
        face_(face_of(names)),
        S_(twists(axes, names)) {
    const Index k = S_.cols();
    auto d = std::make_shared<Dynamics>();
    d->A = MatrixXd::Zero(2 * k, 2 * k);
    d->A.topRightCorner(k, k).setIdentity();
    d->B = MatrixXd::Zero(2 * k, 12 + k);
    d->B.bottomRightCorner(k, k).setIdentity();
    d->C = MatrixXd::Zero(12 + 3 * k, 2 * k);
    d->C.bottomRows(2 * k).setIdentity();
    d->D = MatrixXd::Zero(12 + 3 * k, 12 + k);
    d->D.block<6, 6>(0, 6).setIdentity();      // xdd_C from xdd_P
    d->D.block(0, 12, 6, k) = S_;              //       from qdd
    d->D.block<6, 6>(6, 0).setIdentity();      // F_P from F_C
    d->D.block(12, 0, k, 6) = S_.transpose();  // Q from F_C
    matrices_ = std::move(d);
  }
  const std::vector<Axis>& spec() const override { return axes_; }
  std::string_view type() const override { return type_; }
  const Interface& interface() const override { return face_; }
  std::shared_ptr<const Dynamics> dynamics(ParameterValues) const override { return matrices_; }
  Pattern feedthrough() const override {
    Pattern p = matrices_->D.array() != 0;
    for (Index i = 0; i < S_.cols(); ++i) {  // for any direction
      const Index half = S_.col(i).head<3>().isZero(0) ? 3 : 0;
      p.block<3, 1>(half, 12 + i).setConstant(true);
      p.block<1, 3>(12 + i, half).setConstant(true);
    }
    return p;
  }
  /// Only its own axes drive the angles, and only the readings depend on them: at a given posture
  /// the accelerations and wrenches on both sides are independent of them.
  Pattern moved_by() const override {
    Pattern p = Pattern::Constant(1, 12 + S_.cols(), false);
    p.rightCols(S_.cols()).setConstant(true);
    return p;
  }
  Pattern seen_by() const override {
    Pattern p = Pattern::Constant(12 + 3 * S_.cols(), 1, false);
    p.bottomRows(2 * S_.cols()).setConstant(true);
    return p;
  }
  std::optional<Kinematics> kinematics(ParameterValues) const override {
    const Index k = S_.cols();
    Kinematics result{.reference = 1, .tau = {}, .Phi = {}};
    result.tau.assign(2, MatrixXd::Identity(6, 6));
    result.Phi.assign(2, MatrixXd::Zero(6, 2 * k));
    result.Phi.front().leftCols(k) = S_;
    for (Index i = 0; i < k; ++i) {
      result.tau.emplace_back(MatrixXd::Zero(1, 6));
      result.Phi.emplace_back(MatrixXd::Identity(2 * k, 2 * k).row(i));
    }
    return result;
  }
  std::optional<Cause> why_singular(int, ParameterValues) const override {
    return Cause{"is a massless joint", fmt::format("give the body that it carries {}, or drive "
                                                    "the other side",
                                                    carries_)};
  }

 private:
  std::string_view type_;
  std::string carries_;
  std::vector<Axis> axes_;
  Interface face_;
  MatrixXd S_;  ///< 6 x k
  std::shared_ptr<const Dynamics> matrices_;
};

}  // namespace

BlockPtr joint_block(std::string_view type, const std::vector<Axis>& axes,
                     const std::vector<AxisNames>& names, std::string carries) {
  return std::make_shared<JointBlock>(type, axes, names, std::move(carries));
}

}  // namespace titop
