#include <doctest/doctest.h>
#include <fmt/format.h>

#include <titop/graph/modal_form.hpp>
#include <titop/titop.hpp>

#include "generate/diagrams/modes.hpp"
#include "support/rng.hpp"

/// The dense model of many modal bodies against `apply`, column by column; and the coupling of the
/// modes of reciprocal structures, which is symmetric.

using namespace titop;
using titop_test::Rng;

namespace {

constexpr int kModes = 6;

/// A bar with modes and one degree of freedom at each end. `skew`: asymmetry of the direct coupling
/// of its ends. `first_alone`: the other modes do not move the child.
class BarBlock : public Block {
 public:
  BarBlock(Rng& rng, Value skew = 0.0, bool modal = true, double mass = 5, bool first_alone = false)
      : skew_(std::move(skew)), modal_(modal) {
    face_.channels = {{"child", 1, Takes::force}, {"parent", 1, Takes::accel}};
    for (const char* suffix : {"", "_rate"})
      for (int i = 0; i < kModes; ++i)
        face_.states.push_back(fmt::format("eta{}{}", i + 1, suffix));
    face_.rates = rates_follow(kModes);
    m_.W.resize(kModes, 2);
    m_.stiffness.resize(kModes);
    for (int i = 0; i < kModes; ++i) {  // powers of two: dividing by them loses nothing
      m_.W.row(i) << rng.between(-1, 1), rng.between(-1, 1);
      m_.stiffness(i) = std::exp2(2 * i);
    }
    if (first_alone) m_.W.col(0).tail(kModes - 1).setZero();
    m_.damping = m_.stiffness / 64;
    m_.rigid = Eigen::Matrix2d{{0, 1}, {1, -mass}};
  }
  std::string_view type() const override { return "Bar"; }
  const Interface& interface() const override { return face_; }
  std::vector<Value> values() const override { return {skew_}; }
  bool has_frame() const override { return false; }
  std::shared_ptr<const Dynamics> dynamics(ParameterValues values) const override {
    Modal m = m_;
    m.rigid(0, 1) += skew_.at(values);
    Dynamics d = *modal_dynamics(std::move(m));
    if (!modal_) d.modal = nullptr;
    return std::make_shared<const Dynamics>(std::move(d));
  }

 private:
  Interface face_;
  Modal m_;
  Value skew_;
  bool modal_;
};

struct Bar {
  std::shared_ptr<const BarBlock> block;
  struct Handle {
    Handle(Graph* graph, int node)
        : child(detail::channel<1>(graph, node, 0)), parent(detail::channel<1>(graph, node, 1)) {}
    DualPort<1> child, parent;
  };
};
BlockPtr as_block(const Bar& bar) { return bar.block; }

/// An algebraic block: c1 and c2 move as x, whose force is theirs and an inertia's; the force of z,
/// whose motion is unobservable, is c1's and `share` times c2's.
class HubBlock : public Block {
 public:
  explicit HubBlock(double share) {
    face_.channels = {{"c1", 1, Takes::force},
                      {"c2", 1, Takes::force},
                      {"x", 1, Takes::accel},
                      {"z", 1, Takes::accel}};
    matrices_->A.resize(0, 0), matrices_->B.resize(0, 4), matrices_->C.resize(4, 0);
    const auto gain = [&](int row, int column, double value) {
      matrices_->sparse.push_back({row, column, Eigen::MatrixXd::Constant(1, 1, value)});
      direct_(row, column) = true;
    };
    gain(0, 2, 1), gain(1, 2, 1);
    gain(2, 0, 1), gain(2, 1, 1), gain(2, 2, -3);
    gain(3, 0, 1), gain(3, 1, share), gain(3, 2, -40);
  }
  std::string_view type() const override { return "Hub"; }
  const Interface& interface() const override { return face_; }
  bool has_frame() const override { return false; }
  bool is_algebraic() const override { return true; }
  Pattern feedthrough() const override { return direct_; }
  std::shared_ptr<const Dynamics> dynamics(ParameterValues) const override { return matrices_; }

 private:
  Interface face_;
  std::shared_ptr<Dynamics> matrices_ = std::make_shared<Dynamics>();
  Pattern direct_ = Pattern::Constant(4, 4, false);
};

struct Hub {
  double share = 1;
  struct Handle {
    Handle(Graph* graph, int node)
        : c1(detail::channel<1>(graph, node, 0)),
          c2(detail::channel<1>(graph, node, 1)),
          x(detail::channel<1>(graph, node, 2)),
          z(detail::channel<1>(graph, node, 3)) {}
    DualPort<1> c1, c2, x, z;
  };
};
BlockPtr as_block(const Hub& hub) { return std::make_shared<HubBlock>(hub.share); }

/// A chain of bars on the ground or free at its first end, with a force and the motion at the last.
struct Bars {
  int count = 40;
  double skew = 0;        ///< of the tenth bar
  double back = 1;        ///< share of the twentieth bar's force that its neighbour gets
  bool clamped = true;    ///< the first end rests
  bool from_tip = false;  ///< motions are given from bar to bar towards the first
  bool some_not_modal = false;
  double heaviest = 5;      ///< mass of the 24th bar and of the 25th, which it carries by one mode
  bool controller = false;  ///< from the fifth bar's motion to the thirtieth's force
};

Diagram chain(const Bars& bars) {
  Rng rng(11);
  Diagram d{"bars"};
  const auto p = d.param("p", bars.back), skew = d.param("skew", bars.skew);
  const auto u = d.input("u"), a = d.input("a");
  std::vector<Bar::Handle> bar;
  for (int i = 0; i < bars.count; ++i)  // names in another order than the chain
    bar.push_back(
        d.add(fmt::format("bar{}", i * 17 % bars.count + 1),
              Bar{std::make_shared<BarBlock>(rng, i == 9 ? Value(skew) : Value(0.0),
                                             !(bars.some_not_modal && i % 7 == 3),
                                             i == 23 || i == 24 ? bars.heaviest : 5, i == 23)}));
  for (std::size_t i = 1; i < bar.size(); ++i) {
    const bool turned = bars.from_tip && i > 20;
    if (turned)
      bar[i - 1].child.accel = bar[i].parent.accel;
    else
      bar[i].parent.accel = bar[i - 1].child.accel;
    if (turned)
      bar[i].parent.force = bar[i - 1].child.force;
    else if (i == 19)
      bar[i - 1].child.force = p * bar[i].parent.force;
    else
      bar[i - 1].child.force = bar[i].parent.force;
  }
  if (bars.clamped)
    bar.front().parent.accel = a;
  else
    bar.front().parent.force = a;
  if (bars.controller) {
    auto K = d.add("K", Lti{.A = Eigen::MatrixXd{{-1}},
                            .B = Eigen::MatrixXd{{1}},
                            .C = Eigen::MatrixXd{{2}},
                            .D = Eigen::MatrixXd{{0.5}}});
    K.in = bar[4].child.accel;
    bar[29].child.force += K.out;
  }
  bar.back().child.force = u;
  d.output("tip") = bar.back().child.accel;
  d.output("middle") = bar[bar.size() / 2].child.accel;
  return d;
}

/// Coupling of the modes of all bodies: modal accelerations by unit displacements, over minus the
/// stiffness, without the body's own.
Eigen::MatrixXd felt(const System& system) {
  StateSpace m;
  system.write(m);
  std::vector<Eigen::Index> coordinates, rates;
  for (Eigen::Index i = 0; i < m.order(); ++i) {
    const std::string& name = m.states[static_cast<std::size_t>(i)];
    if (name.find(".eta") != std::string::npos)
      (name.ends_with("_rate") ? rates : coordinates).push_back(i);
  }
  Eigen::MatrixXd S = -m.A(rates, coordinates);
  for (Eigen::Index j = 0; j < S.cols(); ++j)
    S.col(j) *= std::exp2(-2 * static_cast<double>(j % kModes));
  return S;
}

/// Largest asymmetry of the coupling of two modes, over the root of the product of their own.
double asymmetry(const System& system) {
  const Eigen::MatrixXd S = felt(system);
  double most = 0;
  for (Eigen::Index i = 0; i < S.rows(); ++i)
    for (Eigen::Index j = 0; j < i; ++j)
      most = std::max(most, std::abs(S(i, j) - S(j, i)) / std::sqrt(std::abs(S(i, i) * S(j, j))));
  return most;
}

/// Largest difference of [A B; C D] from the factors' products with unit vectors, per column over
/// its largest entry.
double written_error(const System& system, int threads = 0) {
  StateSpace m;
  system.write(m, threads);
  double worst = 0;
  for (Eigen::Index j = 0; j < m.order() + m.B.cols(); ++j) {
    Eigen::VectorXd x = Eigen::VectorXd::Zero(m.order()), u = Eigen::VectorXd::Zero(m.B.cols());
    (j < m.order() ? x(j) : u(j - m.order())) = 1;
    const auto r = system.apply(x, u);
    const auto column = [&](const Eigen::MatrixXd& of_x, const Eigen::MatrixXd& of_u) {
      return j < m.order() ? of_x.col(j) : of_u.col(j - m.order());
    };
    const double size = std::max(r.xdot.cwiseAbs().maxCoeff(), r.y.cwiseAbs().maxCoeff());
    const double off = std::max((column(m.A, m.B) - r.xdot).cwiseAbs().maxCoeff(),
                                (column(m.C, m.D) - r.y).cwiseAbs().maxCoeff());
    if (!(off <= worst * size)) worst = off / size;
  }
  return worst;
}

System compiled(const Diagram& d) { return compile(d, {.minimize_up_to = 0}); }

}  // namespace

TEST_CASE("dense model: a chain, clamped or free, given from either end") {
  for (const bool clamped : {true, false})
    for (const bool from_tip : {false, true}) {
      CAPTURE(clamped);
      CAPTURE(from_tip);
      const System system = compiled(chain({.clamped = clamped, .from_tip = from_tip}));
      CHECK(asymmetry(system) <= 1e-13);
      CHECK(written_error(system) <= 1e-13);
    }
}

TEST_CASE("dense model: two chains that are tied by their children") {
  Rng rng(3);
  Diagram d{"tied"};
  const auto u = d.input("u");
  std::vector<Bar::Handle> bar;
  for (int i = 0; i < 40; ++i)
    bar.push_back(d.add(fmt::format("bar{}", i + 1), Bar{std::make_shared<BarBlock>(rng)}));
  for (std::size_t i = 1; i < bar.size(); ++i) {
    if (i == 20) continue;
    bar[i].parent.accel = bar[i - 1].child.accel;
    bar[i - 1].child.force = bar[i].parent.force;
  }
  bar[0].parent.accel = 0;
  bar[20].parent.force = 0;
  bar[39].child.accel = bar[19].child.accel;
  bar[19].child.force = u - bar[39].child.force;
  d.output("y") = bar[30].child.accel;
  const System system = compiled(d);
  CHECK(asymmetry(system) <= 1e-13);
  CHECK(written_error(system) <= 1e-13);
}

TEST_CASE("dense model: beside blocks that have states of another kind") {
  const System system = compiled(chain({.some_not_modal = true}));
  CHECK(asymmetry(system) <= 1e-13);
  CHECK(written_error(system) <= 1e-13);
}

TEST_CASE("dense model: a block, a wire or a controller that is not the same both ways") {
  for (const Bars& bars : {Bars{.skew = 1e-9}, Bars{.back = 1 + 1e-9}, Bars{.controller = true}}) {
    CAPTURE(bars.skew);
    CAPTURE(bars.back);
    const System system = compiled(chain(bars));
    CHECK(written_error(system) <= 1e-13);
  }
}

TEST_CASE("dense model: a row that is not the same both ways, of a point whose force is given") {
  for (const double share : {1., 2.}) {
    CAPTURE(share);
    Rng rng(3);
    Diagram d{"hub"};
    const auto u = d.input("u"), w = d.input("w");
    auto hub = d.add("hub", Hub{share});
    const auto arm = [&](const char* name, const DualPort<1>& at) {
      std::vector<Bar::Handle> bar;
      for (int i = 0; i < 15; ++i)
        bar.push_back(d.add(fmt::format("{}{}", name, i),
                            Bar{std::make_shared<BarBlock>(rng, 0.0, true, 15)}));
      bar[0].parent.accel = at.accel;
      at.force = bar[0].parent.force;
      for (std::size_t i = 1; i < bar.size(); ++i) {
        bar[i].parent.accel = bar[i - 1].child.accel;
        bar[i - 1].child.force = bar[i].parent.force;
      }
      d.output(fmt::format("tip of {}", name)) = bar.back().child.accel;
      return bar.back();
    };
    const auto first = arm("a", hub.c1), second = arm("b", hub.c2);
    first.child.force = 0;
    second.child.force = u;
    auto unseen = d.add("unseen", Bar{std::make_shared<BarBlock>(rng)});
    hub.z.force = w;
    hub.x.accel = unseen.child.accel;
    unseen.child.force = hub.x.force;
    unseen.parent.accel = hub.z.accel;
    d.output("F") = hub.x.force;
    const System system = compiled(d);
    CHECK(written_error(system) <= 1e-13);
  }
}

TEST_CASE("dense model: columns far smaller than others") {
  CHECK(written_error(compiled(chain({.heaviest = 5e6}))) <= 1e-12);
}

TEST_CASE("dense model: updates to a structure that is not reciprocal, and back") {
  const System both_ways = compiled(chain({}));
  CHECK(asymmetry(both_ways) <= 1e-13);
  for (const char* name : {"p", "skew"}) {
    CAPTURE(name);
    const double value = std::string(name) == "p" ? 1.5 : 0.5;
    const System one_way = both_ways.update({{name, value}});
    CHECK(asymmetry(one_way) > 1e-6);
    CHECK(written_error(one_way) <= 1e-13);
    const System back = one_way.update({{name, name[0] == 'p' ? 1.0 : 0.0}});
    CHECK(asymmetry(back) <= 1e-13);
    CHECK(written_error(back) <= 1e-13);
  }
}

TEST_CASE("dense model: flexible bodies in space, in a tree, on hubs") {
  Rng rng(5);
  Diagram d{"tree"};
  const auto F = d.input("F", 6);
  std::vector<BodyHandle> body;
  for (int i = 0; i < 40; ++i) {
    ModalData data = titop::generate::random_modes(rng, kModes, {"a", "b"}, false);
    for (int k = 0; k < kModes; ++k) data.omega(k) = std::exp2(k);
    data.xi.setConstant(1. / 128);
    body.push_back(d.add(fmt::format("b{}", i * 7 % 40 + 1), FlexibleBody(std::move(data))));
    if (i == 0) continue;
    const auto& carrier = body[static_cast<std::size_t>((i - 1) / 2)];
    mount(body.back(), carrier.child(i % 2 ? "a" : "b"), Rotation::matrix(rng.rotation()));
  }
  auto hub = d.add("hub", RigidBody{.mass = 20,
                                    .inertia = Eigen::Matrix3d::Identity(),
                                    .children = {{"p", {1, 0, 0}}, {"q", {0, 2, 1}}}});
  mount(body.front(), hub.child("p"), Rotation::matrix(rng.rotation()));
  hub.parent.force = -F;
  d.output("tip", 6) = body.back().child("a").accel;
  d.output("hub", 6) = hub.child("q").accel;
  const System system = compiled(d);
  CHECK(asymmetry(system) <= 1e-13);
  CHECK(written_error(system) <= 1e-13);
  StateSpace one, three;
  system.write(one, 1);
  system.write(three, 3);
  CHECK(one.A == three.A);
  CHECK(one.B == three.B);
  CHECK(one.C == three.C);
  CHECK(one.D == three.D);
}
