#include <optional>
#include <titop/graph/diagram_of_model.hpp>
#include <titop/graph/linalg/index.hpp>
#include <titop/graph/nodes/lti.hpp>

namespace titop {

Diagram diagram_of_model(const StateSpace& m, const std::string& name) {
  require_fitting(m, "diagram_of_model");
  require_names(m, "diagram_of_model");
  Diagram d{name};
  const auto model = d.add("model", Lti{.A = m.A, .B = m.B, .C = m.C, .D = m.D});
  const auto part = [](Eigen::Index size, Eigen::Index i) -> Eigen::MatrixXd {
    return Eigen::MatrixXd::Identity(size, size).col(i);
  };
  const Eigen::Index in = m.B.cols(), out = m.C.rows();
  std::optional<Expr> driven;
  for (Eigen::Index i = 0; i < in; ++i) {
    Expr term = part(in, i) * d.input(m.inputs[linalg::at(i)]);
    driven = driven ? *driven + term : std::move(term);
  }
  if (driven) model.in = *driven;
  for (Eigen::Index i = 0; i < out; ++i)
    d.output(m.outputs[linalg::at(i)]) = Eigen::MatrixXd(part(out, i).transpose()) * model.out;
  return d;
}

}  // namespace titop
