#pragma once

#include <titop/analysis/reduction/scene.hpp>

/// Effect of single modes of single bodies on the scene's transfer. For the library's own files.
namespace titop::detail {

/// A node whose block has modes, and the effect of dropping each of them on the worst pair of the
/// scene, over the pair's peak: to first order, in the assembled structure.
struct ModeEffects {
  int node = -1;
  Eigen::VectorXd cut;        ///< per mode: without replacement
  Eigen::VectorXd corrected;  ///< with static vectors instead, which match two orders in s^2
  std::vector<char> ports;    ///< per column of Modal::W: true if there is a transfer
};

/// For all nodes with modes (without those whose kinematic part has stiffnesses of its own).
///
/// A mode with the row w of Modal::W responds to the body's inputs u by etadd = s^2 w u / (s^2 + d
/// s + k), and adds w' etadd to the body's outputs. u per input of the scene comes from the graph
/// with u as outputs, the effect of an addition on the scene's outputs from the graph with
/// additions as inputs. Both are sampled on a ray of damping 0.05 or more, for which about ten
/// points per octave suffice; the larger peaks on the scene's own ray enter as a factor, the ratio
/// of both dampings. A ranking, no bound: it is wrong for a body that keeps hardly any mode. Two
/// compiles, and some fifty transfers of each.
std::vector<ModeEffects> mode_effects(const Graph& graph, const Scene& scene,
                                      const Options& options);

}  // namespace titop::detail
