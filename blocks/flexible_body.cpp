#include <titop/blocks/flexible_body_block.hpp>
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
    block_ = detail::flexible_body_block(spec_);
  });
}

FlexibleBody::FlexibleBody(const FlexibleBody& body, const ModeValues& values) {
  if (body.spec_->damping.size() > 0)
    throw Error(Code::bad_modes, "values are given for modes of a body that is damped by a matrix",
                "give the values to the body before, or change its data");
  Spec spec{body.spec_->data, values};
  spec.values.omega.insert(body.spec_->values.omega.begin(), body.spec_->values.omega.end());
  spec.values.xi.insert(body.spec_->values.xi.begin(), body.spec_->values.xi.end());
  spec_ = std::make_shared<const Spec>(std::move(spec));
  block_ = detail::flexible_body_block(spec_, body.block_);
}

FlexibleBody FlexibleBody::damped_by(const MatrixXd& Z) const {
  detail::check_damping(Z, data().omega.size());
  if (!spec_->values.empty())
    throw Error(Code::bad_modes, "a damping matrix is given to a body with values of its modes",
                "put their nominal values into its data: FlexibleBody{body.nominal()}");
  FlexibleBody result = *this;
  result.spec_ = std::make_shared<const Spec>(Spec{spec_->data, {}, (Z + Z.transpose()) / 2});
  result.block_ = detail::flexible_body_block(result.spec_, block_);
  return result;
}

MatrixXd FlexibleBody::damping() const {
  if (spec_->damping.size() > 0) return spec_->damping;
  const detail::ModalParameters m = detail::nominal_modes(*spec_);
  return MatrixXd((2 * m.xi.cwiseProduct(m.omega)).asDiagonal());
}

FlexibleBody::FlexibleBody(const Beam& beam, std::source_location at)
    : FlexibleBody(told_at(at, [&] { return modal_data(beam); }), at) {}
FlexibleBody::FlexibleBody(const RigidBody& body, std::source_location at)
    : FlexibleBody(told_at(at, [&] { return without_modes(body); }), at) {}

ModalData FlexibleBody::nominal() const {
  detail::ModalParameters m = detail::nominal_modes(*spec_);
  ModalData result = data();
  result.omega = std::move(m.omega);
  result.xi = std::move(m.xi);
  return result;
}

BlockPtr as_block(const FlexibleBody& body) {
  if (!body.spec().values.empty()) detail::nominal_modes(body.spec());  // throws for invalid values
  return body.block();
}

}  // namespace titop
