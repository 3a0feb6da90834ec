#include <fmt/format.h>

#include <titop/blocks/body_interface.hpp>
#include <titop/blocks/flexible_body.hpp>
#include <titop/blocks/modal_checks.hpp>
#include <titop/blocks/specified.hpp>
#include <titop/graph/modal_form.hpp>

namespace titop {

using Eigen::MatrixXd;
using Eigen::VectorXd;

namespace {

void check_shapes(const ModalData& d) {
  const auto n = d.omega.size();
  const auto refuse = [&](const std::string& what, Eigen::Index rows, Eigen::Index cols,
                          const std::string& expected) {
    throw Error(Code::bad_modes, fmt::format("{} is {} x {} for {} modes", what, rows, cols, n),
                fmt::format("it must be {}", expected));
  };
  if (d.xi.size() != n) refuse("xi", d.xi.size(), 1, fmt::format("{} x 1", n));
  if (d.L_P.rows() != n || (n > 0 && d.L_P.cols() != 6))
    refuse("L_P", d.L_P.rows(), d.L_P.cols(), fmt::format("{} x 6, a row per mode", n));
  for (const ModalChild& c : d.children)
    if (c.Phi_C.cols() != n || (n > 0 && c.Phi_C.rows() != 6))
      refuse("Phi_C of " + c.name, c.Phi_C.rows(), c.Phi_C.cols(),
             fmt::format("6 x {}, a column per mode", n));
}

void check_values(const ModalData& d) {
  bool finite = d.omega.allFinite() && d.xi.allFinite() && d.L_P.allFinite() && d.D_P.allFinite();
  for (const ModalChild& c : d.children) finite = finite && c.Phi_C.allFinite() && c.PC.allFinite();
  if (!finite)
    throw Error(Code::not_finite, "the modal data have entries that are not finite",
                "check omega, xi, L_P, D_P and Phi_C");
  for (Eigen::Index i = 0; i < d.omega.size(); ++i)
    if (!(d.omega(i) > 0) || d.xi(i) < 0)
      throw Error(Code::bad_modes,
                  fmt::format("mode {} has omega {} rad/s and damping ratio {}", i + 1, d.omega(i),
                              d.xi(i)),
                  "omega must be positive (modes clamped at P have no rigid motion), xi 0 or more");
}

void check_mass(const ModalData& d) {
  const double off = (d.D_P - d.D_P.transpose()).cwiseAbs().maxCoeff();
  if (off > 1e-9 * d.D_P.cwiseAbs().maxCoeff())
    throw Error(Code::bad_inertia, fmt::format("D_P is not symmetric, by {:.2g}", off),
                "give the full symmetric 6 x 6 mass matrix about P");
  for (int i = 0; i < 6; ++i)
    if (d.D_P(i, i) < 0)
      throw Error(Code::bad_inertia,
                  fmt::format("D_P has {} at {}", d.D_P(i, i), component_name(i)),
                  "masses and inertias about P must be 0 or more");
  const ResidualMass r = residual_mass(d);
  if (r.verdict == Definiteness::indefinite)
    throw Error(
        Code::bad_modes,
        fmt::format("the modes carry more mass than there is: D_P - L_P' L_P is negative in {}, "
                    "by {:.2g} of D_P there (noise of the data: {:.1g})",
                    component_name(r.component), -r.smallest, r.noise),
        "check units and signs of L_P against D_P, or ModalData::digits");
}

class FlexibleBodyBlock : public Block, public Specified<ModalData> {
 public:
  explicit FlexibleBodyBlock(std::shared_ptr<const ModalData> data) : data_(std::move(data)) {
    std::vector<std::string> names;
    for (const ModalChild& c : data_->children) {
      names.push_back(c.name);
      PC_.push_back(c.PC);
    }
    face_ = body_interface(names, static_cast<int>(data_->omega.size()));
    modal_ = {modal_input(*data_), rigid_part(PC_, data_->D_P), data_->omega.cwiseAbs2(),
              2 * data_->xi.cwiseProduct(data_->omega)};
    matrices_ = modal_dynamics(modal_);
  }
  const ModalData& spec() const override { return *data_; }
  std::string_view type() const override { return "FlexibleBody"; }
  const Interface& interface() const override { return face_; }
  std::shared_ptr<const Dynamics> dynamics(ParameterValues) const override { return matrices_; }
  std::optional<Kinematics> kinematics(ParameterValues) const override {
    std::vector<MatrixXd> Phi;
    for (const ModalChild& c : data_->children) Phi.push_back(c.Phi_C);
    return body_kinematics(PC_, Phi);
  }
  Response response(std::complex<double> s, ParameterValues) const override {
    return modal_response(modal_, s, type());
  }
  std::optional<Cause> why_singular(int channel, ParameterValues) const override {
    if (channel == static_cast<int>(data_->children.size())) {
      const ResidualMass r = residual_mass(*data_);
      return Cause{
          fmt::format("has no residual mass in {}", component_name(r.component)),
          fmt::format("keep fewer modes, or leave {} of P as the modes have it and impose the "
                      "motion there",
                      component_name(r.component))};
    }
    const ModalChild& c = data_->children[static_cast<std::size_t>(channel)];
    const ChildRank rank = child_rank(*data_, c);
    std::string blocked;
    for (const std::string& b : rank.blocked) blocked += (blocked.empty() ? "" : ", ") + b;
    return Cause{
        fmt::format("has modes that do not move {} in {} (rank {} of 6)", c.name,
                    blocked.empty() ? "every direction" : blocked, rank.rank),
        "keep more modes or residual vectors there, or lock only the other degrees of freedom"};
  }

 private:
  std::shared_ptr<const ModalData> data_;
  std::vector<Vector3d> PC_;
  Interface face_;
  Modal modal_;
  std::shared_ptr<const Dynamics> matrices_;
};

ModalData without_modes(const RigidBody& body) {
  ModalData d;
  d.omega.resize(0);
  d.xi.resize(0);
  d.L_P.resize(0, 6);
  check_inertia(body.mass.nominal(), body.inertia.nominal());
  d.D_P = rigid_mass(body.mass.nominal(), body.inertia.nominal(), -body.PA);
  for (const ChildPoint& c : body.children) d.children.push_back({c.name, c.PC, MatrixXd(6, 0)});
  return d;
}

}  // namespace

MatrixXd modal_input(const ModalData& d) {
  const auto n = d.omega.size();
  MatrixXd W(n, static_cast<Eigen::Index>(6 * d.children.size()) + 6);
  for (std::size_t i = 0; i < d.children.size(); ++i)
    if (n > 0) W.middleCols<6>(static_cast<Eigen::Index>(6 * i)) = d.children[i].Phi_C.transpose();
  if (n > 0) W.rightCols<6>() = -d.L_P;
  return W;
}

FlexibleBody::FlexibleBody(ModalData data)
    : data_(std::make_shared<const ModalData>(std::move(data))) {
  check_shapes(*data_);
  check_values(*data_);
  check_mass(*data_);
  block_ = std::make_shared<FlexibleBodyBlock>(data_);
}

FlexibleBody::FlexibleBody(const Beam& beam) : FlexibleBody(modal_data(beam)) {}
FlexibleBody::FlexibleBody(const RigidBody& body) : FlexibleBody(without_modes(body)) {}

BlockPtr as_block(const FlexibleBody& body) { return body.block(); }

}  // namespace titop
