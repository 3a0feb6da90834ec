#pragma once

#include <optional>
#include <titop/analysis/reduction/scene.hpp>

/// Effect of single modes of single bodies on the scene's transfer. For the library's own files.
namespace titop::detail {

/// A node whose block has modes (of a body, or oscillators of an Lti), and the effect of dropping
/// each of them on the worst pair of the scene, over the pair's peak: to first order, in the
/// assembled structure.
struct ModeEffects {
  int node = -1;
  Eigen::VectorXd cut;        ///< per mode: without replacement
  Eigen::VectorXd corrected;  ///< with static vectors instead, which match two orders in s^2
  std::vector<char> ports;    ///< per BlockModes::ports: true if there is a transfer
};

/// The modes of a block: q'' + damping q' + stiffness q = b u, which add out_q q + out_v q' + out_a
/// q'' to its outputs y.
struct BlockModes {
  Eigen::VectorXd stiffness, damping;
  Eigen::MatrixXd b;                    ///< modes x inputs
  Eigen::MatrixXd out_q, out_v, out_a;  ///< outputs x modes
  /// A column that is to be in the span of static vectors, with its input and its output; -1: none.
  struct PortColumn {
    Eigen::VectorXd column;
    Eigen::Index input = -1, output = -1;
  };
  std::vector<PortColumn> ports;
};

/// None if the block has no modes, or its kinematic part has stiffnesses of its own.
std::optional<BlockModes> modes_of(const Block& block, ParameterValues values);

/// For all nodes with modes (without those whose kinematic part has stiffnesses of its own).
///
/// A mode with the row w of Modal::W responds to the body's inputs u by etadd = s^2 w u / (s^2 + d
/// s + k), and adds w' etadd to the body's outputs; an oscillator likewise by its own outputs. u
/// per input of the scene comes from the graph with u as outputs, the effect of an addition on the
/// scene's outputs from the graph with additions as inputs. Both are sampled on a ray of damping
/// 0.05 or more, for which about ten points per octave suffice; the larger peaks on the scene's own
/// ray enter as a factor, the ratio of both dampings. A ranking, no bound: it is wrong for a body
/// that keeps hardly any mode. Two compiles, and some fifty transfers of each.
std::vector<ModeEffects> mode_effects(const Graph& graph, const Scene& scene,
                                      const Options& options);

}  // namespace titop::detail
