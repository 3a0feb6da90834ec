#include <fmt/format.h>

#include <mutex>
#include <titop/blocks/body_interface.hpp>
#include <titop/blocks/fe/modal_checks.hpp>
#include <titop/blocks/flexible_body_block.hpp>
#include <titop/blocks/mode_values.hpp>
#include <titop/blocks/opened_flexible_body.hpp>
#include <titop/blocks/specified.hpp>
#include <titop/graph/modal_form.hpp>
#include <titop/graph/with_warnings.hpp>

namespace titop::detail {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

namespace {

/// Of the data, independent of frequencies and damping ratios.
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
  std::vector<std::string> shapes;
  for (const ModalLine& line : data.lines)
    for (const LineShape& shape : line.shapes) shapes.push_back(channel_of(line, shape));
  s->face = body_interface(names, static_cast<int>(data.omega.size()), shapes);
  s->W = modal_input(data);
  s->rigid = rigid_part(s->PC, data.D_P, shapes_of_lines(data));
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

class FlexibleBodyBlock : public Block,
                          public Specified<FlexibleBody::Spec>,
                          public FromData,
                          public WithWarnings {
 public:
  FlexibleBodyBlock(std::shared_ptr<const FlexibleBody::Spec> spec,
                    std::shared_ptr<const Shapes> shapes)
      : spec_(std::move(spec)), shapes_(std::move(shapes)), digits_(shapes_->digits) {
    size_entries();
    if (spec_->values.empty() && spec_->loss_factor == 0)
      made_ = made({}, [](const Value& value) { return value.nominal(); });
  }
  const FlexibleBody::Spec& spec() const override { return *spec_; }
  const std::shared_ptr<const Shapes>& shapes() const { return shapes_; }
  std::string_view type() const override { return "FlexibleBody"; }
  const Interface& interface() const override { return shapes_->face; }
  std::shared_ptr<const Dynamics> dynamics(ParameterValues values) const override {
    return made_at(values)->dynamics;
  }
  std::optional<Kinematics> kinematics(ParameterValues values) const override {
    const auto shapes = spec_->values.of_shapes() ? made_at(values)->shapes : shapes_;
    std::vector<MatrixXd> Phi;
    for (std::size_t c = 0; c < shapes->PC.size(); ++c)
      Phi.push_back(shapes->W.middleCols<6>(static_cast<Eigen::Index>(6 * c)).transpose());
    const Index points = static_cast<Index>(6 * shapes->PC.size());
    return body_kinematics(shapes->PC, Phi,
                           shapes->W.middleCols(points, shapes->W.cols() - points - 6).transpose());
  }
  std::vector<Value> values() const override { return list_of(spec_->values); }
  std::vector<std::string> warnings() const override { return spec_->data->warnings; }
  std::optional<Opened> opened(ParameterValues values,
                               std::span<const int> parameters) const override {
    const auto at = made_at(values);
    return opened_flexible_body(*spec_, at->modes, at->shapes->W, *at->dynamics, parameters);
  }
  Response response(std::complex<double> s, ParameterValues values) const override {
    if (spec_->damping.size() > 0) return Block::response(s, values);
    const auto at = made_at(values);
    if (at->dynamics->modal) return modal_response(*at->dynamics->modal, s, type());
    return modal_response({at->shapes->W, at->shapes->rigid, {}, {}}, s, type());
  }
  const DataDigits& digits() const override { return digits_; }
  Cause beyond_digits(int channel, const VectorXd& direction, double left) const override {
    const std::string where = direction.size() == 6 ? combination(direction) : "its direction";
    if (is_parent(channel))
      return {fmt::format("has no residual mass in {}: of D_P its modes leave {:.1e} there, the "
                          "noise of the data is {:.0e}",
                          where, left, digits_.mass),
              fmt::format("keep fewer modes, add the mass at P, or impose the motion of P in {}",
                          where)};
    return {fmt::format("has modes that do not move {} in {}: by {:.1e} of its other motions, the "
                        "noise of the data is {:.0e}",
                        name_of(channel), where, left, digits_.shapes),
            kKeepMore};
  }
  std::optional<Cause> why_singular(int channel, ParameterValues values) const override {
    const ModalData data = data_with(*spec_->data, spec_->values, at(values));
    if (is_parent(channel)) {
      const ResidualMass r = residual_mass(data);
      return Cause{
          fmt::format("has no residual mass in {}", component_name(r.component)),
          fmt::format("keep fewer modes, or leave {} of P as the modes have it and impose the "
                      "motion there",
                      component_name(r.component))};
    }
    if (channel >= static_cast<int>(data.children.size()))
      return Cause{fmt::format("has modes that do not move {}", name_of(channel)), kKeepMore};
    const ModalChild& c = data.children[static_cast<std::size_t>(channel)];
    const ChildRank rank = child_rank(data, c);
    std::string blocked;
    for (const std::string& b : rank.blocked) blocked += (blocked.empty() ? "" : ", ") + b;
    return Cause{fmt::format("has modes that do not move {} in {} (rank {} of 6)", c.name,
                             blocked.empty() ? "every direction" : blocked, rank.rank),
                 kKeepMore};
  }

 private:
  /// All that depends on the values.
  struct AtValues {
    std::vector<double> numbers;  ///< of the values
    ModalParameters modes;
    std::shared_ptr<const Shapes> shapes;
    std::shared_ptr<const Dynamics> dynamics;
  };

  /// Rows of Phi_C that are 0 in the data are exact, unless a value stands there: its row then has
  /// the size of the others of its kind, or its own.
  void size_entries() {
    for (std::size_t c = 0; c < spec_->data->children.size(); ++c) {
      const auto of = spec_->values.Phi_C.find(spec_->data->children[c].name);
      if (of == spec_->values.Phi_C.end()) continue;
      for (const ModeValues::Entry& e : of->second) {
        if (e.component < 1 || e.component > 6) continue;  // refused by as_block
        const Index first = static_cast<Index>(6 * c) + (e.component > 3 ? 3 : 0),
                    row = static_cast<Index>(6 * c) + e.component - 1;
        double& size = digits_.size(row);
        if (size == 0) size = shapes_->digits.size.segment<3>(first).maxCoeff();
        if (size == 0) size = std::abs(e.value.nominal());
      }
    }
  }

  bool is_parent(int channel) const {
    return channel + 1 == static_cast<int>(shapes_->face.channels.size());
  }
  const std::string& name_of(int channel) const {
    return shapes_->face.channels[static_cast<std::size_t>(channel)].name;
  }

  static NumberOf at(ParameterValues values) {
    return [values](const Value& v) { return v.at(values); };
  }

  std::shared_ptr<const AtValues> made(std::vector<double> numbers, const NumberOf& number) const {
    AtValues m{std::move(numbers), {}, shapes_, {}};
    if (spec_->values.of_shapes()) {
      ModalData data = data_with(*spec_->data, spec_->values, number);
      m.shapes = shapes_of(data);
      m.modes = {std::move(data.omega), std::move(data.xi)};
    } else {
      m.modes = modes_with(*spec_->data, spec_->values, number);
    }
    Modal modal{m.shapes->W, m.shapes->rigid, m.modes.omega.cwiseAbs2(),
                2 * m.modes.xi.cwiseProduct(m.modes.omega)};
    m.dynamics = spec_->damping.size() > 0 ? coupled_dynamics(std::move(modal), spec_->damping)
                                           : modal_dynamics(std::move(modal));
    return std::make_shared<const AtValues>(std::move(m));
  }

  /// All nodes of one body share the last result, which is cached.
  std::shared_ptr<const AtValues> made_at(ParameterValues values) const {
    if (spec_->loss_factor > 0) throw no_state_space(spec_->loss_factor);
    if (spec_->values.empty()) return made_;
    std::vector<double> numbers;
    for (const Value& v : this->values()) numbers.push_back(v.at(values));
    {
      const std::scoped_lock lock(keeping_);
      if (made_ && numbers == made_->numbers) return made_;
    }
    auto result = made(std::move(numbers), at(values));
    const std::scoped_lock lock(keeping_);
    made_ = result;
    return result;
  }

  std::shared_ptr<const FlexibleBody::Spec> spec_;
  std::shared_ptr<const Shapes> shapes_;
  DataDigits digits_;  ///< of the shapes, and of values in place of some
  mutable std::mutex keeping_;
  mutable std::shared_ptr<const AtValues> made_;
};

}  // namespace

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
