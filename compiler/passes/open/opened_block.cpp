#include <fmt/format.h>

#include <algorithm>
#include <numeric>
#include <titop/compiler/passes/open/differences.hpp>
#include <titop/compiler/passes/open/opened_block.hpp>

namespace titop::passes {
namespace {

using Eigen::Index;

class OpenedBlock : public Block {
 public:
  OpenedBlock(BlockPtr block, const std::vector<ParameterPorts>& ports, bool differences)
      : block_(std::move(block)), face_(block_->interface()), differences_(differences) {
    for (const ParameterPorts& p : ports) {
      face_.inputs.push_back({fmt::format("w{}", p.parameter), p.size});
      face_.outputs.push_back({fmt::format("z{}", p.parameter), p.size});
      parameters_.push_back(p.parameter);
      more_ += p.size;
    }
  }
  std::string_view type() const override { return block_->type(); }
  const Interface& interface() const override { return face_; }
  /// The pairs in the order of the ports.
  std::shared_ptr<const Dynamics> dynamics(ParameterValues values) const override {
    const Opened o = *opened_to_first_order(*block_, values, parameters_, differences_);
    const Dynamics& from = o.dynamics;
    std::vector<Index> cols(static_cast<std::size_t>(from.B.cols() - more_)),
        rows(static_cast<std::size_t>(from.C.rows() - more_));
    std::iota(cols.begin(), cols.end(), 0);
    std::iota(rows.begin(), rows.end(), 0);
    for (const int p : parameters_)
      for (std::size_t k = 0; k < o.parameter.size(); ++k) {
        if (o.parameter[k] != p) continue;
        cols.push_back(from.B.cols() - more_ + static_cast<Index>(k));
        rows.push_back(from.C.rows() - more_ + static_cast<Index>(k));
      }
    return std::make_shared<Dynamics>(
        Dynamics{from.A, from.B(Eigen::all, cols), from.C(rows, Eigen::all), from.D(rows, cols)});
  }
  Pattern feedthrough() const override { return grown(block_->feedthrough(), more_, more_); }
  Pattern moved_by() const override { return grown(block_->moved_by(), 0, more_); }
  Pattern seen_by() const override { return grown(block_->seen_by(), more_, 0); }
  std::optional<Kinematics> kinematics(ParameterValues values) const override {
    std::optional<Kinematics> k = block_->kinematics(values);
    if (!k) return k;
    const auto opened = block_->opened(values, parameters_);
    if (!opened) return k;
    const Opened& o = *opened;
    k->opened = o.motions;
    for (OpenedMotion& m : k->opened) {
      const int p = o.parameter[static_cast<std::size_t>(m.pair)];
      m.port = static_cast<int>(
          face_.inputs.size() - parameters_.size() +
          static_cast<std::size_t>(std::find(parameters_.begin(), parameters_.end(), p) -
                                   parameters_.begin()));
    }
    return k;
  }
  std::vector<Value> values() const override { return block_->values(); }
  bool is_algebraic() const override { return block_->is_algebraic(); }
  bool has_frame() const override { return block_->has_frame(); }
  std::optional<Cause> why_singular(int channel, ParameterValues values) const override {
    return block_->why_singular(channel, values);
  }

 private:
  /// w may act on everything, and z may depend on it.
  static Pattern grown(const Pattern& p, Index rows, Index cols) {
    Pattern result = Pattern::Constant(p.rows() + rows, p.cols() + cols, true);
    result.topLeftCorner(p.rows(), p.cols()) = p;
    return result;
  }

  BlockPtr block_;
  Interface face_;
  bool differences_;
  std::vector<int> parameters_;
  Index more_ = 0;
};

}  // namespace

BlockPtr opened_block(BlockPtr block, const std::vector<ParameterPorts>& ports, bool differences) {
  return std::make_shared<OpenedBlock>(std::move(block), ports, differences);
}

std::vector<ParameterPorts> opened_ports(const Block& block, ParameterValues values,
                                         std::span<const int> parameters, bool differences) {
  const auto opened = opened_to_first_order(block, values, parameters, differences);
  std::vector<ParameterPorts> ports;
  for (const int p : parameters)
    if (const auto n =
            opened ? std::count(opened->parameter.begin(), opened->parameter.end(), p) : 0;
        n > 0)
      ports.push_back({p, static_cast<int>(n)});
  return ports;
}

}  // namespace titop::passes
