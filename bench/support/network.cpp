#include "network.hpp"

#include <algorithm>
#include <exception>
#include <numeric>
#include <stdexcept>
#include <titop/graph/invert.hpp>
#include <titop/graph/linalg/index.hpp>

#include "support/triplets.hpp"

namespace titop_bench {

using Eigen::MatrixXd;
using titop::Signal;
using titop::StateSpace;

namespace {

using Pairs = std::vector<std::pair<int, int>>;
using titop::linalg::at;

class Export {
 public:
  explicit Export(const titop::Stage& stage) : stage_(stage), graph_(stage.graph) {
    const std::size_t signals = graph_.signals.size();
    equation_.assign(signals, -1);
    u_.assign(signals, -1), y_.assign(signals, -1), free_.assign(signals, -1);
    for (int e = 0; e < static_cast<int>(graph_.equations.size()); ++e)
      if (graph_.equations[at(e)].active && !graph_.equations[at(e)].of_block)
        equation_[at(graph_.equations[at(e)].target)] = e;
  }

  Network operator()() {
    std::vector<int> order(graph_.nodes.size());
    std::iota(order.begin(), order.end(), 0);
    std::sort(order.begin(), order.end(), [&](int i, int j) {
      return graph_.nodes[at(i)].declared < graph_.nodes[at(j)].declared;
    });
    for (const int i : order)
      if (is_block(i)) add_node(i);
    for (const int e : equation_)
      if (e >= 0) add_equation(graph_.equations[at(e)]);
    add_outputs();
    return result();
  }

 private:
  /// A hub of many ports is one too, and a sum or gain in an algebraic loop, whose inputs have
  /// equations of their own; others are in the equations.
  bool is_block(int node) const {
    const titop::Node& n = graph_.nodes[at(node)];
    bool in_loop = false;
    for (int s = n.first_signal; s < end_signal(graph_, node); ++s)
      in_loop = in_loop || (graph_.signals[at(s)].role == Signal::Role::input && driven(s));
    return in_loop || !n.lowered || !n.block->interface().channels.empty();
  }

  bool driven(int signal) const { return equation_[at(signal)] >= 0; }

  /// The signal across the channel.
  int other(int signal) const {
    const titop::Channel& c = graph_.channels[at(graph_.signals[at(signal)].channel)];
    return c.accel == signal ? c.force : c.accel;
  }

  /// Inputs of the node that are not driven, with the outputs that are: to be inverted.
  std::vector<int> inverted(int node) const {
    std::vector<int> list;
    for (int s = graph_.nodes[at(node)].first_signal; s < end_signal(graph_, node); ++s)
      if (graph_.signals[at(s)].role == Signal::Role::input && !driven(s) &&
          graph_.signals[at(s)].channel >= 0 && driven(other(s)))
        list.push_back(s);
    return list;
  }

  void add_node(int node) {
    const titop::Node& n = graph_.nodes[at(node)];
    const auto d = n.block->dynamics(stage_.values);
    StateSpace m{d->A, d->B, d->C, d->dense_direct(), {}, {}, {}};
    for (const int s : inverted(node))
      if (!invert_channel(m, s)) add_unit_gain(s);
    place_signals(node, m);
    if (n.state < 0 || !graph_.signals[at(n.state)].active) drop_states(m);
    add_block(m);
  }

  bool invert_channel(StateSpace& m, int s) {
    Pairs pairs;
    for (int k = 0; k < graph_.signals[at(s)].size; ++k)
      pairs.emplace_back(graph_.signals[at(s)].first + k, graph_.signals[at(other(s))].first + k);
    const MatrixXd D = m.D.block(pairs[0].second, pairs[0].first, graph_.signals[at(s)].size,
                                 graph_.signals[at(s)].size);
    if (D.isZero(0)) return false;
    m.states.assign(at(m.order()), "x");
    m.inputs.assign(static_cast<std::size_t>(m.B.cols()), "u");
    m.outputs.assign(static_cast<std::size_t>(m.C.rows()), "y");
    m = invert(m, pairs);
    swapped_.push_back(s);
    return true;
  }

  void add_unit_gain(int s) {
    const int size = graph_.signals[at(s)].size;
    free_[at(s)] = ny_;
    const StateSpace unit{MatrixXd(0, 0),
                          MatrixXd(0, size),
                          MatrixXd(size, 0),
                          MatrixXd::Identity(size, size),
                          {},
                          {},
                          {}};
    free_row_.emplace_back(s, nu_);
    add_block(unit);
  }

  /// Keeps the rows and columns that are in use and notes where they stand.
  void place_signals(int node, StateSpace& m) {
    std::vector<int> inputs, outputs;
    const auto take = [](std::vector<int>& list, const Signal& slot, int first, int& place) {
      place = first + static_cast<int>(list.size());
      for (int k = 0; k < slot.size; ++k) list.push_back(slot.first + k);
    };
    for (int s = graph_.nodes[at(node)].first_signal; s < end_signal(graph_, node); ++s) {
      const Signal& slot = graph_.signals[at(s)];
      const bool swap = slot.channel >= 0 && (is_swapped(s) || is_swapped(other(s)));
      const int owner = swap ? other(s) : s;
      if (slot.role == Signal::Role::input && (driven(owner) || free_[at(s)] >= 0))
        take(inputs, slot, nu_, u_[at(owner)]);
      if (slot.role == Signal::Role::output && (slot.row || swap))
        take(outputs, slot, ny_, y_[at(owner)]);
    }
    m.B = MatrixXd(m.B(Eigen::all, inputs));
    m.C = MatrixXd(m.C(outputs, Eigen::all));
    m.D = MatrixXd(m.D(outputs, inputs));
  }

  bool is_swapped(int s) const {
    return std::find(swapped_.rbegin(), swapped_.rend(), s) != swapped_.rend();
  }

  static void drop_states(StateSpace& m) {
    m.A.resize(0, 0);
    m.B.resize(0, m.D.cols());
    m.C.resize(m.D.rows(), 0);
  }

  void add_block(const StateSpace& m) {
    add(A_, m.A, nx_, nx_);
    add(B_, m.B, nx_, nu_);
    add(C_, m.C, ny_, nx_);
    add(D_, m.D, ny_, nu_);
    const auto nu = static_cast<int>(m.D.cols()), ny = static_cast<int>(m.D.rows());
    blocks_.push_back({m.order(), nu, ny});
    nx_ += m.order(), nu_ += nu, ny_ += ny;
  }

  void add_terms(const std::vector<titop::Term>& terms, int row, double sign, Triplets& on_y,
                 Triplets& on_w) {
    for (const titop::Term& t : terms) {
      const MatrixXd c = sign * coefficient(graph_, t, stage_.values);
      const int y = free_[at(t.signal)] >= 0 ? free_[at(t.signal)] : y_[at(t.signal)];
      if (graph_.signals[at(t.signal)].role == Signal::Role::external)
        add(on_w, c, row, 0);
      else if (y >= 0)
        add(on_y, c, row, y);
      else
        throw std::logic_error("a scene reads " + name_of(graph_, t.signal));
    }
  }

  void add_equation(const titop::Equation& e) {
    if (const int u = u_[at(e.target)]; u >= 0) return add_terms(e.terms, u, 1, K_, E_);
    for (const auto& [input, row] : free_row_) {
      if (other(input) != e.target) continue;
      const int size = graph_.signals[at(input)].size;
      const MatrixXd I = MatrixXd::Identity(size, size);
      add(K_, I, u_[at(input)], free_[at(input)]);
      add(K_, I, row, free_[at(input)]);
      add(K_, I, row, y_[at(e.target)]);
      return add_terms(e.terms, row, -1, K_, E_);
    }
    throw std::logic_error("a scene drives " + name_of(graph_, e.target));
  }

  void add_outputs() {
    if (graph_.inputs.size() != 1 || graph_.outputs.size() != 1)
      throw std::logic_error("a scene has one input and one output");
    nw_ = graph_.inputs[0].size, nz_ = graph_.outputs[0].size;
    add_terms(graph_.outputs[0].terms, 0, 1, F_, G_);
  }

  Network result() const {
    return {sparse(A_, nx_, nx_), sparse(B_, nx_, nu_), sparse(C_, ny_, nx_),
            sparse(D_, ny_, nu_), sparse(K_, nu_, ny_), sparse(E_, nu_, nw_),
            sparse(F_, nz_, ny_), sparse(G_, nz_, nw_), blocks_};
  }

  const titop::Stage& stage_;
  const titop::Graph& graph_;
  std::vector<int> equation_;                  ///< of each signal, -1: not driven
  std::vector<int> u_, y_;                     ///< of each signal: first row of u, of y
  std::vector<int> free_;                      ///< of each input: first row of its unit gain in y
  std::vector<std::pair<int, int>> free_row_;  ///< such inputs, and the gain's first row in u
  std::vector<int> swapped_;                   ///< inputs whose channel is inverted
  std::vector<std::array<int, 3>> blocks_;
  Triplets A_, B_, C_, D_, K_, E_, F_, G_;
  int nx_ = 0, nu_ = 0, ny_ = 0, nw_ = 0, nz_ = 0;
};

}  // namespace

Network network_of(const titop::System& system) { return Export(system.stage())(); }

std::optional<Network> network_if_any(const titop::System& system) {
  try {
    return network_of(system);
  } catch (const std::exception&) {
    return std::nullopt;
  }
}

}  // namespace titop_bench
