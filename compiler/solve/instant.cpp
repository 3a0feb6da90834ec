#include <titop/compiler/solve/instant.hpp>
#include <titop/compiler/solve/kernels.hpp>
#include <titop/compiler/solve/scalar.hpp>
#include <titop/graph/linalg/index.hpp>
#include <titop/graph/support/steady_random.hpp>

namespace titop::detail {
namespace {

using linalg::at;
using solve::Refinement;
using solve::RowMatrix;

}  // namespace

solve::JointRows<double> real_rows(const Skeleton& k, const solve::Numbers& numbers) {
  solve::Matrices<double> m;
  m.direct.reserve(numbers.blocks.size());
  m.output.reserve(numbers.blocks.size());
  for (const auto& block : numbers.blocks) {
    m.direct.push_back(&block->D);
    m.output.push_back(&block->C);
  }
  return {k.stage.graph, k.joint, numbers.coefficients, std::move(m)};
}

Instant::Instant(const Factored& data, RowMatrix<double> known, const RowMatrix<double>& more,
                 Refinement refinement)
    : data_(data),
      rows_(real_rows(*data.skeleton, data.numbers)),
      known_(std::move(known)),
      rhs_(rows_.rhs(known_, data.layout().known_first)) {
  if (more.size() > 0) rhs_ += more;
  unknowns_ = refinement == Refinement::none ? data.factors->solve(rhs_)
                                             : solve::settled(rows_, *data.factors, rhs_);
}

void Instant::add_value(int signal, double* to) const {
  rows_.add_value(signal, unknowns_, known_, data_.layout().known_first, to);
}

RowMatrix<double> Instant::values(std::span<const int> first) const {
  return rows_.values(unknowns_, known_, data_.layout().known_first, first);
}

template <class Add>
void Instant::products_of_xdot(Add add) const {
  const Graph& g = data_.graph();
  const Layout& l = data_.layout();
  RowMatrix<double> input;
  for (const int i : l.state_nodes) {
    const Node& node = g.nodes[at(i)];
    const Dynamics& m = *data_.numbers.blocks[at(i)];
    const Eigen::Index first = l.state_first[at(i)], n = m.A.rows();
    using Eigen::MatrixXd;
    add(first, Eigen::Map<const MatrixXd>(m.A.data(), n, n), known_.data() + first * known_.cols());
    for (int s = node.first_signal; s < node.state; ++s)
      if (const Signal& in = g.signals[at(s)]; in.role == Signal::Role::input && in.active) {
        input.setZero(in.size, known_.cols());
        add_value(s, input.data());
        add(first, Eigen::Map<const MatrixXd>(m.B.data() + in.first * n, n, in.size), input.data());
      }
  }
}

template <class Add>
void Instant::products_of_outputs(Add add) const {
  const Graph& g = data_.graph();
  RowMatrix<double> value;
  for (std::size_t o = 0; o < g.outputs.size(); ++o)
    for (std::size_t k = 0; k < g.outputs[o].terms.size(); ++k) {
      const int signal = g.outputs[o].terms[k].signal;
      value.setZero(g.signals[at(signal)].size, known_.cols());
      add_value(signal, value.data());
      add(data_.layout().output_first[o],
          *data_.numbers.coefficients[at(data_.skeleton->joint.output_coefficient[o]) + k], value);
    }
}

RowMatrix<double> Instant::xdot() const {
  RowMatrix<double> result = RowMatrix<double>::Zero(data_.layout().order(), known_.cols());
  products_of_xdot([&](Eigen::Index first, const auto& m, const double* x) {
    solve::add_dense_product(m.rows(), m.cols(), m.data(), x, known_.cols(),
                             result.data() + first * known_.cols());
  });
  return result;
}

RowMatrix<double> Instant::xdot_terms() const {
  RowMatrix<double> result = RowMatrix<double>::Zero(data_.layout().order(), known_.cols());
  products_of_xdot([&](Eigen::Index first, const auto& m, const double* x) {
    const Eigen::Map<const RowMatrix<double>> value(x, m.cols(), known_.cols());
    result.middleRows(first, m.rows()).noalias() += m.cwiseAbs() * value.cwiseAbs();
  });
  return result;
}

RowMatrix<double> Instant::outputs() const {
  RowMatrix<double> y = RowMatrix<double>::Zero(std::ssize(data_.layout().outputs), known_.cols());
  products_of_outputs([&](Eigen::Index first, const auto& m, const RowMatrix<double>& value) {
    y.middleRows(first, m.rows()).noalias() += m * value;
  });
  return y;
}

RowMatrix<double> Instant::outputs_terms() const {
  RowMatrix<double> y = RowMatrix<double>::Zero(std::ssize(data_.layout().outputs), known_.cols());
  products_of_outputs([&](Eigen::Index first, const auto& m, const RowMatrix<double>& value) {
    y.middleRows(first, m.rows()).noalias() += m.cwiseAbs() * value.cwiseAbs();
  });
  return y;
}

Instant Instant::doubt(int sample) const {
  RowMatrix<double> magnitudes, left = rows_.residual(rhs_, unknowns_, &magnitudes);
  return off_by(std::move(left), magnitudes, sample);
}

Instant Instant::doubt_of_vectors(int sample) const {
  RowMatrix<double> lengths = unknowns_.cwiseAbs(), magnitudes;
  const solve::Plan& plan = *data_.skeleton->joint.plan;
  for (std::size_t v = 0; v < plan.first.size(); ++v)
    for (int i = 0, n = plan.structure.variable_unit[v]; i < plan.structure.variable_size[v];
         i += n) {
      auto part = lengths.middleRows(plan.first[v] + i, n);
      part.rowwise() = part.colwise().maxCoeff().eval();
    }
  rows_.residual(rhs_, lengths, &magnitudes);
  return off_by(rows_.residual(rhs_, unknowns_, nullptr), magnitudes, sample);
}

Instant Instant::rounding() const {
  RowMatrix<double> magnitudes;
  rows_.residual(rhs_, unknowns_, &magnitudes);
  return off_by(RowMatrix<double>::Zero(magnitudes.rows(), magnitudes.cols()), magnitudes, 0);
}

Instant Instant::off_by(RowMatrix<double> off, const RowMatrix<double>& magnitudes,
                        int sample) const {
  SteadyRandom random(sample);
  for (Eigen::Index i = 0; i < off.rows(); ++i)  // one number for all columns, in whatever order
    off.row(i) += random.unit() * solve::Scalar<double>::epsilon() * magnitudes.row(i);
  Instant result(*this);
  result.known_.setZero();
  result.unknowns_ = data_.factors->solve(off);
  result.rhs_ = std::move(off);
  return result;
}

}  // namespace titop::detail
