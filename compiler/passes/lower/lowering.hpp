#pragma once

#include <optional>
#include <set>
#include <titop/compiler/passes/lower/amounts.hpp>

/// Right-hand sides of equations and outputs as amounts: reactions, positions and accumulated
/// forces are expanded.
namespace titop::passes {

/// Writes right-hand sides out, for one set of parameter values.
struct Lowering {
  enum class Level { position, rate };
  const Graph& g;  ///< as the user wrote it, in the order of by_name
  ParameterValues values;
  std::shared_ptr<const Drives> all_drives;
  const Drives& drive = *all_drives;
  std::vector<char> visiting;    ///< channels whose position is being written out
  std::vector<int> within = {};  ///< channels whose reaction is being written out
  std::vector<int> met = {};     ///< parameters met since it was last cleared
  int asked = -1;                ///< node whose matrices are at hand
  std::shared_ptr<const Dynamics> at_hand = {};
  std::vector<Mistake> mistakes = {};
  std::vector<RigidMotion> motions;
  std::set<RigidMotion> missing = {};  ///< motions that have no Integrator yet
  /// Pairs of opened parameters in accelerations whose rates or positions have none yet: the signal
  /// of w.
  std::set<std::pair<int, Level>> unopened = {};
  bool numbers_only = false;  ///< structure is known already: none is found
  std::vector<std::pair<int, Level>>* readings = nullptr;  ///< if given: motions are listed there

  /// The motion of a channel against a point further up its way: a signal of its own
  /// (shared_motions.hpp).
  struct SharedMotion {
    int channel = -1;
    Level level = Level::position;
    int anchor = -1;        ///< channel against which it counts
    bool grounded = false;  ///< the anchor does not move
  };
  std::vector<SharedMotion> shared = {};  ///< their signals follow those of g; upper ones first
  std::vector<int> shared_at = {};        ///< 2 channel + level -> index; -1, or empty: none
  bool flat = false;                      ///< they are written out
  bool astray = false;                    ///< a way up no longer leads to the anchor

  Lowering(const Graph& graph, ParameterValues v, std::shared_ptr<const Drives> d,
           std::vector<RigidMotion> m)
      : g(graph),
        values(v),
        all_drives(std::move(d)),
        visiting(graph.channels.size(), 0),
        motions(std::move(m)) {}

  /// The expanded right-hand side of an equation or output of the lowered graph.
  Amount amount(const Origin& origin);
  /// The same as terms; the origin gets the parameters on which they depend.
  std::vector<Term> written_out(Origin& origin);
  void meet(const Value& v) {
    if (v.is_parameter()) met.push_back(v.index());
  }
  /// All values of a rotation or a block.
  template <class Source>
  void meet_all(const Source& source) {
    if (numbers_only) return;
    for (const Value& v : source.values()) meet(v);
  }
  Eigen::MatrixXd coefficient_of(const Term& t);

  /// The expanded right-hand side of one equation or output; its mistakes are kept, with its source
  /// line.
  template <class F>
  auto collect(const SourceLine& where, F find) -> decltype(find());
  Amount terms(const std::vector<Term>& list);
  /// All that drives the channel's force.
  Amount force(int channel);
  /// The row of this output signal of an algebraic node.
  Amount algebraic(int output);
  /// All rows of amount(origin), whether they count or not.
  Amount all_rows(const Origin& origin);
  Amount motion(int channel, Level level);
  /// A point on the way, and the factor of its motion.
  struct WayPoint {
    int channel;
    Eigen::MatrixXd factor;
    Pattern declared;
  };
  void walk(Amount& sum, WayPoint at_channel, Level level);
  std::vector<WayPoint> step(Amount& sum, const WayPoint& here, Level level);
  void share(std::vector<SharedMotion> list);
  int shared_motion(int channel, Level level) const;
  WayPoint up_from(const SharedMotion& motion, Amount& sum);
  Amount against_anchor(const SharedMotion& motion);
  WayPoint at_anchor(int motion, const WayPoint& here);
  /// The way from the channel of a shared motion to its anchor.
  struct ToAnchor {
    Eigen::MatrixXd factor;
    Pattern declared;
    std::vector<int> met;  ///< parameters
  };
  std::vector<ToAnchor> to_anchor = {};  ///< of `shared`, once one is needed
  bool find_ties(const WayPoint& here, Level level, std::vector<WayPoint>& ties, Amount& inputs);
  void add_opened(const WayPoint& w, Level level, Amount& inputs);
  void add_opened_motions(Amount& sum, const Node& node, const Kinematics& k, const WayPoint& by,
                          int spec, double sign, Level level);
  std::optional<WayPoint> through_body(Amount& sum, const WayPoint& here, Level level);
  Amount own_motion(int channel) const;
  Amount integrated(Amount sum, Level level);
  Amount added(std::span<const int> equations);
  Amount added_to(int channel);
};

template <class F>
auto Lowering::collect(const SourceLine& where, F find) -> decltype(find()) {
  try {
    return find();
  } catch (const Error& error) {
    std::fill(visiting.begin(), visiting.end(), 0);
    within.clear();
    for (Mistake m : error.mistakes()) {
      m.details.push_back("asked for at " + to_string(where));
      mistakes.push_back(std::move(m));
    }
    return {};
  }
}

}  // namespace titop::passes
