#include <titop/graph/linalg/eigen.hpp>
#include <tuple>

#include "generate/assembly.hpp"
#include "generate/dice.hpp"
#include "generate/draw_laws.hpp"
#include "generate/generate.hpp"

namespace titop::generate {
namespace {

class Artist {
 public:
  explicit Artist(const GenerateOptions& o) : o_(o), dice_(o.seed) {
    plan_.name = "seed " + std::to_string(o.seed);
  }

  ScenePlan plan() {
    if (o_.family == Family::scalar)
      scalar();
    else
      spatial();
    return std::move(plan_);
  }

 private:
  // --- names and signals ---

  std::string fresh(const char* kind) { return kind + std::to_string(++names_); }
  std::string input(int size) {
    plan_.inputs.push_back({fresh("u"), size});
    return plan_.inputs.back().name;
  }
  void read(PlannedReading r, int size) {
    plan_.outputs.push_back({fresh("y"), size});
    r.output = plan_.outputs.back().name;
    plan_.readings.push_back(std::move(r));
  }
  bool damped() {
    return o_.damping == Damping::all || (o_.damping == Damping::some && dice_.chance(50));
  }
  Attachment::Kind base_kind() {
    static constexpr Attachment::Kind kKinds[] = {Attachment::Kind::ground, Attachment::Kind::free,
                                                  Attachment::Kind::imposed,
                                                  Attachment::Kind::pinned};
    const int kinds = o_.family == Family::scalar ? 3 : 4;
    const Attachment::Kind kind = kKinds[dice_.below(kinds)];
    return o_.loops > 0 && kind == Attachment::Kind::imposed ? Attachment::Kind::free : kind;
  }
  /// Stiffness and damping of a spring.
  std::pair<Ratio, Ratio> spring() {
    const Ratio k = dice_.octaves(o_.stiffness_low, o_.stiffness_high);
    return {k, damped() ? dice_.octaves(-3, 2) : Ratio(0)};
  }

  // --- one degree of freedom per junction ---

  void scalar() {
    for (int i = 0; i < o_.bodies; ++i) {
      if (o_.twins && i > 1 && i % 2 == 0 &&
          plan_.blocks.back().base.kind == Attachment::Kind::mounted) {
        PlannedBlock twin = plan_.blocks.back();
        twin.name = fresh("z");
        twin.stiffness_parameter.clear();
        plan_.blocks.push_back(twin);
      } else {
        plan_.blocks.push_back(spring_mass(i));
      }
    }
    for (int i = 0; i < o_.loops; ++i) close_scalar(i);
    for (int i = 0; i < o_.bodies; ++i) use_scalar(i);
    const int last = o_.twins ? 0 : dice_.below(o_.bodies);
    plan_.loads.push_back(
        {input(1), {last, "child"}, {}, dice_.chance(50) ? Ratio(1) : Ratio(-5, 2)});
    read({.of = PlannedReading::Of::acceleration,
          .point = {o_.twins ? 0 : dice_.below(o_.bodies), "child"}},
         1);
    const bool grounded = plan_.blocks[0].base.kind == Attachment::Kind::ground;
    if (grounded && closures_independent(plan_))
      read({.of = PlannedReading::Of::support, .point = {0, "parent"}}, 1);
    if (grounded) read({.of = PlannedReading::Of::position, .point = {0, "child"}}, 1);
  }

  PlannedBlock spring_mass(int i) {
    PlannedBlock b{.name = fresh("z")};
    const auto [k, c] = spring();
    b.spring = Spring{dice_.octaves(-1, 3), k, c, {}};
    if (dice_.chance(15)) b.stiffness_parameter = "k_" + b.name;
    if (i > 0) {
      b.base.kind = Attachment::Kind::mounted;
      b.base.on = {parent_of(o_.shape, i, dice_), "child"};
    } else {
      b.base.kind = base_kind();
      if (b.base.kind == Attachment::Kind::imposed ||
          (b.base.kind == Attachment::Kind::free && dice_.chance(50)))
        b.base.input = input(1);
    }
    if (b.base.kind == Attachment::Kind::free || dice_.chance(30))
      b.spring->parent_mass = dice_.octaves(-1, 3);
    return b;
  }

  /// The child of one of the last spring-masses is held, or moves with another.
  void close_scalar(int i) {
    const int block = o_.bodies - 1 - i;
    if (block < 1) return;
    Closure c{{block, "child"}};
    if (block > 1 && dice_.chance(50)) c.with = PlannedPoint{dice_.below(block - 1), "child"};
    plan_.closures.push_back(c);
    if (closures_independent(plan_) && dice_.chance(50))
      read({.of = PlannedReading::Of::reaction, .point = c.point}, 1);
  }

  void use_scalar(int i) {
    if (o_.twins && i > 0) return;
    if (dice_.chance(25)) plan_.loads.push_back({input(1), {i, "child"}});
    if (o_.controllers && o_.states > 0) {
      dense_control(i, [&](int block) { return ControlPoint{{block, "child"}, {}}; });
    } else if (o_.controllers && dice_.chance(25)) {
      const bool acceleration = dice_.chance(50);
      plan_.controls.push_back(control(acceleration, i));
      plan_.controls.back().at = {{{i, "child"}, {}}};
    }
    if (!dice_.chance(35)) return;
    if (dice_.chance(50))
      read({.of = PlannedReading::Of::relative, .point = {i, ""}}, 1);
    else
      read({.of = PlannedReading::Of::acceleration, .point = {i, "child"}}, 1);
  }

  Control control(bool acceleration, int block) {
    Control c{.name = fresh("K"), .block = block};
    c.law = acceleration ? Control::Law::acceleration : Control::Law::position;
    draw_small_law(dice_, c);
    return c;
  }

  /// A dense controller at every other body: around its position (spring-masses), around one or two
  /// accelerations, or out of the loops.
  template <class Place>
  void dense_control(int i, Place place) {
    if (!dice_.chance(plan_.controls.empty() ? 80 : 40)) return;
    const bool scalar = o_.family == Family::scalar;
    const int kind = scalar ? dice_.below(3) : dice_.between(1, 2);
    Control c{.name = fresh("K"), .block = i};
    c.at = {place(i)};
    if (kind == 0) {
      draw_dense_law(dice_, c, o_.states, Ratio(8), dice_.octaves(0, 4));
    } else {
      c.law = kind == 1 ? Control::Law::acceleration : Control::Law::filter;
      if (dice_.chance(50)) c.at.push_back(place(scalar ? dice_.below(o_.bodies) : any_body()));
      draw_dense_law(dice_, c, o_.states, Ratio(1, 8), dice_.octaves(-3, 1));
    }
    plan_.controls.push_back(c);
    if (kind == 2)
      read({.of = PlannedReading::Of::control, .point = {int(plan_.controls.size()) - 1, ""}},
           static_cast<int>(c.size()));
  }

  // --- six degrees of freedom per junction ---

  void spatial() {
    for (int i = 0; i < o_.bodies; ++i) {
      const bool twin = o_.twins && i > 1 && i % 2 == 0;
      if (twin)
        twin_body(i);
      else
        body(i);
    }
    for (int i = 0; i < o_.loops; ++i) close_spatial(i);
    if (o_.twins) return outside_only();
    for (const int i : bodies_) use_body(i);
    read({.of = PlannedReading::Of::acceleration, .point = {any_body(), "T"}}, 6);
    plan_.loads.push_back({input(3), {any_body(), "T"}, {PlannedPart::Kind::linear, {}}});
    const Attachment::Kind root = plan_.blocks[0].base.kind;
    if (root == Attachment::Kind::ground && closures_independent(plan_) && dice_.chance(60))
      read({.of = PlannedReading::Of::support, .point = {0, "parent"}}, 6);
    if (root == Attachment::Kind::ground && dice_.chance(60))
      read({.of = PlannedReading::Of::position,
            .point = {any_body(), "T"},
            .part = {PlannedPart::Kind::linear, {}}},
           3);
  }

  /// All loads and outputs at the first body, so that its twin branches have the same motion.
  void outside_only() {
    plan_.loads.push_back({input(6), {bodies_[0], "T"}});
    read({.of = PlannedReading::Of::acceleration, .point = {bodies_[0], "T"}}, 6);
  }

  int any_body() { return bodies_[static_cast<std::size_t>(dice_.below(int(bodies_.size())))]; }

  /// A body with points "R" and "T" and one for each body that may be mounted on it.
  Body random_body() {
    Body b;
    b.mass = dice_.octaves(-1, 3);
    Ratio part[3];
    for (Ratio& p : part) p = b.mass * Ratio(dice_.between(8, 40), 64);
    b.inertia = {part[0] + part[1], part[1] + part[2], part[2] + part[0]};
    b.PA = dice_.vector();
    const int modes = dice_.chance(40) ? 0 : dice_.between(1, 4);
    for (int i = 0; i < modes; ++i) {
      b.omega.push_back(dice_.octaves(0, 6));
      b.xi.push_back(damped() ? Ratio(dice_.between(4, 20), 1024) : Ratio(0));
      b.L.emplace_back();
      for (int j = 0; j < 6; ++j) b.L.back().push_back(dice_.fraction());
    }
    while (modes > 0 && !carries(b))
      for (auto& row : b.L)
        for (Ratio& x : row) x = x * Ratio(1, 2);
    for (const char* name : {"C1", "C2", "C3", "T"}) b.points.push_back(point(name, modes));
    return b;
  }

  BodyPoint point(const char* name, int modes) {
    BodyPoint p{name, dice_.vector(), RatioMatrix(6)};
    for (auto& row : p.Phi)
      for (int j = 0; j < modes; ++j) row.push_back(dice_.fraction());
    return p;
  }

  /// The modes have less than the body's mass: D_P - L'L is positive, with a margin.
  static bool carries(const Body& b) {
    const RatioMatrix mass = rigid_mass(b);
    Eigen::Matrix<double, 6, 6> D;
    for (int i = 0; i < 6; ++i)
      for (int j = 0; j < 6; ++j)
        D(i, j) = 0.7 * mass[static_cast<std::size_t>(i)][static_cast<std::size_t>(j)].value();
    for (const auto& row : b.L) {
      Eigen::Matrix<double, 6, 1> l;
      for (int j = 0; j < 6; ++j) l(j) = row[static_cast<std::size_t>(j)].value();
      D -= l * l.transpose();
    }
    return Eigen::LLT<Eigen::Matrix<double, 6, 6>>(D).info() == Eigen::Success;
  }

  void body(int i) {
    PlannedBlock b{.name = fresh("b"), .body = random_body()};
    if (i == 0) {
      b.base.kind = base_kind();
      if (b.base.kind == Attachment::Kind::imposed ||
          (b.base.kind != Attachment::Kind::ground && dice_.chance(50)))
        b.base.input = input(b.base.kind == Attachment::Kind::pinned ? 3 : 6);
      return add_body(b);
    }
    b.base.kind = Attachment::Kind::mounted;
    const int on = bodies_[static_cast<std::size_t>(parent_of(o_.shape, i, dice_))];
    b.base.on = {on, "C" + std::to_string(dice_.between(1, 3))};
    b.base.turned = dice_.chance(75);
    b.base.T = b.base.turned ? dice_.rotation() : unit3();
    if (dice_.chance(45)) add_joint(b);
    add_body(b);
  }

  void add_body(const PlannedBlock& b) {
    bodies_.push_back(static_cast<int>(plan_.blocks.size()));
    plan_.blocks.push_back(b);
  }

  /// A hinge or a slide between the body and its site: it takes the body's place there.
  void add_joint(PlannedBlock& b) {
    PlannedBlock h{.name = fresh("h"), .base = b.base};
    h.joint = PlannedJoint{.turns = dice_.chance(65), .axis = dice_.direction()};
    const int index = static_cast<int>(plan_.blocks.size());
    const int kind = dice_.below(o_.controllers && o_.states == 0 ? 4 : 3);
    if (kind == 3) {
      plan_.controls.push_back(control(false, index));
    } else if (kind > 0) {
      std::tie(h.joint->stiffness, h.joint->damping) = spring();
      if (kind == 2) h.joint->input = input(1);
    }
    if (kind > 0 && dice_.chance(50))
      read({.of = PlannedReading::Of::relative, .point = {index, ""}}, 1);
    plan_.blocks.push_back(h);
    b.base = {.kind = Attachment::Kind::mounted, .on = {index, "child"}, .T = unit3()};
  }

  /// The same body at the same place as the one before.
  void twin_body(int i) {
    const PlannedBlock last = plan_.blocks.back();
    if (plan_.blocks[static_cast<std::size_t>(last.base.on.block)].joint) return body(i);
    PlannedBlock twin = last;
    twin.name = fresh("b");
    add_body(twin);
  }

  /// "T" of one of the last bodies is held, or welded to a point "R" of the first, which is put
  /// where it is.
  void close_spatial(int i) {
    const std::size_t k = bodies_.size() - 1 - static_cast<std::size_t>(i);
    if (k < 1 || k >= bodies_.size()) return;
    Closure c{.point = {bodies_[k], "T"}, .T = unit3()};
    if (dice_.chance(60)) {
      auto [T, place] = seen_from_first(c.point);
      const std::string name = "R" + std::to_string(i + 1);
      Body& first = *plan_.blocks[0].body;
      const int modes = static_cast<int>(first.omega.size());
      first.points.push_back(point(name.c_str(), modes));
      first.points.back().PC = place;
      c.with = PlannedPoint{0, name};
      c.T = T;
    }
    plan_.closures.push_back(c);
    if (closures_independent(plan_) && dice_.chance(40))
      read({.of = PlannedReading::Of::reaction, .point = c.point}, 6);
  }

  /// Rotation (its frame to the first body's) and place of a point, from the first body's parent.
  std::pair<Mat3, Vec3> seen_from_first(const PlannedPoint& p) const {
    const PlannedBlock& b = plan_.blocks[static_cast<std::size_t>(p.block)];
    Vec3 own{};
    if (b.body)
      for (const BodyPoint& c : b.body->points)
        if (c.name == p.channel) own = c.PC;
    if (p.block == 0) return {unit3(), own};
    const auto [T, origin] = seen_from_first(b.base.on);
    const Mat3 turned = T * b.base.T;
    return {turned, origin + turned * own};
  }

  void use_body(int i) {
    const PlannedPart along{PlannedPart::Kind::along, dice_.direction()};
    if (dice_.chance(30)) plan_.loads.push_back({input(1), {i, "T"}, along});
    if (o_.controllers && o_.states > 0) {
      dense_control(i, [&](int block) { return ControlPoint{{block, "T"}, dice_.direction()}; });
    } else if (o_.controllers && dice_.chance(20)) {
      plan_.controls.push_back(control(true, i));
      plan_.controls.back().at = {{{i, "T"}, dice_.direction()}};
    }
    if (dice_.chance(30)) slosh(i);
    if (dice_.chance(30))
      read({.of = PlannedReading::Of::acceleration, .point = {i, "T"}, .part = along}, 1);
  }

  /// A spring-mass along one direction of the body.
  void slosh(int on) {
    PlannedBlock z{.name = fresh("z")};
    const auto [k, c] = spring();
    z.spring = Spring{dice_.octaves(-2, 1), k, c, {}};
    z.base = {.kind = Attachment::Kind::mounted, .on = {on, "T"}, .along = dice_.direction()};
    if (dice_.chance(50))
      read({.of = PlannedReading::Of::relative, .point = {int(plan_.blocks.size()), ""}}, 1);
    plan_.blocks.push_back(z);
  }

  GenerateOptions o_;
  Dice dice_;
  ScenePlan plan_;
  int names_ = 0;
  std::vector<int> bodies_;
};

}  // namespace

ScenePlan draw(const GenerateOptions& options) { return Artist(options).plan(); }

}  // namespace titop::generate
