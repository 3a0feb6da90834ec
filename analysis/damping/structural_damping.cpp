#include <cmath>
#include <map>
#include <titop/analysis/damping/structural_damping.hpp>
#include <titop/blocks/flexible_body.hpp>
#include <titop/blocks/specified.hpp>
#include <titop/compiler/system/compile_graph.hpp>
#include <titop/compiler/system/system.hpp>
#include <titop/graph/pole.hpp>
#include <titop/graph/support/parallel.hpp>

/// Loss factors as viscous damping at one frequency.
namespace titop {
namespace {

using Eigen::MatrixXcd;

constexpr const char* kParameter = "1 / (2 omega) of loss factors";

/// The spec of a body with a loss factor, or none.
const FlexibleBody::Spec* lossy(const Block& block) {
  const auto* body = dynamic_cast<const Specified<FlexibleBody::Spec>*>(&block);
  return body && body->spec().loss_factor > 0 ? &body->spec() : nullptr;
}

/// The body with xi = eta omega_k times the parameter: at 1 / (2 omega) that is the viscous damping
/// 2 xi omega_k = eta omega_k^2 / omega.
BlockPtr viscous(const FlexibleBody::Spec& spec, const Param& parameter) {
  ModalData data = *spec.data;
  data.xi.setZero();
  ModeValues values;
  for (Eigen::Index k = 0; k < data.omega.size(); ++k)
    values.xi.emplace(static_cast<int>(k + 1), Value(spec.loss_factor * data.omega(k), parameter));
  return as_block(FlexibleBody(FlexibleBody(std::move(data)), values));
}

/// The diagram compiled with such bodies; `any`: there are some.
System viscous_system(const Diagram& diagram, bool& any) {
  Diagram d = diagram.clone();
  const Param parameter = d.param(kParameter, 0);
  Graph g = d.graph();
  std::map<const Block*, BlockPtr> made;
  for (Node& n : g.nodes)
    if (const FlexibleBody::Spec* spec = lossy(*n.block)) {
      BlockPtr& block = made[n.block.get()];
      if (!block) block = viscous(*spec, parameter);
      n.block = block;
    }
  any = !made.empty();
  return System(detail::compile_graph(any ? g : diagram.graph(), {.minimize_up_to = 0}));
}

}  // namespace

std::vector<MatrixXcd> frequency_response(const Diagram& diagram, std::span<const double> omega,
                                          int threads) {
  for (const double w : omega) check_finite({0, w}, diagram.name());
  bool any = false;
  const System system = viscous_system(diagram, any);
  if (!any) return system.frequency_response(omega, threads);
  std::vector<MatrixXcd> result(omega.size());
  detail::parallel(omega.size(), threads, [&] {
    return [&](std::size_t i) {
      const double w = std::abs(omega[i]);
      const System at_w = system.update({{kParameter, w > 0 ? 1 / (2 * w) : 0}});
      result[i] = at_w.transfer({0, w});
      if (omega[i] < 0) result[i] = result[i].conjugate().eval();
    };
  });
  return result;
}

}  // namespace titop
