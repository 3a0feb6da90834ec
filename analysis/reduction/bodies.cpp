#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>
#include <titop/analysis/reduction/bodies.hpp>
#include <titop/analysis/reduction/oscillators.hpp>
#include <titop/analysis/reduction/remove_signals.hpp>
#include <titop/analysis/reduction/small.hpp>
#include <titop/graph/linalg/eigen.hpp>
#include <titop/graph/linalg/index.hpp>
#include <titop/graph/linalg/rounding.hpp>
#include <titop/graph/modal_form.hpp>

namespace titop::detail {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

using linalg::at;

/// A body in fewer coordinates: eta = V eta_r.
class FewerModes final : public Block {
 public:
  FewerModes(BlockPtr body, const Modal& m, const MatrixXd& V, const VectorXd& stiffness)
      : body_(std::move(body)), V_(V) {
    const auto r = static_cast<int>(V.cols());
    face_ = body_->interface();
    face_.states.clear();
    for (const char* name : {"eta{}", "etad{}"})
      for (int j = 1; j <= r; ++j) face_.states.push_back(fmt::format(fmt::runtime(name), j));
    face_.rates = rates_follow(r);
    const VectorXd damping = (V.transpose() * m.damping.asDiagonal() * V).diagonal();
    modal_ = {V.transpose() * m.W, m.rigid, stiffness, damping};
    matrices_ = modal_dynamics(modal_);
  }
  std::string_view type() const override { return body_->type(); }
  const Interface& interface() const override { return face_; }
  std::shared_ptr<const Dynamics> dynamics(ParameterValues) const override { return matrices_; }
  Response response(std::complex<double> s, ParameterValues) const override {
    return modal_response(modal_, s, type());
  }
  std::optional<Kinematics> kinematics(ParameterValues values) const override {
    std::optional<Kinematics> k = body_->kinematics(values);
    if (!k) return k;
    for (MatrixXd& Phi : k->Phi) {
      MatrixXd fewer(Phi.rows(), 2 * V_.cols());
      fewer << Phi.leftCols(V_.rows()) * V_, Phi.rightCols(V_.rows()) * V_;
      Phi = std::move(fewer);
    }
    return k;
  }
  Pattern feedthrough() const override { return body_->feedthrough(); }
  Pattern moved_by() const override { return body_->moved_by(); }
  Pattern seen_by() const override { return body_->seen_by(); }
  bool has_frame() const override { return body_->has_frame(); }

 private:
  BlockPtr body_;
  MatrixXd V_;
  Interface face_;
  Modal modal_;
  std::shared_ptr<const Dynamics> matrices_;
};

/// All nodes of one block, and the effects of its modes in all of them.
struct Shared {
  BlockPtr block;
  BlockModes modes;
  std::vector<int> nodes;
  VectorXd cut, corrected;
  std::vector<char> ports, kept;
};

std::vector<Shared> by_block(const Graph& g, const std::vector<ModeEffects>& effects) {
  std::vector<Shared> list;
  std::map<const Block*, std::size_t> place;
  const std::vector<double> values = nominal_values(g);
  for (const ModeEffects& e : effects) {
    const BlockPtr& block = g.nodes[at(e.node)].block;
    const auto [found, fresh] = place.emplace(block.get(), list.size());
    if (fresh) {
      const VectorXd none = VectorXd::Zero(e.cut.size());
      list.push_back({block,
                      *modes_of(*block, values),
                      {},
                      none,
                      none,
                      std::vector<char>(e.ports.size(), 0),
                      std::vector<char>(at(none.size()), 0)});
    }
    Shared& s = list[found->second];
    s.nodes.push_back(e.node);
    s.cut += e.cut;
    s.corrected += e.corrected;
    for (std::size_t p = 0; p < e.ports.size(); ++p) s.ports[p] |= e.ports[p];
  }
  return list;
}

/// Modes of one body that stay or go together.
struct ModeGroup {
  std::size_t body = 0;
  std::vector<Index> modes;
  double effect = 0;
};

std::vector<ModeGroup> groups(const std::vector<Shared>& bodies) {
  std::vector<ModeGroup> list;
  for (std::size_t b = 0; b < bodies.size(); ++b) {
    const VectorXd& k = bodies[b].modes.stiffness;
    std::vector<Index> order;
    for (Index j = 0; j < k.size(); ++j) order.push_back(j);
    std::stable_sort(order.begin(), order.end(), [&](Index i, Index j) { return k(i) < k(j); });
    for (std::size_t i = 0; i < order.size(); ++i) {
      const Index j = order[i];
      if (i == 0 || k(j) - k(order[i - 1]) > 2 * linalg::kSameFrequency * k(j))
        list.push_back({b, {}, 0});
      list.back().modes.push_back(j);
      list.back().effect += bodies[b].corrected(j);
    }
  }
  return list;
}

/// Marks the modes that stay: the rest is worth `share` or less.
void keep(std::vector<Shared>& bodies, double share) {
  std::vector<ModeGroup> list = groups(bodies);
  std::stable_sort(list.begin(), list.end(),
                   [](const ModeGroup& a, const ModeGroup& b) { return a.effect < b.effect; });
  double sum = 0;
  for (const ModeGroup& g : list) {
    sum += g.effect;
    if (sum <= share) continue;
    for (const Index j : g.modes) bodies[g.body].kept[at(j)] = 1;
  }
}

/// Static vectors of the modes that go, orthonormal, in those modes.
MatrixXd static_vectors(const Shared& body, const std::vector<Index>& gone) {
  std::vector<std::size_t> ports;
  for (std::size_t p = 0; p < body.ports.size(); ++p)
    if (body.ports[p]) ports.push_back(p);
  MatrixXd S(std::ssize(gone), std::ssize(ports));
  for (Index p = 0; p < S.cols(); ++p) S.col(p) = body.modes.ports[ports[at(p)]].column(gone);
  const VectorXd k = body.modes.stiffness(gone);
  S.array().colwise() /= k.array();
  Index used = 0;
  for (Index p = 0; p < S.cols(); ++p)
    if (const double size = S.col(p).norm(); size > 0) S.col(used++) = S.col(p) / size;
  if (used == 0) return MatrixXd(S.rows(), 0);
  const Eigen::JacobiSVD<MatrixXd> svd(S.leftCols(used), Eigen::ComputeThinU);
  const VectorXd& sigma = svd.singularValues();
  Index rank = 0;
  while (rank < sigma.size() && sigma(rank) > linalg::kInSpan * sigma(0)) ++rank;
  return svd.matrixU().leftCols(rank);
}

/// The coordinates that a body keeps, with their stiffnesses.
struct BodyBasis {
  MatrixXd V;
  VectorXd stiffness;
  Index vectors = 0;
};

/// None if nothing would be saved.
std::optional<BodyBasis> basis(const Shared& body, double share) {
  std::vector<Index> kept, gone;
  for (Index j = 0; j < body.cut.size(); ++j) (body.kept[at(j)] ? kept : gone).push_back(j);
  const auto n = static_cast<Index>(kept.size());
  MatrixXd S(static_cast<Index>(gone.size()), 0);
  if (n > 0 || body.cut.sum() > share) S = static_vectors(body, gone);
  if (S.cols() >= S.rows()) return std::nullopt;
  BodyBasis b{MatrixXd::Zero(body.cut.size(), n + S.cols()), VectorXd(n + S.cols()), S.cols()};
  for (Index i = 0; i < n; ++i) {
    b.V(kept[at(i)], i) = 1;
    b.stiffness(i) = body.modes.stiffness(kept[at(i)]);
  }
  if (S.cols() > 0) {
    const SymmetricModes own = ritz(body.modes.stiffness(gone), S);
    b.V(gone, Eigen::seqN(n, S.cols())) = S * own.V;
    b.stiffness.tail(S.cols()) = own.lambda;
  }
  return b;
}

BlockPtr in_fewer_modes(const BlockPtr& block, const BodyBasis& b, ParameterValues values) {
  if (const std::optional<Oscillators> o = oscillators(*block))
    return lti_of(projected(*o, b.V, b.stiffness));
  return std::make_shared<const FewerModes>(block, *block->dynamics(values)->modal, b.V,
                                            b.stiffness);
}

std::string told(const Graph& g, const Shared& body, const std::optional<BodyBasis>& b) {
  std::string names = g.nodes[at(body.nodes.front())].name;
  if (body.nodes.size() > 1) names += fmt::format(" and {} more", body.nodes.size() - 1);
  const Index all = body.cut.size();
  if (!b) return fmt::format("{}: all {} modes", names, all);
  if (b->V.cols() == 0)
    return fmt::format("{}: {}", names, oscillators(*body.block) ? "none of its modes" : "rigid");
  return fmt::format("{}: {} modes and {} vectors of {}", names, b->V.cols() - b->vectors,
                     b->vectors, all);
}

}  // namespace

SmallerBodies smaller_bodies(const Graph& graph, const std::vector<ModeEffects>& effects,
                             double share) {
  std::vector<Shared> bodies = by_block(graph, effects);
  keep(bodies, share);
  SmallerBodies result{graph, 0, 0, {}};
  const std::vector<double> values = nominal_values(graph);
  std::vector<char> gone(graph.signals.size(), 0);
  for (const Shared& body : bodies) {
    const auto count = static_cast<int>(body.nodes.size());
    const std::optional<BodyBasis> b = basis(body, share);
    result.before += count * static_cast<int>(body.cut.size());
    result.after += count * static_cast<int>(b ? b->V.cols() : body.cut.size());
    result.text.push_back(told(graph, body, b));
    if (!b) continue;
    const BlockPtr block = in_fewer_modes(body.block, *b, values);
    const auto states = static_cast<int>(block->interface().states.size());
    for (const int i : body.nodes) {
      Node& node = result.graph.nodes[at(i)];
      node.block = block;
      result.graph.signals[at(node.state)].size = states;
      gone[at(node.state)] = states == 0;
    }
  }
  remove_signals(result.graph, gone);
  return result;
}

}  // namespace titop::detail
