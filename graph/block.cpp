#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <titop/graph/block.hpp>
#include <titop/graph/linalg/dense.hpp>
#include <titop/graph/paths.hpp>
#include <titop/graph/pole.hpp>
#include <unordered_set>

namespace titop {

bool is_outward(const ChannelSpec& channel) {
  return channel.takes == Takes::accel && channel.name != "child";
}

int Interface::input_size() const {
  int n = 0;
  for (const ChannelSpec& c : channels) n += c.size;
  for (const PortSpec& p : inputs) n += p.size;
  return n;
}

int Interface::output_size() const {
  int n = 0;
  for (const ChannelSpec& c : channels) n += c.size;
  for (const PortSpec& p : outputs) n += p.size;
  return n;
}

int Interface::find_channel(std::string_view name) const {
  const auto name_at = [&](int i) -> std::string_view {
    return channels[static_cast<std::size_t>(i)].name;
  };
  if (by_name.empty()) {
    for (int i = 0; i < static_cast<int>(channels.size()); ++i)
      if (name_at(i) == name) return i;
    return -1;
  }
  const auto found = std::lower_bound(by_name.begin(), by_name.end(), name,
                                      [&](int i, std::string_view n) { return name_at(i) < n; });
  return found != by_name.end() && name_at(*found) == name ? *found : -1;
}

std::vector<int> rates_follow(int n) {
  std::vector<int> rates(static_cast<std::size_t>(2 * n), -1);
  std::iota(rates.begin(), rates.begin() + n, n);
  return rates;
}

std::span<const Gains> Dynamics::gains_of_row(int row) const {
  const auto begin = std::partition_point(sparse.begin(), sparse.end(),
                                          [&](const Gains& g) { return g.row < row; });
  const auto end = std::find_if(begin, sparse.end(), [&](const Gains& g) { return g.row != row; });
  return {begin, end};
}

Eigen::MatrixXd Dynamics::direct(int row, int col, int rows, int cols) const {
  if (sparse.empty()) return D.block(row, col, rows, cols);
  for (const Gains& g : gains_of_row(row))
    if (g.column == col) return g.gain;
  return Eigen::MatrixXd::Zero(rows, cols);
}

Eigen::MatrixXd Dynamics::dense_direct() const {
  if (sparse.empty()) return D;
  Eigen::MatrixXd result = Eigen::MatrixXd::Zero(C.rows(), B.cols());
  for (const Gains& g : sparse)
    result.block(g.row, g.column, g.gain.rows(), g.gain.cols()) = g.gain;
  return result;
}

Block::Response Block::response(std::complex<double> s, ParameterValues values) const {
  const auto d = dynamics(values);
  const auto n = d->A.rows();
  if (n == 0)
    return {Eigen::MatrixXcd(0, d->B.cols()), d->dense_direct().cast<std::complex<double>>()};
  const Eigen::MatrixXcd E = s * Eigen::MatrixXcd::Identity(n, n) - d->A;
  const linalg::Solution x = linalg::solve(E, d->B.cast<std::complex<double>>());
  if (!(x.rcond > 0) || !x.z.allFinite()) throw pole_at(s, fmt::format("a {}", type()));
  const Eigen::MatrixXcd X = x.z.cwiseProduct(paths(d->A, d->B));
  return {X, d->C * X + d->D};
}

Pattern Block::feedthrough() const {
  return Pattern::Constant(interface().output_size(), interface().input_size(), true);
}

Pattern Block::moved_by() const { return Pattern::Constant(1, interface().input_size(), true); }

Pattern Block::seen_by() const { return Pattern::Constant(interface().output_size(), 1, true); }

Eigen::VectorXd stiffness_of(const Block& block, const Dynamics& d, ParameterValues values) {
  const auto kinematics = block.kinematics(values);
  if (kinematics && kinematics->stiffness.size() == d.A.rows()) return kinematics->stiffness;
  Eigen::VectorXd result = Eigen::VectorXd::Zero(d.A.rows());
  for (int i = 0; i < result.size(); ++i)
    if (const int rate = block.interface().rate_of(i); rate >= 0) result(i) = -d.A(rate, i);
  return result;
}

std::optional<Block::Cause> Block::why_singular(int, ParameterValues) const { return std::nullopt; }

namespace {

using Eigen::Index;
using Eigen::MatrixXd;

/// Collects the mistakes in the matrices of one block.
class Inspection {
 public:
  explicit Inspection(const Block& block) : block_(block) {}

  /// False if the matrix has another size.
  bool sized(const MatrixXd& m, const char* name, Index rows, Index columns) {
    if (m.rows() == rows && m.cols() == columns) return true;
    mistakes.push_back({Code::size,
                        fmt::format("{} of this {} is {} x {}, not {} x {}", name, block_.type(),
                                    m.rows(), m.cols(), rows, columns),
                        {},
                        "its interface() has so many states, inputs and outputs: all of u and y, "
                        "channel by channel and port by port"});
    return false;
  }

  void finite(const MatrixXd& m, const char* name) {
    if (m.sum() * 0 == 0 || m.allFinite()) return;  // fast: a non-finite term stays in a sum
    for (Index i = 0; i < m.rows(); ++i)
      for (Index j = 0; j < m.cols(); ++j)
        if (!std::isfinite(m(i, j))) {
          mistakes.push_back({Code::not_finite,
                              fmt::format("{}({}, {}) of this {} is {}, counted from 0", name, i, j,
                                          block_.type(), m(i, j)),
                              {},
                              "look at the numbers that its dynamics() takes"});
          return;
        }
  }

  void whole(const MatrixXd& m, const char* name, Index rows, Index columns) {
    if (sized(m, name, rows, columns)) finite(m, name);
  }

  /// Each coordinate moves with its rate alone.
  void coordinates(const Dynamics& d) {
    for (Index i = 0; i < d.A.rows(); ++i) {
      const int rate = block_.interface().rate_of(static_cast<int>(i));
      if (rate < 0 ||
          (d.A.row(i).cwiseAbs().sum() == 1 && d.A(i, rate) == 1 && d.B.row(i).isZero(0)))
        continue;
      const std::vector<std::string>& states = block_.interface().states;
      mistakes.push_back(
          {Code::bad_value,
           fmt::format("{} of this {} moves with more than its rate {}",
                       states[static_cast<std::size_t>(i)], block_.type(),
                       states[static_cast<std::size_t>(rate)]),
           {},
           "its row of A has a 1 at its rate, all others and its row of B are 0; or its "
           "interface() declares no rate for it"});
    }
  }

  std::vector<Mistake> mistakes;

 private:
  const Block& block_;
};

}  // namespace

std::vector<Mistake> mistakes_of(const Interface& interface, std::string_view type) {
  std::vector<Mistake> mistakes;
  std::unordered_set<std::string_view> seen;
  for (const std::string& state : interface.states)
    if (!seen.insert(state).second)
      mistakes.push_back({Code::duplicate_name,
                          fmt::format("two states of this {} are called {}", type, state),
                          {},
                          "give every state in its interface() a name of its own"});
  const auto n = interface.states.size();
  bool fits = interface.rates.empty() || interface.rates.size() == n;
  for (const int rate : interface.rates) fits = fits && rate >= -1 && rate < static_cast<int>(n);
  if (!fits)
    mistakes.push_back({Code::bad_value,
                        fmt::format("the rates of this {} are not those of its {} states", type, n),
                        {},
                        "give one number per state: the index of its rate, or -1"});
  return mistakes;
}

std::vector<Mistake> mistakes_of(const Block& block, const Dynamics& d) {
  const Index n = static_cast<Index>(block.interface().states.size());
  const Index nu = block.interface().input_size(), ny = block.interface().output_size();
  Inspection look(block);
  if (d.modal) {  // A has only the numbers of its modes
    look.sized(d.A, "A", n, n), look.sized(d.B, "B", n, nu);
    look.sized(d.C, "C", ny, n), look.sized(d.D, "D", ny, nu);
    look.whole(d.modal->W, "W", n / 2, nu);
    look.whole(d.modal->rigid, "rigid", ny, nu);
    look.whole(d.modal->stiffness, "stiffness", n / 2, 1);
    look.whole(d.modal->damping, "damping", n / 2, 1);
    return std::move(look.mistakes);
  }
  look.whole(d.A, "A", n, n), look.whole(d.B, "B", n, nu), look.whole(d.C, "C", ny, n);
  if (d.sparse.empty()) look.whole(d.D, "D", ny, nu);
  for (const Gains& g : d.sparse) look.finite(g.gain, "a block of D");
  if (look.mistakes.empty()) look.coordinates(d);
  return std::move(look.mistakes);
}

std::string_view to_string(Quantity quantity) {
  switch (quantity) {
    case Quantity::plain: return "plain signal";
    case Quantity::acceleration: return "acceleration";
    case Quantity::velocity: return "velocity";
    case Quantity::position: return "position";
    case Quantity::force: return "force";
  }
  return "signal";
}

}  // namespace titop
