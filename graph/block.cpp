#include <fmt/format.h>

#include <algorithm>
#include <titop/graph/block.hpp>
#include <titop/graph/linalg/dense.hpp>
#include <titop/graph/pole.hpp>

namespace titop {

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
  return {x.z, d->C * x.z + d->D};
}

Pattern Block::feedthrough() const {
  return Pattern::Constant(interface().output_size(), interface().input_size(), true);
}

Pattern Block::moved_by() const { return Pattern::Constant(1, interface().input_size(), true); }

Pattern Block::seen_by() const { return Pattern::Constant(interface().output_size(), 1, true); }

std::optional<Block::Cause> Block::why_singular(int, ParameterValues) const { return std::nullopt; }

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
