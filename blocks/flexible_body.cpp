#include <fmt/format.h>

#include <cmath>
#include <mutex>
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

struct Modes {
  VectorXd omega, xi;  // N each, [rad/s] and [-]
};

void check_modes(const Modes& m) {
  for (Eigen::Index i = 0; i < m.omega.size(); ++i) {
    const auto refuse = [&](Code code, const char* hint) {
      throw Error(code,
                  fmt::format("mode {} has omega {} rad/s and damping ratio {}", i + 1, m.omega(i),
                              m.xi(i)),
                  hint);
    };
    if (!std::isfinite(m.omega(i)) || !std::isfinite(m.xi(i)))
      refuse(Code::not_finite, "give finite numbers");
    if (!(m.omega(i) > 0) || m.xi(i) < 0)
      refuse(Code::bad_modes,
             "omega must be positive (modes clamped at P have no rigid motion), xi 0 or more");
  }
}

/// The numbers of all modes with these in their place; number(value) is what a value stands for.
template <class Number>
VectorXd replaced(VectorXd numbers, const std::map<int, Value>& values, Number number) {
  for (const auto& [mode, value] : values) {
    if (mode < 1 || mode > numbers.size())
      throw Error(Code::bad_modes,
                  fmt::format("a value is given for mode {} of {}", mode, numbers.size()),
                  "modes count from 1, as in eta1");
    numbers(mode - 1) = number(value);
  }
  return numbers;
}

template <class Number>
Modes modes_of(const FlexibleBody::Spec& spec, Number number) {
  Modes m{replaced(spec.data->omega, spec.values.omega, number),
          replaced(spec.data->xi, spec.values.xi, number)};
  check_modes(m);
  return m;
}

double nominal_of(const Value& value) { return value.nominal(); }

void check_values(const ModalData& d) {
  bool finite = d.omega.allFinite() && d.xi.allFinite() && d.L_P.allFinite() && d.D_P.allFinite();
  for (const ModalChild& c : d.children) finite = finite && c.Phi_C.allFinite() && c.PC.allFinite();
  if (!finite)
    throw Error(Code::not_finite, "the modal data have entries that are not finite",
                "check omega, xi, L_P, D_P and Phi_C");
  check_modes({d.omega, d.xi});
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

/// What bodies of the same data share, whatever the values of their modes.
struct Shapes {
  std::vector<Vector3d> PC;
  Interface face;
  MatrixXd W, rigid;
};

std::shared_ptr<const Shapes> shapes_of(const ModalData& data) {
  auto s = std::make_shared<Shapes>();
  std::vector<std::string> names;
  for (const ModalChild& c : data.children) {
    names.push_back(c.name);
    s->PC.push_back(c.PC);
  }
  s->face = body_interface(names, static_cast<int>(data.omega.size()));
  s->W = modal_input(data);
  s->rigid = rigid_part(s->PC, data.D_P);
  return s;
}

class FlexibleBodyBlock : public Block, public Specified<FlexibleBody::Spec> {
 public:
  FlexibleBodyBlock(std::shared_ptr<const FlexibleBody::Spec> spec,
                    std::shared_ptr<const Shapes> shapes)
      : spec_(std::move(spec)), shapes_(std::move(shapes)) {
    if (spec_->values.empty()) made_ = modal_dynamics(modal({spec_->data->omega, spec_->data->xi}));
  }
  const FlexibleBody::Spec& spec() const override { return *spec_; }
  const std::shared_ptr<const Shapes>& shapes() const { return shapes_; }
  std::string_view type() const override { return "FlexibleBody"; }
  const Interface& interface() const override { return shapes_->face; }
  /// All nodes of one body ask for the same: what was made last is kept, and shared.
  std::shared_ptr<const Dynamics> dynamics(ParameterValues values) const override {
    if (spec_->values.empty()) return made_;
    Modes m = modes_at(values);
    {
      const std::scoped_lock lock(keeping_);
      if (made_ && m.omega == made_for_.omega && m.xi == made_for_.xi) return made_;
    }
    auto made = modal_dynamics(modal(m));
    const std::scoped_lock lock(keeping_);
    made_ = made;
    made_for_ = std::move(m);
    return made;
  }
  std::optional<Kinematics> kinematics(ParameterValues) const override {
    std::vector<MatrixXd> Phi;
    for (const ModalChild& c : spec_->data->children) Phi.push_back(c.Phi_C);
    return body_kinematics(shapes_->PC, Phi);
  }
  std::vector<Value> values() const override {
    std::vector<Value> all;
    for (const auto* list : {&spec_->values.omega, &spec_->values.xi})
      for (const auto& [mode, value] : *list) all.push_back(value);
    return all;
  }
  Response response(std::complex<double> s, ParameterValues values) const override {
    if (const auto d = dynamics(values); d->modal) return modal_response(*d->modal, s, type());
    return modal_response({shapes_->W, shapes_->rigid, {}, {}}, s, type());
  }
  std::optional<Cause> why_singular(int channel, ParameterValues) const override {
    const ModalData& data = *spec_->data;
    if (channel == static_cast<int>(data.children.size())) {
      const ResidualMass r = residual_mass(data);
      return Cause{
          fmt::format("has no residual mass in {}", component_name(r.component)),
          fmt::format("keep fewer modes, or leave {} of P as the modes have it and impose the "
                      "motion there",
                      component_name(r.component))};
    }
    const ModalChild& c = data.children[static_cast<std::size_t>(channel)];
    const ChildRank rank = child_rank(data, c);
    std::string blocked;
    for (const std::string& b : rank.blocked) blocked += (blocked.empty() ? "" : ", ") + b;
    return Cause{
        fmt::format("has modes that do not move {} in {} (rank {} of 6)", c.name,
                    blocked.empty() ? "every direction" : blocked, rank.rank),
        "keep more modes or residual vectors there, or lock only the other degrees of freedom"};
  }

 private:
  Modes modes_at(ParameterValues values) const {
    return modes_of(*spec_, [&](const Value& v) { return v.at(values); });
  }
  Modal modal(const Modes& m) const {
    return {shapes_->W, shapes_->rigid, m.omega.cwiseAbs2(), 2 * m.xi.cwiseProduct(m.omega)};
  }

  std::shared_ptr<const FlexibleBody::Spec> spec_;
  std::shared_ptr<const Shapes> shapes_;
  mutable std::mutex keeping_;
  mutable std::shared_ptr<const Dynamics> made_;
  mutable Modes made_for_;
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

FlexibleBody::FlexibleBody(ModalData given) {
  auto data = std::make_shared<const ModalData>(std::move(given));
  check_shapes(*data);
  check_values(*data);
  check_mass(*data);
  spec_ = std::make_shared<const Spec>(Spec{data});
  block_ = std::make_shared<const FlexibleBodyBlock>(spec_, shapes_of(*data));
}

FlexibleBody::FlexibleBody(const FlexibleBody& body, const ModeValues& values) {
  Spec spec{body.spec_->data, values};
  spec.values.omega.insert(body.spec_->values.omega.begin(), body.spec_->values.omega.end());
  spec.values.xi.insert(body.spec_->values.xi.begin(), body.spec_->values.xi.end());
  spec_ = std::make_shared<const Spec>(std::move(spec));
  block_ = std::make_shared<const FlexibleBodyBlock>(
      spec_, static_cast<const FlexibleBodyBlock&>(*body.block_).shapes());
}

FlexibleBody::FlexibleBody(const Beam& beam) : FlexibleBody(modal_data(beam)) {}
FlexibleBody::FlexibleBody(const RigidBody& body) : FlexibleBody(without_modes(body)) {}

ModalData FlexibleBody::nominal() const {
  Modes m = modes_of(*spec_, nominal_of);
  ModalData result = data();
  result.omega = std::move(m.omega);
  result.xi = std::move(m.xi);
  return result;
}

BlockPtr as_block(const FlexibleBody& body) {
  if (!body.spec().values.empty()) modes_of(body.spec(), nominal_of);  // refuses what is no body
  return body.block();
}

}  // namespace titop
