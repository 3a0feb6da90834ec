#include <algorithm>
#include <map>
#include <titop/compiler/passes/check/checker.hpp>
#include <titop/graph/linalg/eigen.hpp>
#include <titop/graph/linalg/index.hpp>
#include <titop/graph/linalg/rounding.hpp>
#include <titop/graph/support/some_names.hpp>
#include <utility>

namespace titop::passes {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using linalg::at;

/// In how many directions no mode of these moves the point; Phi: 6 columns, a row per mode.
int still_directions(MatrixXd Phi) {
  for (const Index half : {Index{0}, Index{3}}) {
    const double largest = Phi.middleCols<3>(half).colwise().norm().maxCoeff();
    for (Index i = half; i < half + 3; ++i) {
      const double norm = Phi.col(i).norm();
      Phi.col(i) *= norm > linalg::kTextDigits * largest ? 1 / norm : 0;
    }
  }
  Eigen::ColPivHouseholderQR<MatrixXd> qr(Phi);
  qr.setThreshold(linalg::kTextDigits);
  return static_cast<int>(6 - qr.rank());
}

class StiffPoints {
 public:
  StiffPoints(const Graph& g, ParameterValues values) : g_(g), values_(values) {}

  /// Number of rigid directions of this channel, if a body moves with it; 0 if it is no child point
  /// of one with modes.
  int still(int channel) {
    const Channel& c = g_.channels[at(channel)];
    if (c.takes != Takes::force) return 0;
    const auto [known, is_new] = still_.try_emplace({block(c), c.spec}, 0);
    if (!is_new) return known->second;
    if (block(c) != last_) last_ = block(c), modes_ = last_->dynamics(values_)->modes;
    if (modes_ && modes_->W.rows() > 0)
      known->second = still_directions(modes_->W.middleCols<6>(g_.signals[at(c.force)].first));
    return known->second;
  }

  /// Joints and springs have none: they move with a point along some axes only.
  bool has_mass(int channel) {
    const int i = g_.channels[at(channel)].node;
    const auto [known, is_new] = has_mass_.try_emplace(i, false);
    if (is_new) known->second = has_mass(g_.nodes[at(i)]);
    return known->second;
  }

 private:
  bool has_mass(const Node& node) const {
    const auto& specs = node.block->interface().channels;
    const auto parent = std::find_if(specs.begin(), specs.end(), [](const ChannelSpec& s) {
      return s.size == 6 && s.takes == Takes::accel;
    });
    if (parent == specs.end()) return false;
    const Channel& c =
        g_.channels[at(node.first_channel + static_cast<int>(parent - specs.begin()))];
    const int row = g_.signals[at(c.force)].first, column = g_.signals[at(c.accel)].first;
    const auto d = node.block->dynamics(values_);
    return !(d->modes ? MatrixXd(d->modes->rigid.block<6, 6>(row, column))
                      : d->direct(row, column, 6, 6))
                .isZero(0);
  }
  const Block* block(const Channel& c) const { return g_.nodes[at(c.node)].block.get(); }

  const Graph& g_;
  ParameterValues values_;
  std::map<std::pair<const Block*, int>, int> still_;
  std::map<int, bool> has_mass_;
  const Block* last_ = nullptr;  ///< whose modes these are: a hub has many points
  std::shared_ptr<const Modal> modes_;
};

/// The point whose whole motion this equation gives to another point's; -1 if it is none.
int moves_with(const Graph& g, const Equation& e) {
  const Signal& target = g.signals[at(e.target)];
  if (target.quantity != Quantity::acceleration || target.size != 6 || !e.part.whole() ||
      e.terms.size() != 1)
    return -1;
  const Term& t = e.terms.front();
  const Signal& s = g.signals[at(t.signal)];
  const bool whole = std::all_of(t.factors.begin(), t.factors.end(), [](const Factor& f) {
    return std::holds_alternative<Rotation>(f);
  });
  return whole && t.of == Term::Of::signal && s.channel >= 0 && s.quantity == target.quantity
             ? s.channel
             : -1;
}

}  // namespace

void note_stiff_points(Checker& c, ParameterValues values) {
  const Graph& g = c.graph;
  StiffPoints points(g, values);
  std::map<int, std::string> found;  // by channel, each once
  for (const Equation& e : g.equations) {
    const int site = moves_with(g, e), point = g.signals[at(e.target)].channel;
    if (site < 0) continue;
    for (const int p : {site, point})
      if (const int still = points.still(p);
          still > 0 && points.has_mass(site) && points.has_mass(point))
        found[p] = fmt::format("{} ({} of 6)", channel_name(g, p), still);
  }
  if (found.empty()) return;
  std::vector<std::string> names;
  for (auto& [channel, name] : found) names.push_back(std::move(name));
  c.notes.push_back(
      {Note::Kind::info, "check",
       fmt::format("no mode moves these points, on which bodies are mounted, in some directions: "
                   "{}; residual vectors or more modes make them flexible there",
                   detail::some_names(names))});
}

}  // namespace titop::passes
