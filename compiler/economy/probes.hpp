#pragma once

#include <titop/compiler/economy/scene.hpp>

/// What single modes of single bodies do to the scene's transfer. For the compiler's own files.
namespace titop::detail {

/// A node whose block has modes, and what leaving each of them out does to the worst pair of the
/// scene, over the pair's peak: to first order, in the assembled structure.
struct ModeEffects {
  int node = -1;
  Eigen::VectorXd cut;        ///< per mode: with nothing in its place
  Eigen::VectorXd corrected;  ///< with static vectors in its place, which match two orders in s^2
  std::vector<char> ports;    ///< per column of Modal::W: does anything pass there?
};

/// For all nodes with modes (those whose kinematic part knows stiffnesses of its own left out).
///
/// A mode with the row w of Modal::W answers what drives the body, u, by etadd = s^2 w u / (s^2 + d
/// s + k), and adds w' etadd to what the body gives. u per input of the scene comes from the graph
/// with u as outputs, what an addition does to the scene's outputs from the graph with additions
/// as inputs. Both are sampled on a ray of damping 0.05 at least, where some ten points per octave
/// do; what the scene's own ray would show more, the ratio of both dampings, is a factor. Rankings,
/// no bounds: a body that hardly keeps a mode is misjudged. Two compiles, and some fifty transfers
/// of each.
std::vector<ModeEffects> mode_effects(const Graph& graph, const Scene& scene,
                                      const Options& options);

}  // namespace titop::detail
