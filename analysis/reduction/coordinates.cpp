#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <titop/analysis/reduction/coordinates.hpp>
#include <titop/analysis/reduction/coupled_springs.hpp>
#include <titop/graph/linalg/index.hpp>
#include <titop/graph/linalg/rounding.hpp>
#include <titop/graph/linalg/similarity_scaling.hpp>
#include <titop/graph/linalg/symmetric.hpp>

namespace titop::detail {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr const char* kWayOut =
    "remove controllers and filters from the scene (their signals become inputs and outputs), or "
    "give a spring its own joint";

using linalg::at;

[[noreturn]] void refuse(const std::string& message, std::vector<std::string> details = {}) {
  throw NoStructure(Code::bad_value, message, kWayOut, std::move(details));
}

/// The model of all blocks' states, before dependent ones are eliminated.
StateSpace model_of_blocks(const System& system, const SystemData& data) {
  StateSpace m;
  if (data.states.trivial()) {
    system.write(m);
    return m;
  }
  const Layout& l = data.layout();
  const auto n = l.order(), all = n + static_cast<Index>(l.inputs.size());
  const RateColumns r = rates(data, solve::RowMatrix<double>::Identity(all, all));
  m.A = r.xdot.leftCols(n);
  m.B = r.xdot.rightCols(all - n);
  m.C = r.y.leftCols(n);
  m.D = r.y.rightCols(all - n);
  m.states = l.states;
  m.inputs = l.inputs;
  m.outputs = l.outputs;
  return m;
}

/// Coordinates of all blocks, as pairs of states; position -1 for a rate without position.
struct StatePairs {
  std::vector<int> position, rate;
};

/// `rate_of`: of each state, -1 for none. One that inputs drive, too, is no position.
StatePairs find_pairs(const StateSpace& m, std::vector<int> rate_of) {
  const Index n = m.A.rows();
  std::vector<int> position_of(at(n), -1);
  for (Index i = 0; i < n; ++i) {
    if (!m.B.row(i).isZero(0)) rate_of[at(i)] = -1;
    const int found = rate_of[at(i)];
    if (found < 0) continue;
    if (position_of[at(found)] >= 0)
      refuse(fmt::format("{} is the rate of {} and of {}", m.states[at(found)],
                         m.states[at(position_of[at(found)])], m.states[at(i)]));
    position_of[at(found)] = static_cast<int>(i);
  }
  StatePairs pairs;
  for (Index i = 0; i < n; ++i) {
    if (rate_of[at(i)] >= 0) {
      if (position_of[at(i)] >= 0)
        refuse(fmt::format("{} integrates {}, which is a position",
                           m.states[at(position_of[at(i)])], m.states[at(i)]));
      continue;
    }
    pairs.position.push_back(position_of[at(i)]);
    pairs.rate.push_back(static_cast<int>(i));
  }
  return pairs;
}

/// Columns of the matrix, 0 if there is no such state.
MatrixXd columns(const MatrixXd& m, const std::vector<int>& which) {
  MatrixXd result = MatrixXd::Zero(m.rows(), static_cast<Index>(which.size()));
  for (std::size_t j = 0; j < which.size(); ++j)
    if (which[j] >= 0) result.col(static_cast<Index>(j)) = m.col(which[j]);
  return result;
}

/// Data of the coordinates of all blocks, before G is known.
struct Raw {
  StateSpace m;
  StatePairs pairs;
  std::vector<int> kept;  ///< coordinates that stay
  MatrixXd T;             ///< all from kept; 0 x 0: they are the same
  MatrixXd A_q, A_v;      ///< rates of kept from positions and rates of all
  MatrixXd A_k;           ///< A_q, from the forces of coupled springs instead of their positions
  std::vector<int> node;  ///< per coordinate of all
  VectorXd known;  ///< k of A_k = -G k, by a body's modes; of coupled springs 1; 0: not known
  std::vector<CoupledSpring> springs;

  Index all() const { return static_cast<Index>(pairs.rate.size()); }
  const std::string& name(Index i) const {
    const int q = pairs.position[at(i)];
    return m.states[at(q >= 0 ? q : pairs.rate[at(i)])];
  }
};

void find_owners(Raw& raw, const SystemData& data) {
  const Layout& l = data.layout();
  std::vector<int> node_of(at(raw.m.A.rows()), -1);
  VectorXd stiffness = VectorXd::Zero(raw.m.A.rows());
  for (const int i : l.state_nodes) {
    const Dynamics& d = *data.numbers.blocks[at(i)];
    const int first = l.state_first[at(i)];
    for (Index k = 0; k < d.A.rows(); ++k) node_of[at(first + k)] = i;
    if (d.modes) stiffness.segment(first, d.modes->stiffness.size()) = d.modes->stiffness;
  }
  raw.known = VectorXd::Zero(raw.all());
  for (Index i = 0; i < raw.all(); ++i) {
    raw.node.push_back(node_of[at(raw.pairs.rate[at(i)])]);
    if (const int q = raw.pairs.position[at(i)]; q >= 0) raw.known(i) = stiffness(q);
  }
}

void find_coupled_springs(Raw& raw, const SystemData& data) {
  std::vector<int> coordinate(at(raw.m.A.rows()), -1);
  for (Index i = 0; i < raw.all(); ++i)
    if (const int q = raw.pairs.position[at(i)]; q >= 0) coordinate[at(q)] = static_cast<int>(i);
  raw.springs = coupled_springs(data, coordinate);
  for (const CoupledSpring& s : raw.springs)
    for (const int i : s.list) raw.known(i) = 1;
}

/// The kept coordinates, and the map from them to all.
void find_kept(Raw& raw, const StateMap& states) {
  std::vector<int> coordinate(at(raw.m.A.rows()), -1);
  for (Index i = 0; i < raw.all(); ++i) {
    coordinate[at(raw.pairs.rate[at(i)])] = static_cast<int>(i);
    if (const int q = raw.pairs.position[at(i)]; q >= 0) coordinate[at(q)] = static_cast<int>(i);
  }
  std::vector<char> leaves(at(raw.all()), 0);
  for (const StateMap::DependentRow& row : states.dependent())
    leaves[at(coordinate[at(row.state)])] = 1;
  for (Index i = 0; i < raw.all(); ++i)
    if (!leaves[at(i)]) raw.kept.push_back(static_cast<int>(i));
  if (states.trivial()) return;
  raw.T = MatrixXd::Zero(raw.all(), static_cast<Index>(raw.kept.size()));
  for (std::size_t k = 0; k < raw.kept.size(); ++k) raw.T(raw.kept[k], static_cast<Index>(k)) = 1;
  for (const StateMap::DependentRow& row : states.dependent()) {
    const int i = coordinate[at(row.state)];
    if (raw.pairs.rate[at(i)] != row.state) continue;  // positions follow the same map
    for (const auto& [of, factor] : row.of) {
      const int j = coordinate[at(of)];
      if (leaves[at(j)])  // and is not known yet: keep its rate
        refuse(
            fmt::format("{} follows from {} at one level only", raw.name(i), raw.m.states[at(of)]));
      raw.T.row(i) += factor * raw.T.row(j);
    }
    leaves[at(i)] = 0;
  }
}

Raw read(const System& system, const SystemData& data) {
  Raw raw;
  raw.m = model_of_blocks(system, data);
  raw.pairs = find_pairs(raw.m, rates_of(data.graph(), data.layout(), raw.m.A));
  find_owners(raw, data);
  find_coupled_springs(raw, data);
  find_kept(raw, data.states);
  std::vector<int> rows;
  for (const int i : raw.kept) rows.push_back(raw.pairs.rate[at(i)]);
  raw.A_q = columns(raw.m.A(rows, Eigen::all), raw.pairs.position);
  raw.A_v = columns(raw.m.A(rows, Eigen::all), raw.pairs.rate);
  raw.A_k = raw.A_q;
  for (const CoupledSpring& s : raw.springs)
    raw.A_k(Eigen::all, s.list) =
        solve_definite(s.K, raw.A_q(Eigen::all, s.list).transpose()).transpose();
  return raw;
}

/// Stiffnesses k of the coordinates `list` (rows and columns of A = -G k), so that G is symmetric:
/// k_i / k_j = A_ji / A_ij, from those that are known along the strongest couplings; those that are
/// rounding couple nothing.
VectorXd stiffnesses(const MatrixXd& A, const VectorXd& known) {
  const Index n = A.rows();
  VectorXd k = known, best = VectorXd::Constant(n, linalg::kAxisRounding * linalg::kAxisRounding);
  std::vector<Index> from(at(n), -1);
  const auto offer = [&](Index i) {
    for (Index j = 0; j < n; ++j) {
      if (k(j) != 0 || !(A(i, j) * A(j, i) > 0)) continue;
      const double strength = A(i, j) / A(i, i) * (A(j, i) / A(j, j));
      if (strength > best(j)) best(j) = strength, from[at(j)] = i;
    }
  };
  for (Index i = 0; i < n; ++i)
    if (k(i) != 0) offer(i);
  while (true) {
    Index next = -1;
    for (Index j = 0; j < n; ++j)
      if (k(j) == 0 && (next < 0 || best(j) > best(next))) next = j;
    if (next < 0) return k;
    const Index i = from[at(next)];
    // A part without modes: at rest any mass will do, so 1; with rotors scale_masses finds it.
    k(next) = i < 0 ? std::abs(A(next, next)) : k(i) * A(i, next) / A(next, i);
    offer(next);
  }
}

/// Stiffness of all coordinates q = T q_kept by symmetry, T A_k = -(T G T') k; of coupled
/// springs 1. A dependent coordinate that moves by rounding only has none.
VectorXd all_stiffnesses(const Raw& raw) {
  const bool closed = raw.T.size() > 0;
  const MatrixXd rates = closed ? MatrixXd(raw.T * raw.A_k) : raw.A_k;
  std::vector<int> list;
  for (int i = 0; i < raw.all(); ++i) {
    if (raw.A_k.col(i).isZero(0)) continue;
    const bool acts = rates(i, i) < 0, kept = std::ranges::binary_search(raw.kept, i);
    if (kept && !acts)
      refuse(fmt::format("{} has no spring of its own, but acts on other states", raw.name(i)));
    if (acts) list.push_back(i);
  }
  VectorXd k = VectorXd::Zero(raw.all());
  k(list) = stiffnesses(rates(list, list), raw.known(list));
  return k;
}

/// Refuses other effects of a coupled spring's rates than those of its own damping.
void check_damping(const Raw& raw, const CoupledSpring& s) {
  const MatrixXd by_force = raw.A_k(Eigen::all, s.list), v = raw.A_v(Eigen::all, s.list);
  const MatrixXd off = v - by_force * s.C, terms = by_force.cwiseAbs() * s.C.cwiseAbs();
  for (Index j = 0; j < v.cols(); ++j)
    if (!(off.col(j).norm() <= kSymmetric * terms.col(j).norm()))
      refuse(fmt::format("the rate of {} acts on other states than the damping of its bushing",
                         raw.name(s.list[at(j)])));
}

/// Damping of each coordinate: its column of A_v is that of A_q times c / k; 0 of coupled springs.
VectorXd dampings(const Raw& raw, const VectorXd& k) {
  VectorXd c = VectorXd::Zero(raw.all());
  std::vector<char> coupled(at(raw.all()), 0);
  for (const CoupledSpring& s : raw.springs) {
    check_damping(raw, s);
    for (const int i : s.list) coupled[at(i)] = 1;
  }
  for (Index i = 0; i < raw.all(); ++i) {
    if (coupled[at(i)]) continue;
    const auto v = raw.A_v.col(i), q = raw.A_q.col(i);
    const double size = v.norm();
    if (size == 0) continue;
    if (q.norm() == 0)
      refuse(fmt::format("the rate of {} acts on other states, and it has no spring", raw.name(i)));
    const double ratio = v.dot(q) / q.squaredNorm();
    if ((v - ratio * q).norm() > kSymmetric * size || ratio < 0)
      refuse(
          fmt::format("the rate of {} acts on other states than its spring: no proportional damper",
                      raw.name(i)));
    c(i) = ratio * k(i);
  }
  return c;
}

/// T' S T, S: this diagonal, and the matrices of the coupled springs.
MatrixXd congruent(const VectorXd& diagonal, const Raw& raw, MatrixXd CoupledSpring::*matrix,
                   const MatrixXd& T) {
  MatrixXd ST = diagonal.asDiagonal() * T;
  for (const CoupledSpring& s : raw.springs)
    ST(s.list, Eigen::all) = s.*matrix * T(s.list, Eigen::all);
  return T.transpose() * ST;
}

/// G = -A_ee K^-1, symmetric up to rounding, or refused.
MatrixXd flexibility(const Coordinates& c, const MatrixXd& A_ee) {
  MatrixXd G = -A_ee;
  if (c.diagonal) {
    for (Index j = 0; j < G.cols(); ++j) G.col(j) /= c.K(j, j);
  } else {
    G = solve_definite(c.K, G.transpose()).transpose();
  }
  for (Index i = 0; i < G.rows(); ++i) {
    if (!(G(i, i) > 0))
      refuse(fmt::format("a force on {} accelerates it in the opposite direction", c.names[at(i)]));
    for (Index j = 0; j < i; ++j) {
      const double off = std::abs(G(i, j) - G(j, i)) / std::sqrt(G(i, i)) / std::sqrt(G(j, j));
      if (!(off <= kSymmetric))
        refuse(fmt::format("the coupling of {} and {} is not symmetric", c.names[at(i)],
                           c.names[at(j)]),
               {fmt::format("reciprocal to {:.1g} only", off)});
    }
  }
  return (G + G.transpose()) / 2;
}

/// |entries| on the scale of the diagonal, rounding as 0.
MatrixXd couplings(const MatrixXd& m) {
  const VectorXd d = m.diagonal().cwiseSqrt().cwiseInverse();
  const MatrixXd X = (d.asDiagonal() * m * d.asDiagonal()).cwiseAbs();
  return (X.array() > linalg::kAxisRounding).select(X, 0);
}

/// Parts of coupled coordinates, of which none has a known stiffness.
std::vector<std::vector<int>> unscaled(const Coordinates& c, const VectorXd& known) {
  std::vector<std::vector<int>> parts = linalg::uncoupled_parts(couplings(c.G) + couplings(c.K));
  std::erase_if(parts, [&](const std::vector<int>& part) { return !known(part).isZero(0); });
  return parts;
}

void find_shares(Coordinates& c, const Graph& graph) {
  std::map<int, Index> row;
  for (const int node : c.nodes)
    if (row.emplace(node, static_cast<Index>(row.size())).second)
      c.blocks.push_back(graph.nodes[at(node)].name);
  c.shares = MatrixXd::Zero(static_cast<Index>(row.size()), c.n_elastic);
  for (Index i = 0; i < c.n_elastic; ++i) c.shares(row[c.nodes[at(i)]], i) = 1;
}

/// Those with stiffness first.
std::vector<Index> elastic_first(const MatrixXd& A_total, Index& n_elastic) {
  std::vector<Index> order, loose;
  for (Index j = 0; j < A_total.cols(); ++j)
    (A_total.col(j).cwiseAbs().maxCoeff() > 0 ? order : loose).push_back(j);
  n_elastic = static_cast<Index>(order.size());
  order.insert(order.end(), loose.begin(), loose.end());
  return order;
}

}  // namespace

Coordinates coordinates(const System& system, const SystemData& data) {
  Coordinates c;
  const Raw raw = read(system, data);
  c.silent = MatrixXd::Zero(raw.m.C.rows(), 2);
  if (raw.all() == 0) {
    c.B.resize(0, raw.m.B.cols());
    c.C_q.resize(raw.m.C.rows(), 0);
    c.C_v = c.C_q;
    c.direct = raw.m.D;
    return c;
  }
  const VectorXd k = all_stiffnesses(raw), damping = dampings(raw, k);
  const bool closed = raw.T.size() > 0;
  const MatrixXd A_total = closed ? MatrixXd(raw.A_q * raw.T) : raw.A_q;
  const std::vector<Index> order = elastic_first(A_total, c.n_elastic);
  const std::vector<Index> elastic(order.begin(), order.begin() + c.n_elastic);
  const std::vector<Index> loose(order.begin() + c.n_elastic, order.end());
  std::vector<int> rows, positions;
  for (const Index j : order) {
    const int i = raw.kept[at(j)];
    c.names.push_back(raw.name(i));
    c.nodes.push_back(raw.node[at(i)]);
    rows.push_back(raw.pairs.rate[at(i)]);
    positions.push_back(raw.pairs.position[at(i)]);
  }
  const std::vector<int>& kept_states = data.states.kept();
  const auto place = [&](int state) {
    return state < 0
               ? -1
               : static_cast<int>(std::lower_bound(kept_states.begin(), kept_states.end(), state) -
                                  kept_states.begin());
  };
  for (std::size_t i = 0; i < rows.size(); ++i) {
    c.rate.push_back(place(rows[i]));
    c.position.push_back(place(positions[i]));
  }
  MatrixXd T = MatrixXd::Zero(raw.all(), A_total.cols());
  if (closed)
    T = raw.T;
  else
    for (std::size_t j = 0; j < raw.kept.size(); ++j) T(raw.kept[j], static_cast<Index>(j)) = 1;
  c.diagonal = !closed && raw.springs.empty();
  const auto full = [&](const VectorXd& diagonal, MatrixXd CoupledSpring::*matrix) {
    return c.diagonal ? MatrixXd(diagonal(elastic).asDiagonal())
                      : congruent(diagonal, raw, matrix, T(Eigen::all, elastic));
  };
  c.K = full(k, &CoupledSpring::K);
  c.D = full(damping, &CoupledSpring::C);
  if (c.D.isZero(0)) c.D.resize(0, 0);
  c.G = flexibility(c, A_total(elastic, elastic));
  // Of a kept coordinate also if one that follows from it has a known stiffness.
  const VectorXd known =
      closed ? VectorXd(raw.T.transpose().cwiseAbs() * raw.known) : VectorXd(raw.known(raw.kept));
  c.unscaled = unscaled(c, known(elastic));
  c.A_loose = A_total(loose, elastic);
  c.B = raw.m.B(rows, Eigen::all);
  c.C_q = columns(raw.m.C, raw.pairs.position) * T(Eigen::all, order);
  c.C_v = columns(raw.m.C, raw.pairs.rate) * T(Eigen::all, order);
  c.direct = raw.m.D;
  find_shares(c, data.graph());
  return c;
}

}  // namespace titop::detail
