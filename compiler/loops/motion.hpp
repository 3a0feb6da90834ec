#pragma once

#include <functional>
#include <optional>
#include <span>
#include <string>
#include <titop/compiler/loops/expanded_sum.hpp>
#include <titop/compiler/loops/sum.hpp>
#include <titop/compiler/passes/stage.hpp>
#include <titop/graph/linalg/kinematics.hpp>
#include <tuple>
#include <utility>
#include <vector>

namespace titop::loops {

/// An equation between accelerations, read between positions: S x_target = sum of c x_point + own.
struct Tie {
  int equation = -1, target = -1;              ///< target: a channel
  Eigen::MatrixXd S = {};                      ///< rows x size, orthonormal rows
  std::map<int, Eigen::MatrixXd> points = {};  ///< channel -> rows x size
  Form own = {};                               ///< prescribed columns
  /// Rotation of its one point, by all ties of the target to it; none: no rotation, or no point.
  std::optional<Matrix3d> rotation = {};
  bool closes = false;  ///< no edge of the tree: it closes a chain
  bool late = false;    ///< from the ground, and that comes last
  int order = 0;        ///< position in the traversal of the spanning forest
  int length = 0;       ///< edges of the tree's way round, if it closes one

  /// A tie that closes a chain may go through those of lower rank.
  using Rank = std::tuple<bool, int, int>;
  Rank rank() const { return {late, length, order}; }
};

/// A closing equation: form + gap * (position of the meeting point) = 0, where `gap` is 0 if the
/// geometry closes. Ties that leave translations free do not determine the distance of their
/// points: the effect of such a lever arm on the gap is contained in the form.
struct Closing {
  const Tie* tie = nullptr;
  Form form = {};
  double gap = 0;               ///< relative to 1, or to the longest lever; 0 if the ground is met
  double gap_length = 0;        ///< 1 of `gap` in metres; 0: it is an angle [rad]
  std::vector<int> chain = {};  ///< points on the way round, for messages
  std::vector<int> equations = {};  ///< ties on the way round, this one too
};

/// Order in which a spanning forest takes parts mounted on the ground. `last`: a chain that closes
/// without the ground is then found as one, independent of names; the ground itself has no
/// geometry.
enum class Ground { by_name, last };

/// Points (channels) and the ground, joined by bodies and by equations: a spanning forest, body
/// edges first, so that only equations ever close a chain; then equations by name, those against a
/// block's default direction last.
class Motion {
 public:
  /// `released`: by `chains`, from these equations; the ways round use the original equations.
  Motion(const Graph& graph, ParameterValues values, const SumExpander& sums,
         Ground ground = Ground::by_name, std::span<const Released> released = {});

  const std::vector<Tie>& ties() const { return ties_; }
  /// Both ways from the tie to their meeting point: beyond the chain all is exactly 0. The way
  /// round is the tree's, or a shorter one through ties that close chains themselves, by a shorter
  /// way in the tree (of equals those before it): then it is the tree's closing equation minus some
  /// of theirs, and a ladder's rungs close a bay each. The parts that `chains` has released of
  /// theirs follow from earlier closing equations: all together are equivalent. Released ties are
  /// no such way. Some 600 edges are searched, else up to 16 per edge of the tree's way.
  Closing closing(const Tie& tie) const;
  /// Position of a point from the root of its assembly.
  Form position(int channel) const;
  /// Per channel: whether its point is immobile if these scalar columns are 0. O(points log
  /// points).
  std::vector<char> at_rest(const std::function<bool(const FormColumn&, int)>& held) const;
  /// The tie that places a point relative to the one above it: its equation; -1: none, or a body.
  int tie_above(int channel) const { return up_[static_cast<std::size_t>(channel)].equation; }
  /// Name of the point in the user's diagram.
  std::string name(int point) const;
  /// A body on this chain without kinematics of its ports: its node, else -1.
  int silent(const std::vector<int>& chain) const;

 private:
  struct Edge {
    int to = -1, from = -1;  ///< x_to = R x_from + own
    Eigen::MatrixXd R = {};
    Form own = {};
    bool rigid = true;     ///< maps rigid motions to rigid ones: no gear
    int silent = -1;       ///< node without kinematics of its ports
    bool one_way = false;  ///< R has no inverse
    int equation = -1;     ///< of a tie
  };

  void add_bodies(ParameterValues values);
  void add_body(int node, ParameterValues values);
  void add_ties(const SumExpander& sums, Ground ground);
  Tie tie_of(const Equation& equation, int index, const SumExpander& sums, Ground ground) const;
  static void find_rotations(std::vector<Tie>& ties);
  std::optional<Edge> edge_of(const Tie& tie) const;
  Edge reversed(const Edge& edge) const;
  /// From one point to another, or to the root (`to` -1): each edge leads on from the one before.
  struct Way {
    int to = -1;
    std::vector<Edge> edges = {};
    bool rigid() const;
  };
  /// A tie that closes a chain, from either side.
  struct Shortcut {
    Tie::Rank rank = {};  ///< the tie's
    Edge edge = {};
  };

  /// The spanning forest, and the ties that close chains; `released`: as they were.
  void plant(std::vector<Tie> released);
  /// Every point below one that is nearer to its root; a point of `one_way` is no root.
  void hang(const std::vector<char>& one_way);
  /// Ties that close chains, as ways for others: those of the graph, and `released` as they were.
  void plant_shortcuts(std::vector<Tie> released, const std::vector<char>& one_way);
  void plant_shortcut(const Tie& tie, const std::vector<char>& one_way);
  int tree_way(const Tie& tie) const;
  /// Meeting point of the tree's ways up from both, -1 if there is none. O(log depth).
  int meeting(int a, int b) const;
  /// In the tree, up to `above`.
  Way up_from(int point, int above) const;
  /// The points from `a` to `b` on a way of less than `length` edges, through ties before this
  /// rank; empty if none is found at the cost of some tree ways.
  std::vector<int> shorter(int a, int b, Tie::Rank rank, int length) const;
  Edge edge_between(int point, int next, Tie::Rank rank) const;
  /// The two ways from the ends of a tie to where they meet.
  std::pair<Way, Way> ways(const Tie& tie) const;
  /// sum += factor * x_point, along the way; returns the factor of its end.
  Eigen::MatrixXd walk(RoundedSum& sum, Eigen::MatrixXd factor, const Way& way) const;
  void add_root(RoundedSum& sum, const Eigen::MatrixXd& factor, int root) const;
  /// sum += gap * x_point, from the root of its assembly.
  void add_gap(RoundedSum& sum, const Eigen::MatrixXd& gap, int point, Closing& closing) const;

  const Graph& g_;
  int ground_;
  std::vector<Tie> ties_;
  std::vector<Edge> edges_;
  std::vector<std::vector<int>> at_point_;  ///< edges of the forest
  std::vector<Edge> up_;                    ///< per point: from the one above it
  std::vector<int> depth_, root_;
  std::vector<int> jump_;                        ///< per point: one far above it (skew-binary)
  std::vector<std::vector<int>> below_;          ///< per point: those right below it
  std::vector<std::vector<Shortcut>> shortcut_;  ///< per point: edges that start there
};

}  // namespace titop::loops
