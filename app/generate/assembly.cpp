#include "generate/assembly.hpp"

#include <map>

#include "generate/controls.hpp"
#include "generate/tables.hpp"

namespace titop::generate {
namespace {

/// Columns by kind: free coordinates, coordinates of an imposed base, locked coordinates.
struct CoordinateColumns {
  std::vector<std::size_t> free, imposed, held;
  std::size_t count = 0;
};

template <class S>
class ManualAssembly {
 public:
  explicit ManualAssembly(const ScenePlan& plan) : plan_(plan) {
    for (const PlannedBlock& b : plan.blocks) count(b);
    for (std::size_t i = 0; i < plan.inputs.size(); ++i) {
      first_input_[plan.inputs[i].name] = inputs_;
      inputs_ += static_cast<std::size_t>(plan.inputs[i].size);
    }
    M_ = D_ = K_ = Table<S>(columns.count, columns.count);
    for (const Control& c : plan.controls) channel_.push_back(channels_), channels_ += c.size();
    F_ = Table<S>(columns.count, inputs_ + channels_);
    for (std::size_t i = 0; i < plan.blocks.size(); ++i) add(static_cast<int>(i));
    for (const Load& load : plan.loads) add(load);
    for (std::size_t k = 0; k < plan.controls.size(); ++k)
      add(plan.controls[k], inputs_ + channel_[k]);
    close();
  }

  CoordinateColumns columns;
  bool independent() const { return rank(G_.cols(columns.free)) == G_.rows(); }

  FirstOrder<S> model() {
    solve_motion();
    Table<S> y(0, states_ + F_.cols()), e = y;
    for (const PlannedReading& r : plan_.readings) y.append(reading(r));
    for (const Control& c : plan_.controls) e.append(measured(c));
    return Controls<S>(plan_.controls, states_, inputs_).around(state_rows(), y, e);
  }

 private:
  /// Coordinates: six (or one) of a base without parent, the stretch, the angle, the modes.
  void count(const PlannedBlock& b) {
    first_.push_back(columns.count);
    const auto take = [&](std::vector<std::size_t>& kind) { kind.push_back(columns.count++); };
    const bool scalar = b.spring.has_value();
    if (b.base.kind != Attachment::Kind::mounted)
      for (int i = 0; i < (scalar ? 1 : 6); ++i) {
        const bool held = b.base.kind == Attachment::Kind::ground ||
                          (b.base.kind == Attachment::Kind::pinned && (scalar || i < 3));
        take(held                                       ? columns.held
             : b.base.kind == Attachment::Kind::imposed ? columns.imposed
                                                        : columns.free);
      }
    own_.push_back(columns.count);
    const std::size_t own = b.body ? b.body->omega.size() : 1;
    for (std::size_t i = 0; i < own; ++i) take(columns.free);
  }

  std::size_t input(const std::string& name) const { return first_input_.at(name); }
  const Table<S>& motion(const PlannedPoint& p) const { return motions_.at({p.block, p.channel}); }

  Table<S> base_motion(std::size_t i) {
    const PlannedBlock& b = plan_.blocks[i];
    const auto size = static_cast<std::size_t>(b.size());
    if (b.base.kind == Attachment::Kind::mounted) {
      const Table<S>& site = motion(b.base.on);
      if (b.base.along) return row<S>(*b.base.along) * site.rows({0, 1, 2});
      return b.spring ? site : dual<S>(transposed(b.base.T)) * site;
    }
    Table<S> P(size, columns.count);
    P.add(identity<S>(size), 0, first_[i]);
    return P;
  }

  void add(int block) {
    const auto i = static_cast<std::size_t>(block);
    const PlannedBlock& b = plan_.blocks[i];
    const Table<S> P = base_motion(i);
    motions_[{block, "parent"}] = P;
    if (!b.base.input.empty() && b.base.kind != Attachment::Kind::imposed)
      load(P.rows(free_rows(b)), input(b.base.input));
    if (b.spring) add_spring(block, *b.spring, P);
    if (b.joint) add_joint(block, *b.joint, P);
    if (b.body) add_body(block, *b.body, P);
  }

  /// The directions of a base in which its input acts.
  static std::vector<std::size_t> free_rows(const PlannedBlock& b) {
    if (b.spring) return {0};
    if (b.base.kind == Attachment::Kind::pinned) return {3, 4, 5};
    return {0, 1, 2, 3, 4, 5};
  }

  void load(const Table<S>& motion, std::size_t column) { F_.add(motion.transposed(), 0, column); }

  void add_spring(int block, const Spring& z, const Table<S>& P) {
    const std::size_t d = own_[static_cast<std::size_t>(block)];
    Table<S> C = P;
    C(0, d) += S(1);
    add_mass(C, exactly<S>(z.mass));
    add_mass(P, exactly<S>(z.parent_mass));
    K_(d, d) += exactly<S>(z.stiffness);
    D_(d, d) += exactly<S>(z.damping);
    motions_[{block, "child"}] = C;
  }

  void add_mass(const Table<S>& X, const S& m) {
    Table<S> weighted = X;
    for (std::size_t i = 0; i < X.rows(); ++i)
      for (std::size_t j = 0; j < X.cols(); ++j) weighted(i, j) = m * X(i, j);
    M_.add(X.transposed() * weighted);
  }

  void add_joint(int block, const PlannedJoint& h, const Table<S>& P) {
    const std::size_t q = own_[static_cast<std::size_t>(block)];
    Table<S> C = P;
    C.add(row<S>(h.axis).transposed(), h.turns ? 3 : 0, q);
    K_(q, q) += exactly<S>(h.stiffness);
    D_(q, q) += exactly<S>(h.damping);
    if (!h.input.empty()) F_(q, input(h.input)) += S(1);
    motions_[{block, "child"}] = C;
  }

  /// [Alazard 2015] eq. (9): kinetic energy of [xd_P; etad] with the mass [D_P, L'; L, 1].
  void add_body(int block, const Body& b, const Table<S>& P) {
    const std::size_t q = own_[static_cast<std::size_t>(block)], n = b.omega.size();
    Table<S> eta(n, columns.count);
    eta.add(identity<S>(n), 0, q);
    const Table<S> L = table<S>(b.L, 6), at_mass = tau<S>(b.PA) * P;
    for (std::size_t i = 0; i < 3; ++i) add_mass(at_mass.rows({i}), exactly<S>(b.mass));
    for (std::size_t i = 0; i < 3; ++i) add_mass(at_mass.rows({3 + i}), exactly<S>(b.inertia[i]));
    add_mass(eta, S(1));
    const Table<S> coupling = P.transposed() * L.transposed() * eta;
    M_.add(coupling);
    M_.add(coupling.transposed());
    for (std::size_t i = 0; i < n; ++i) {
      const S omega = exactly<S>(b.omega[i]);
      K_(q + i, q + i) += omega * omega;
      D_(q + i, q + i) += S(2) * exactly<S>(b.xi[i]) * omega;
    }
    for (const BodyPoint& c : b.points)
      motions_[{block, c.name}] = tau<S>(c.PC) * P + table<S>(c.Phi, n) * eta;
  }

  void add(const Load& l) {
    const Table<S>& X = motion(l.point);
    Table<S> pushed = part_rows<S>(l.part, X.rows()) * X;
    for (std::size_t i = 0; i < pushed.rows(); ++i)
      for (std::size_t j = 0; j < pushed.cols(); ++j)
        pushed(i, j) = exactly<S>(l.gain) * pushed(i, j);
    load(pushed, input(l.input));
  }

  /// Reaction of the controller's forces.
  void add(const Control& c, std::size_t column) {
    if (c.law == Control::Law::filter) return;
    const bool joint = c.law == Control::Law::position &&
                       plan_.blocks[static_cast<std::size_t>(c.block)].joint.has_value();
    if (joint)
      F_(own_[static_cast<std::size_t>(c.block)], column) += S(-1);
    else
      for (const ControlPoint& at : c.at) load(-motion_along(at), column++);
  }

  Table<S> motion_along(const ControlPoint& at) const {
    if (!at.along) return motion(at.point);
    return part_rows<S>({PlannedPart::Kind::along, *at.along}, 6) * motion(at.point);
  }

  void close() {
    G_ = Table<S>(0, columns.count);
    for (const Closure& c : plan_.closures) {
      Table<S> gap = motion(c.point);
      if (c.with) {
        const Table<S>& other = motion(*c.with);
        gap.add(-(gap.rows() == 1 ? other : dual<S>(transposed(c.T)) * other));
      }
      G_.append(gap);
    }
  }

  /// Coordinates as rows over [states | inputs | controls]: q, qd, qdd. States: the independent
  /// free coordinates z and their rates, the imposed ones and theirs.
  void solve_motion() {
    const auto& f = columns.free;
    const auto& p = columns.imposed;
    const Table<S> N = null_space(G_.cols(f));
    nz_ = N.cols();
    states_ = 2 * nz_ + 2 * p.size();
    const std::size_t width = states_ + F_.cols(), r = 2 * nz_;
    q_ = qd_ = qdd_ = Table<S>(columns.count, width);
    put(q_, f, N, 0), put(qd_, f, N, nz_);
    put(q_, p, identity<S>(p.size()), r), put(qd_, p, identity<S>(p.size()), r + p.size());
    put(qdd_, p, imposed_inputs(), states_);
    // M qdd = F u - D qd - K q, projected.
    const Table<S> rest = forces(q_, qd_, qdd_);
    const Table<S> M = N.transposed() * M_.rows(f).cols(f) * N;
    put(qdd_, f, N * solve(M, N.transposed() * rest.rows(f)), 0);
  }

  /// F u - D qd - K q - M qdd, generalized, over [states | inputs | controls].
  Table<S> forces(const Table<S>& q, const Table<S>& qd, const Table<S>& qdd) const {
    Table<S> rest(columns.count, q.cols());
    rest.add(F_, 0, states_);
    rest.add(-(D_ * qd + K_ * q + M_ * qdd));
    return rest;
  }

  static void put(Table<S>& all, const std::vector<std::size_t>& rows, const Table<S>& values,
                  std::size_t col) {
    for (std::size_t i = 0; i < rows.size(); ++i)
      for (std::size_t j = 0; j < values.cols(); ++j) all(rows[i], col + j) += values(i, j);
  }

  /// Input that imposes each coordinate.
  Table<S> imposed_inputs() const {
    Table<S> a(columns.imposed.size(), F_.cols());
    std::size_t k = 0;
    for (const PlannedBlock& b : plan_.blocks)
      if (b.base.kind == Attachment::Kind::imposed)
        for (int i = 0; i < b.size(); ++i)
          a(k++, input(b.base.input) + static_cast<std::size_t>(i)) = S(1);
    return a;
  }

  Table<S> state_rows() const {
    const std::size_t np = columns.imposed.size();
    Table<S> xdot(states_, states_ + F_.cols());
    for (std::size_t i = 0; i < nz_; ++i) xdot(i, nz_ + i) = S(1);
    for (std::size_t i = 0; i < np; ++i) xdot(2 * nz_ + i, 2 * nz_ + np + i) = S(1);
    const Table<S> N = null_space(G_.cols(columns.free));
    // zdd from qdd = N zdd: by the rows in which N is the unit matrix.
    for (std::size_t k = 0; k < nz_; ++k)
      xdot.add(qdd_.rows({columns.free[unit_row(N, k)]}), nz_ + k);
    for (std::size_t i = 0; i < np; ++i)
      xdot.add(qdd_.rows({columns.imposed[i]}), 2 * nz_ + np + i);
    return xdot;
  }

  static std::size_t unit_row(const Table<S>& N, std::size_t k) {
    for (std::size_t i = 0; i < N.rows(); ++i) {
      bool unit = magnitude(N(i, k) - S(1)) == 0;
      for (std::size_t j = 0; j < N.cols(); ++j) unit = unit && (j == k || magnitude(N(i, j)) == 0);
      if (unit) return i;
    }
    throw std::logic_error("no unit row");
  }

  Table<S> reading(const PlannedReading& r) const {
    const auto block = static_cast<std::size_t>(r.point.block);
    if (r.of == PlannedReading::Of::relative) return q_.rows({own_[block]});
    if (r.of == PlannedReading::Of::control) {
      Table<S> v(plan_.controls[block].size(), states_ + F_.cols());
      v.add(identity<S>(v.rows()), 0, states_ + inputs_ + channel_[block]);
      return v;
    }
    if (r.of == PlannedReading::Of::reaction) return holding(r.point);
    if (r.of == PlannedReading::Of::support) {
      // Force required on the base in addition to all other forces; the port has the force that the
      // body exerts there.
      std::vector<std::size_t> base;
      for (int i = 0; i < plan_.blocks[block].size(); ++i)
        base.push_back(first_[block] + static_cast<std::size_t>(i));
      Table<S> all = forces(q_, qd_, qdd_);
      if (G_.rows() > 0) all.add(G_.transposed() * multipliers());
      return all.rows(base);
    }
    const Table<S>& X = motion(r.point);
    return part_rows<S>(r.part, X.rows()) * X * (r.of == PlannedReading::Of::position ? q_ : qdd_);
  }

  /// G' lambda = M qdd - F u + D qd + K q on the free coordinates.
  Table<S> multipliers() const {
    const Table<S> G = G_.cols(columns.free), Gt = G.transposed();
    return solve(G * Gt, G * -forces(q_, qd_, qdd_).rows(columns.free));
  }

  Table<S> holding(const PlannedPoint& point) const {
    std::size_t row = 0;
    for (const Closure& c : plan_.closures) {
      const std::size_t size = motion(c.point).rows();
      std::vector<std::size_t> list;
      for (std::size_t i = 0; i < size; ++i) list.push_back(row + i);
      if (c.point.block == point.block && c.point.channel == point.channel)
        return multipliers().rows(list);
      row += size;
    }
    throw std::logic_error("the point is in no constraint");
  }

  Table<S> measured(const Control& c) const {
    if (c.law == Control::Law::position) return q_.rows({own_[static_cast<std::size_t>(c.block)]});
    Table<S> e(0, qdd_.cols());
    for (const ControlPoint& at : c.at) e.append(motion_along(at) * qdd_);
    return e;
  }

  const ScenePlan& plan_;
  std::vector<std::size_t> first_, own_;  ///< columns of each block: its base, its own
  std::map<std::string, std::size_t> first_input_;
  std::size_t inputs_ = 0, channels_ = 0, nz_ = 0, states_ = 0;
  std::vector<std::size_t> channel_;  ///< first output of each controller
  std::map<std::pair<int, std::string>, Table<S>> motions_;
  Table<S> M_, D_, K_, F_, G_;
  Table<S> q_, qd_, qdd_;
};

}  // namespace

template <class S>
FirstOrder<S> assemble(const ScenePlan& plan) {
  return ManualAssembly<S>(plan).model();
}

bool closures_independent(const ScenePlan& plan) { return ManualAssembly<Mod>(plan).independent(); }

template FirstOrder<Mod> assemble(const ScenePlan&);
template FirstOrder<Digits> assemble(const ScenePlan&);

}  // namespace titop::generate
