#include <fmt/format.h>

#include <mutex>
#include <titop/blocks/body_interface.hpp>
#include <titop/blocks/fe/modal_checks.hpp>
#include <titop/blocks/flexible_body_block.hpp>
#include <titop/blocks/specified.hpp>
#include <titop/graph/modal_form.hpp>
#include <titop/graph/opened.hpp>

namespace titop::detail {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

namespace {

/// The numbers of all modes with these values in place; number(value) converts a value.
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
ModalParameters modes_of(const FlexibleBody::Spec& spec, Number number) {
  ModalParameters m{replaced(spec.data->omega, spec.values.omega, number),
                    replaced(spec.data->xi, spec.values.xi, number)};
  check_modes(m);
  return m;
}

/// Common to bodies of the same data, independent of the values of their modes.
struct Shapes {
  std::vector<Vector3d> PC;
  Interface face;
  MatrixXd W, rigid;
  DataDigits digits;
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
  s->digits = data_digits(data);
  return s;
}

/// -Z etad in place of the damping of each mode.
std::shared_ptr<const Dynamics> coupled_dynamics(Modal modal, const MatrixXd& Z) {
  const Index n = Z.rows();
  const MatrixXd W = modal.W;
  Dynamics d = *modal_dynamics(std::move(modal));
  d.A.bottomRightCorner(n, n) = -Z;
  d.C.rightCols(n) = -W.transpose() * Z;
  d.modal.reset();
  return std::make_shared<const Dynamics>(std::move(d));
}

constexpr const char* kKeepMore =
    "keep more modes or residual vectors there, or lock only the other degrees of freedom";

class FlexibleBodyBlock : public Block, public Specified<FlexibleBody::Spec>, public FromData {
 public:
  FlexibleBodyBlock(std::shared_ptr<const FlexibleBody::Spec> spec,
                    std::shared_ptr<const Shapes> shapes)
      : spec_(std::move(spec)), shapes_(std::move(shapes)) {
    if (!spec_->values.empty() || spec_->loss_factor > 0) return;
    Modal m = modal({spec_->data->omega, spec_->data->xi});
    made_ = spec_->damping.size() > 0 ? coupled_dynamics(std::move(m), spec_->damping)
                                      : modal_dynamics(std::move(m));
  }
  const FlexibleBody::Spec& spec() const override { return *spec_; }
  const std::shared_ptr<const Shapes>& shapes() const { return shapes_; }
  std::string_view type() const override { return "FlexibleBody"; }
  const Interface& interface() const override { return shapes_->face; }
  /// All nodes of one body share the last result, which is cached.
  std::shared_ptr<const Dynamics> dynamics(ParameterValues values) const override {
    if (spec_->loss_factor > 0) throw no_state_space(spec_->loss_factor);
    if (spec_->values.empty()) return made_;
    ModalParameters m = modes_at(values);
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
  /// With v = omega eta + 2 xi etad and etadd = W u - omega v: omega has z = eta, whose w adds to
  /// v, and z = v, whose w subtracts from etadd; xi has z = etad, whose w adds twice to v.
  std::optional<Opened> opened(ParameterValues values,
                               std::span<const int> parameters) const override {
    const ModalParameters m = modes_at(values);
    const Eigen::Index n = m.omega.size();
    std::vector<OpenedPair> pairs;
    for (Eigen::Index i = 0; i < n; ++i) {
      const auto value = [&](const std::map<int, Value>& list, double number) {
        const auto found = list.find(static_cast<int>(i + 1));
        return found == list.end() ? Value(number) : found->second;
      };
      const Value omega = value(spec_->values.omega, m.omega(i)),
                  xi = value(spec_->values.xi, m.xi(i));
      const auto acting = [&](const Value& v, double on_mode, Eigen::RowVectorXd z) {
        return OpenedPair{v,
                          on_mode * VectorXd::Unit(2 * n, n + i),
                          on_mode * shapes_->W.row(i).transpose(),
                          std::move(z),
                          {}};
      };
      const Eigen::RowVectorXd eta = Eigen::RowVectorXd::Unit(2 * n, i),
                               etad = Eigen::RowVectorXd::Unit(2 * n, n + i);
      const std::size_t first = pairs.size();
      pairs.push_back(acting(omega, -m.omega(i), eta));
      pairs.push_back(acting(xi, -2 * m.omega(i), etad));
      pairs.push_back(acting(omega, -1, m.omega(i) * eta + 2 * m.xi(i) * etad));
      pairs.back().of_pairs = {{first, 1}, {first + 1, 2}};
    }
    return with_pairs(*dynamics(values), pairs, parameters);
  }
  Response response(std::complex<double> s, ParameterValues values) const override {
    if (spec_->damping.size() > 0) return Block::response(s, values);
    if (const auto d = dynamics(values); d->modal) return modal_response(*d->modal, s, type());
    return modal_response({shapes_->W, shapes_->rigid, {}, {}}, s, type());
  }
  const DataDigits& digits() const override { return shapes_->digits; }
  Cause beyond_digits(int channel, const VectorXd& direction, double left) const override {
    const std::string where = combination(direction);
    const auto c = static_cast<std::size_t>(channel);
    if (c == spec_->data->children.size())
      return {fmt::format("has no residual mass in {}: of D_P its modes leave {:.1e} there, the "
                          "noise of the data is {:.0e}",
                          where, left, shapes_->digits.mass),
              fmt::format("keep fewer modes, add the mass at P, or impose the motion of P in {}",
                          where)};
    return {fmt::format("has modes that do not move {} in {}: by {:.1e} of its other motions, the "
                        "noise of the data is {:.0e}",
                        spec_->data->children[c].name, where, left, shapes_->digits.shapes),
            kKeepMore};
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
    return Cause{fmt::format("has modes that do not move {} in {} (rank {} of 6)", c.name,
                             blocked.empty() ? "every direction" : blocked, rank.rank),
                 kKeepMore};
  }

 private:
  ModalParameters modes_at(ParameterValues values) const {
    return modes_of(*spec_, [&](const Value& v) { return v.at(values); });
  }
  Modal modal(const ModalParameters& m) const {
    return {shapes_->W, shapes_->rigid, m.omega.cwiseAbs2(), 2 * m.xi.cwiseProduct(m.omega)};
  }

  std::shared_ptr<const FlexibleBody::Spec> spec_;
  std::shared_ptr<const Shapes> shapes_;
  mutable std::mutex keeping_;
  mutable std::shared_ptr<const Dynamics> made_;
  mutable ModalParameters made_for_;
};

}  // namespace

ModalParameters nominal_modes(const FlexibleBody::Spec& spec) {
  return modes_of(spec, [](const Value& value) { return value.nominal(); });
}

Error no_state_space(double loss_factor) {
  return {
      Code::not_rational,
      fmt::format("a loss factor of {} has no state-space model: the stiffness (1 + {}j) K at s = "
                  "j omega is no rational function of s",
                  loss_factor, loss_factor),
      fmt::format("frequency_response(diagram, omega) takes it; for a state space take modal "
                  "damping of xi = {}, equal at resonances (ModeOptions::xi, ModalData::xi)",
                  loss_factor / 2)};
}

BlockPtr flexible_body_block(std::shared_ptr<const FlexibleBody::Spec> spec, const BlockPtr& like) {
  auto shapes =
      like ? static_cast<const FlexibleBodyBlock&>(*like).shapes() : shapes_of(*spec->data);
  return std::make_shared<const FlexibleBodyBlock>(std::move(spec), std::move(shapes));
}

}  // namespace titop::detail
