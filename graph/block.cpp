#include <fmt/format.h>

#include <titop/graph/block.hpp>
#include <titop/graph/error.hpp>
#include <titop/graph/linalg/dense.hpp>

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

Block::Response Block::response(std::complex<double> s, ParameterValues values) const {
  const auto d = dynamics(values);
  const auto n = d->A.rows();
  if (n == 0) return {Eigen::MatrixXcd(0, d->D.cols()), d->D.cast<std::complex<double>>()};
  const Eigen::MatrixXcd E = s * Eigen::MatrixXcd::Identity(n, n) - d->A;
  const linalg::Solution x = linalg::solve(E, d->B.cast<std::complex<double>>());
  if (!(x.rcond > 0) || !x.z.allFinite())
    throw Error(Code::singular,
                fmt::format("a {} has a pole at s = {}{:+}j", type(), s.real(), s.imag()),
                "evaluate beside the pole");
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
