#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <titop/blocks/flexible_body_block.hpp>
#include <titop/blocks/mode_values.hpp>
#include <type_traits>

namespace titop {

using Eigen::MatrixXd;

namespace {

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
std::invoke_result_t<Make> told_at(const SourceLine& at, Make make) {
  try {
    return make();
  } catch (const Error& error) {
    if (at.line() == 0) throw;
    std::vector<Mistake> mistakes = error.mistakes();
    for (Mistake& m : mistakes) m.details.push_back("the body was made at " + to_string(at));
    throw Error(std::move(mistakes));
  }
}

/// A body's damping is of one kind.
void require_damped_by_xi(const FlexibleBody::Spec& spec, const char* given) {
  if (spec.damping.size() == 0 && spec.loss_factor == 0) return;
  throw Error(
      Code::bad_modes,
      fmt::format("a body with {} is given {}",
                  spec.loss_factor > 0 ? "a loss factor" : "a damping matrix", given),
      "take FlexibleBody{body.data()}: a body has xi, a damping matrix or a loss factor, not two "
      "of them");
}

void require_no_values(const FlexibleBody::Spec& spec, const char* given) {
  if (spec.values.empty()) return;
  throw Error(Code::bad_modes, fmt::format("a body with values of its modes is given {}", given),
              "put their nominal values into its data: FlexibleBody{body.nominal()}");
}

double nominal_of(const Value& value) { return value.nominal(); }

/// Adds those of `before` whose entry is not among `entries`.
void keep_others(std::vector<ModeValues::Entry>& entries,
                 const std::vector<ModeValues::Entry>& before) {
  const std::vector<ModeValues::Entry> given = entries;
  for (const ModeValues::Entry& e : before)
    if (std::ranges::none_of(given, [&](const ModeValues::Entry& g) {
          return g.mode == e.mode && g.component == e.component;
        }))
      entries.push_back(e);
}

}  // namespace

Eigen::Index shapes_of_lines(const ModalData& d) {
  Eigen::Index count = 0;
  for (const ModalLine& line : d.lines) count += static_cast<Eigen::Index>(line.shapes.size());
  return count;
}

std::string channel_of(const ModalLine& line, const LineShape& shape) {
  return line.name + "." + to_string(shape);
}

MatrixXd modal_input(const ModalData& d) {
  const auto n = d.omega.size();
  Eigen::Index column = static_cast<Eigen::Index>(6 * d.children.size());
  MatrixXd W(n, column + shapes_of_lines(d) + 6);
  for (std::size_t i = 0; i < d.children.size(); ++i)
    if (n > 0) W.middleCols<6>(static_cast<Eigen::Index>(6 * i)) = d.children[i].Phi_C.transpose();
  for (const ModalLine& line : d.lines) {
    const auto count = static_cast<Eigen::Index>(line.shapes.size());
    if (n > 0) W.middleCols(column, count) = line.Phi.transpose();
    column += count;
  }
  if (n > 0) W.rightCols<6>() = -d.L_P;
  return W;
}

FlexibleBody::FlexibleBody(ModalData given, SourceLine at) {
  const auto data = std::make_shared<const ModalData>(std::move(given));
  told_at(at, [&] {
    detail::check_modal_data(*data);
    spec_ = std::make_shared<const Spec>(Spec{data});
    block_ = detail::flexible_body_block(spec_);
  });
}

FlexibleBody::FlexibleBody(const FlexibleBody& body, const ModeValues& values) {
  require_damped_by_xi(*body.spec_, "values of its modes");
  Spec spec{body.spec_->data, values};
  const ModeValues& before = body.spec_->values;
  spec.values.omega.insert(before.omega.begin(), before.omega.end());
  spec.values.xi.insert(before.xi.begin(), before.xi.end());
  keep_others(spec.values.L_P, before.L_P);
  for (const auto& [child, entries] : before.Phi_C) keep_others(spec.values.Phi_C[child], entries);
  spec_ = std::make_shared<const Spec>(std::move(spec));
  block_ = detail::flexible_body_block(spec_, body.block_);
}

FlexibleBody FlexibleBody::damped_by(const MatrixXd& Z) const {
  detail::check_damping(Z, data().omega.size());
  require_damped_by_xi(*spec_, "a damping matrix");
  require_no_values(*spec_, "a damping matrix");
  FlexibleBody result = *this;
  result.spec_ = std::make_shared<const Spec>(Spec{spec_->data, {}, (Z + Z.transpose()) / 2});
  result.block_ = detail::flexible_body_block(result.spec_, block_);
  return result;
}

FlexibleBody FlexibleBody::with_loss_factor(double eta) const {
  if (!(eta > 0) || !std::isfinite(eta))
    throw Error(Code::bad_value, fmt::format("a body is given the loss factor {}", eta),
                "give a number above 0: 0.01 is about 0.5 % of critical damping");
  require_damped_by_xi(*spec_, "a loss factor");
  require_no_values(*spec_, "a loss factor");
  FlexibleBody result = *this;
  result.spec_ = std::make_shared<const Spec>(Spec{spec_->data, {}, {}, eta});
  result.block_ = detail::flexible_body_block(result.spec_, block_);
  return result;
}

MatrixXd FlexibleBody::damping() const {
  if (spec_->loss_factor > 0) throw detail::no_state_space(spec_->loss_factor);
  if (spec_->damping.size() > 0) return spec_->damping;
  const auto m = detail::modes_with(data(), spec_->values, nominal_of);
  return MatrixXd((2 * m.xi.cwiseProduct(m.omega)).asDiagonal());
}

FlexibleBody::FlexibleBody(const Beam& beam, SourceLine at)
    : FlexibleBody(told_at(at, [&] { return modal_data(beam); }), at) {}
FlexibleBody::FlexibleBody(const RigidBody& body, SourceLine at)
    : FlexibleBody(told_at(at, [&] { return without_modes(body); }), at) {}

ModalData FlexibleBody::nominal() const {
  return detail::data_with(data(), spec_->values, nominal_of);
}

BlockPtr as_block(const FlexibleBody& body) {
  if (!body.spec().values.empty()) body.nominal();  // throws for invalid values
  return body.block();
}

}  // namespace titop
