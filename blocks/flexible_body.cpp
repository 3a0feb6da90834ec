#include <fmt/format.h>

#include <mutex>
#include <titop/blocks/body_interface.hpp>
#include <titop/blocks/check_modal_data.hpp>
#include <titop/blocks/fe/modal_checks.hpp>
#include <titop/blocks/flexible_body.hpp>
#include <titop/blocks/specified.hpp>
#include <titop/graph/modal_form.hpp>
#include <titop/graph/opened.hpp>
#include <type_traits>

namespace titop {

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
detail::ModalParameters modes_of(const FlexibleBody::Spec& spec, Number number) {
  detail::ModalParameters m{replaced(spec.data->omega, spec.values.omega, number),
                            replaced(spec.data->xi, spec.values.xi, number)};
  detail::check_modes(m);
  return m;
}

double nominal_of(const Value& value) { return value.nominal(); }

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

constexpr const char* kKeepMore =
    "keep more modes or residual vectors there, or lock only the other degrees of freedom";

class FlexibleBodyBlock : public Block, public Specified<FlexibleBody::Spec>, public FromData {
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
  /// All nodes of one body share the last result, which is cached.
  std::shared_ptr<const Dynamics> dynamics(ParameterValues values) const override {
    if (spec_->values.empty()) return made_;
    detail::ModalParameters m = modes_at(values);
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
    const detail::ModalParameters m = modes_at(values);
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
  detail::ModalParameters modes_at(ParameterValues values) const {
    return modes_of(*spec_, [&](const Value& v) { return v.at(values); });
  }
  Modal modal(const detail::ModalParameters& m) const {
    return {shapes_->W, shapes_->rigid, m.omega.cwiseAbs2(), 2 * m.xi.cwiseProduct(m.omega)};
  }

  std::shared_ptr<const FlexibleBody::Spec> spec_;
  std::shared_ptr<const Shapes> shapes_;
  mutable std::mutex keeping_;
  mutable std::shared_ptr<const Dynamics> made_;
  mutable detail::ModalParameters made_for_;
};

ModalData without_modes(const RigidBody& body) {
  ModalData d;
  d.omega.resize(0);
  d.xi.resize(0);
  d.L_P.resize(0, 6);
  check_inertia(body.mass.nominal(), body.inertia.nominal());
  d.D_P = rigid_mass(body.mass.nominal(), body.inertia.nominal(), -body.PA.nominal());
  for (const ChildPoint& c : body.children)
    d.children.push_back({c.name, c.PC.nominal(), MatrixXd(6, 0)});
  return d;
}

/// Returns make(); adds the source line that creates the body to its mistakes. A body of a scene
/// file has no source line: the reader adds its place.
template <class Make>
std::invoke_result_t<Make> told_at(const std::source_location& at, Make make) {
  try {
    return make();
  } catch (const Error& error) {
    if (at.line() == 0) throw;
    std::vector<Mistake> mistakes = error.mistakes();
    for (Mistake& m : mistakes) m.details.push_back("the body was made at " + to_string(at));
    throw Error(std::move(mistakes));
  }
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

FlexibleBody::FlexibleBody(ModalData given, std::source_location at) {
  const auto data = std::make_shared<const ModalData>(std::move(given));
  told_at(at, [&] {
    detail::check_modal_data(*data);
    spec_ = std::make_shared<const Spec>(Spec{data});
    block_ = std::make_shared<const FlexibleBodyBlock>(spec_, shapes_of(*data));
  });
}

FlexibleBody::FlexibleBody(const FlexibleBody& body, const ModeValues& values) {
  Spec spec{body.spec_->data, values};
  spec.values.omega.insert(body.spec_->values.omega.begin(), body.spec_->values.omega.end());
  spec.values.xi.insert(body.spec_->values.xi.begin(), body.spec_->values.xi.end());
  spec_ = std::make_shared<const Spec>(std::move(spec));
  block_ = std::make_shared<const FlexibleBodyBlock>(
      spec_, static_cast<const FlexibleBodyBlock&>(*body.block_).shapes());
}

FlexibleBody::FlexibleBody(const Beam& beam, std::source_location at)
    : FlexibleBody(told_at(at, [&] { return modal_data(beam); }), at) {}
FlexibleBody::FlexibleBody(const RigidBody& body, std::source_location at)
    : FlexibleBody(told_at(at, [&] { return without_modes(body); }), at) {}

ModalData FlexibleBody::nominal() const {
  detail::ModalParameters m = modes_of(*spec_, nominal_of);
  ModalData result = data();
  result.omega = std::move(m.omega);
  result.xi = std::move(m.xi);
  return result;
}

BlockPtr as_block(const FlexibleBody& body) {
  if (!body.spec().values.empty()) modes_of(body.spec(), nominal_of);  // throws for invalid values
  return body.block();
}

}  // namespace titop
