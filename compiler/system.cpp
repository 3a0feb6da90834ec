#include <fmt/format.h>

#include <algorithm>
#include <numeric>
#include <titop/compiler/minimize.hpp>
#include <titop/compiler/system.hpp>
#include <titop/compiler/system_data.hpp>

namespace titop {

using Eigen::MatrixXcd;
using Eigen::MatrixXd;
using Eigen::VectorXd;

namespace {

std::size_t at(int i) { return static_cast<std::size_t>(i); }

template <class List>
std::vector<int> as_declared(const List& list) {
  std::vector<int> order(list.size());
  std::iota(order.begin(), order.end(), 0);
  std::sort(order.begin(), order.end(),
            [&](int a, int b) { return list[at(a)].declared < list[at(b)].declared; });
  return order;
}

/// "u", or "U(1)" ... "U(6)".
void add_names(std::vector<std::string>& names, const std::string& name, int size) {
  for (int i = 1; i <= size; ++i)
    names.push_back(size == 1 ? name : fmt::format("{}({})", name, i));
}

}  // namespace

namespace detail {

Layout make_layout(const Graph& g) {
  Layout l;
  l.state_first.assign(g.nodes.size(), -1);
  for (const int i : as_declared(g.nodes)) {
    const Node& node = g.nodes[at(i)];
    if (node.state < 0 || !g.signals[at(node.state)].active) continue;
    l.state_first[at(i)] = static_cast<int>(l.states.size());
    l.state_nodes.push_back(i);
    for (const std::string& s : node.block->interface().states)
      l.states.push_back(node.name + "." + s);
  }
  l.input_first.resize(g.inputs.size());
  for (const int i : as_declared(g.inputs)) {
    l.input_first[at(i)] = static_cast<int>(l.inputs.size());
    add_names(l.inputs, g.inputs[at(i)].name, g.inputs[at(i)].size);
  }
  l.output_first.resize(g.outputs.size());
  for (const int i : as_declared(g.outputs)) {
    l.output_first[at(i)] = static_cast<int>(l.outputs.size());
    add_names(l.outputs, g.outputs[at(i)].name, g.outputs[at(i)].size);
  }
  return l;
}

namespace {

/// Rows of a known signal: a state or an external input.
MatrixXd known(const SystemData& d, int signal, const MatrixXd& x, const MatrixXd& u) {
  const Signal& s = d.stage.graph.signals[at(signal)];
  return s.role == Signal::Role::state ? x.middleRows(d.layout.state_first[at(s.node)], s.size)
                                       : u.middleRows(d.layout.input_first[at(s.spec)], s.size);
}

}  // namespace

MatrixXd solve_unknowns(const SystemData& d, const MatrixXd& x, const MatrixXd& u) {
  std::vector<MatrixXd> rhs(d.joint.rows.size());
  for (std::size_t r = 0; r < rhs.size(); ++r)
    for (const auto& piece : d.numbers.rhs[r]) {
      if (rhs[r].size() == 0) rhs[r] = MatrixXd::Zero(piece.c.rows(), x.cols());
      rhs[r].noalias() += piece.c * known(d, piece.signal, x, u);
    }
  return d.factors->solve(rhs, x.cols());
}

MatrixXd signal_value(const SystemData& d, int signal, const MatrixXd& z, const MatrixXd& x,
                      const MatrixXd& u) {
  const Signal& s = d.stage.graph.signals[at(signal)];
  MatrixXd value = MatrixXd::Zero(s.size, x.cols());
  for (const auto& piece : d.joint.meaning[at(signal)]) {
    const int v = d.joint.variable_of[at(piece.signal)];
    if (v >= 0)
      value.noalias() += piece.c * z.middleRows(d.joint.plan.first[at(v)], piece.c.cols());
    else
      value.noalias() += piece.c * known(d, piece.signal, x, u);
  }
  return value;
}

namespace {

/// xdot and y for given states and inputs, column by column.
std::pair<MatrixXd, MatrixXd> rates(const SystemData& d, const MatrixXd& x, const MatrixXd& u) {
  const Graph& g = d.stage.graph;
  const MatrixXd z = solve_unknowns(d, x, u);
  MatrixXd xdot(x.rows(), x.cols());
  for (const int i : d.layout.state_nodes) {
    const Node& node = g.nodes[at(i)];
    const Dynamics& m = *d.blocks[at(i)];
    const int first = d.layout.state_first[at(i)];
    const auto n = m.A.rows();
    MatrixXd rows = m.A * x.middleRows(first, n);
    for (int s = node.first_signal; s < node.state; ++s)
      if (const Signal& in = g.signals[at(s)]; in.role == Signal::Role::input && in.active)
        rows.noalias() += m.B.middleCols(in.first, in.size) * signal_value(d, s, z, x, u);
    xdot.middleRows(first, n) = rows;
  }
  MatrixXd y = MatrixXd::Zero(static_cast<Eigen::Index>(d.layout.outputs.size()), x.cols());
  for (std::size_t o = 0; o < g.outputs.size(); ++o)
    for (const Term& t : g.outputs[o].terms)
      if (g.signals[at(t.signal)].active)
        y.middleRows(d.layout.output_first[o], g.outputs[o].size) +=
            *std::get<Matrix>(t.factors.front()).value * signal_value(d, t.signal, z, x, u);
  return {std::move(xdot), std::move(y)};
}

}  // namespace

StateSpace write_dense(const SystemData& d) {
  const auto n = static_cast<Eigen::Index>(d.layout.states.size());
  const auto m = static_cast<Eigen::Index>(d.layout.inputs.size());
  // Matrix products take columns in groups and sum the last, incomplete group in another order:
  // fill it up, so that a column does not depend on its place.
  const Eigen::Index columns = (n + m + 7) / 8 * 8;
  MatrixXd x = MatrixXd::Zero(n, columns), u = MatrixXd::Zero(m, columns);
  x.leftCols(n).setIdentity();
  u.middleCols(n, m).setIdentity();
  const auto [xdot, y] = rates(d, x, u);
  return {xdot.leftCols(n), xdot.middleCols(n, m), y.leftCols(n),   y.middleCols(n, m),
          d.layout.states,  d.layout.inputs,       d.layout.outputs};
}

Point solve_at(const SystemData& d, std::complex<double> s, const MatrixXcd& u) {
  const Graph& g = d.stage.graph;
  std::vector<Block::Response> responses(g.nodes.size());
  for (const Row& row : d.stage.rows)
    if (row.active && row.node >= 0 && responses[at(row.node)].Y.size() == 0)
      responses[at(row.node)] = g.nodes[at(row.node)].block->response(s, d.stage.values);
  for (const int i : d.layout.state_nodes)
    if (responses[at(i)].Y.size() == 0)
      responses[at(i)] = g.nodes[at(i)].block->response(s, d.stage.values);
  const auto numbers = solve::numbers(d.stage, d.joint, responses);
  const solve::Factors<std::complex<double>> factors(d.joint.plan, numbers.entries);
  if (factors.health().singular)
    throw Error(Code::singular,
                fmt::format("{} has a pole at s = {}{:+}j", g.name, s.real(), s.imag()),
                "evaluate beside it");
  const auto input = [&](int signal) {
    const Signal& sig = g.signals[at(signal)];
    return u.middleRows(d.layout.input_first[at(sig.spec)], sig.size);
  };
  std::vector<MatrixXcd> rhs(d.joint.rows.size());
  for (std::size_t r = 0; r < rhs.size(); ++r)
    for (const auto& piece : numbers.rhs[r]) {
      if (rhs[r].size() == 0) rhs[r] = MatrixXcd::Zero(piece.c.rows(), u.cols());
      rhs[r] += piece.c * input(piece.signal);
    }
  const MatrixXcd z = factors.solve(rhs, u.cols());
  Point point;
  point.signals.resize(g.signals.size());
  for (std::size_t sig = 0; sig < g.signals.size(); ++sig) {
    point.signals[sig] = MatrixXcd::Zero(g.signals[sig].size, u.cols());
    if (g.signals[sig].role == Signal::Role::state) continue;
    for (const auto& piece : d.joint.meaning[sig]) {
      const int v = d.joint.variable_of[at(piece.signal)];
      if (v >= 0)
        point.signals[sig] += piece.c * z.middleRows(d.joint.plan.first[at(v)], piece.c.cols());
      else
        point.signals[sig] += piece.c * input(piece.signal);
    }
  }
  for (const int i : d.layout.state_nodes) {
    const Node& node = g.nodes[at(i)];
    for (int in = node.first_signal; in < node.state; ++in)
      if (const Signal& port = g.signals[at(in)]; port.role == Signal::Role::input)
        point.signals[at(node.state)] +=
            responses[at(i)].X.middleCols(port.first, port.size) * point.signals[at(in)];
  }
  return point;
}

}  // namespace detail

int System::order() const { return static_cast<int>(data_->layout.states.size()); }
const std::vector<std::string>& System::states() const { return data_->layout.states; }
const std::vector<std::string>& System::inputs() const { return data_->layout.inputs; }
const std::vector<std::string>& System::outputs() const { return data_->layout.outputs; }
const Stage& System::stage() const { return data_->stage; }
const std::vector<Note>& System::notes() const { return data_->stage.notes; }

System::Rates System::apply(const VectorXd& x, const VectorXd& u) const {
  if (x.size() != order() || u.size() != static_cast<Eigen::Index>(inputs().size()))
    throw Error(Code::size, fmt::format("apply: x has {} entries, u has {}", x.size(), u.size()),
                fmt::format("x needs {}, u needs {}", order(), inputs().size()));
  auto [xdot, y] = detail::rates(*data_, x, u);
  return {std::move(xdot), std::move(y)};
}

MatrixXcd System::transfer(std::complex<double> s) const {
  const auto m = static_cast<Eigen::Index>(inputs().size());
  const detail::Point point = detail::solve_at(*data_, s, MatrixXcd::Identity(m, m));
  const Graph& g = data_->stage.graph;
  MatrixXcd G = MatrixXcd::Zero(static_cast<Eigen::Index>(outputs().size()), m);
  for (std::size_t o = 0; o < g.outputs.size(); ++o)
    for (const Term& t : g.outputs[o].terms)
      if (g.signals[at(t.signal)].active || g.signals[at(t.signal)].role == Signal::Role::external)
        G.middleRows(data_->layout.output_first[o], g.outputs[o].size) +=
            *std::get<Matrix>(t.factors.front()).value * point.signals[at(t.signal)];
  return G;
}

std::vector<MatrixXcd> System::frequency_response(std::span<const double> omega) const {
  std::vector<MatrixXcd> result;
  result.reserve(omega.size());
  for (const double w : omega) result.push_back(transfer({0, w}));
  return result;
}

MatrixXd System::static_gain() const {
  try {
    return transfer(0).real();
  } catch (const Error& error) {
    // A block may have a pole at 0 that the system has not: a hinge that its spring holds.
    if (!error.has(Code::singular)) throw;
    return state_space().transfer(0).real();
  }
}

namespace {

/// Minimizes the dense model, compares its transfer with the factors' at the certificate's s, and
/// keeps the full model where they part: nothing is removed on trust.
void minimize_checked(const System& system, const detail::SystemData& d, StateSpace& dense) {
  Minimized m = minimize(dense, {.resolution = d.options.resolution});
  for (std::string& text : m.notes)
    d.dense_notes.push_back({Note::Kind::removed, "minimize", std::move(text)});
  if (m.removed == 0) return;
  if (dense.inputs.empty() || dense.outputs.empty()) {
    dense = std::move(m.model);
    return;
  }
  const MatrixXcd G = system.transfer(d.certificate.s);
  const double size = G.cwiseAbs().maxCoeff();
  const double off = (m.model.transfer(d.certificate.s) - G).cwiseAbs().maxCoeff();
  const double allowed = std::max(1e-8, 10 * d.options.resolution);
  const bool keeps = off <= allowed * size;
  d.dense_notes.push_back(
      {keeps ? Note::Kind::info : Note::Kind::warning, "minimize",
       fmt::format("transfer changed by {:.1e} at the certificate's s{}",
                   size > 0 ? off / size : off,
                   keeps ? "" : ": more than allowed, so nothing was removed")});
  if (keeps) dense = std::move(m.model);
}

}  // namespace

const StateSpace& System::state_space() const {
  std::call_once(data_->dense_once, [&] {
    const detail::SystemData& d = *data_;
    StateSpace dense = detail::write_dense(d);
    d.dense_against_factors = detail::dense_difference(d, dense);
    if (dense.order() > 0 && dense.order() <= d.options.minimize_up_to) {
      minimize_checked(*this, d, dense);
    } else if (dense.order() > 0) {
      d.dense_notes.push_back(
          {Note::Kind::info, "minimize",
           fmt::format("not run: {} states are more than {} (Options::minimize_up_to)",
                       dense.order(), d.options.minimize_up_to)});
    }
    d.dense = std::move(dense);
  });
  return data_->dense;
}

std::vector<Pole> System::poles() const { return titop::poles(state_space()); }

Certificate System::certificate() const {
  Certificate c = data_->certificate;
  c.dense_against_factors = data_->dense_against_factors;
  return c;
}

std::string System::log() const {
  std::string text = fmt::format("{}: {} states, {} inputs, {} outputs\n", data_->written.name,
                                 order(), inputs().size(), outputs().size());
  for (const std::vector<Note>* list :
       {&data_->stage.notes, const_cast<const std::vector<Note>*>(&data_->dense_notes)})
    for (const Note& n : *list)
      text += fmt::format("  {:<9} {:<10} {}\n", n.pass, to_string(n.kind), n.text);
  return text;
}

std::string System::timings() const {
  std::string text;
  for (const auto& [pass, seconds] : data_->seconds)
    text += fmt::format("  {:<9} {:>10.1f} us\n", pass, 1e6 * seconds);
  return text;
}

}  // namespace titop
