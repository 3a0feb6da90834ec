#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <titop/compiler/solve/data_digits.hpp>
#include <titop/compiler/solve/evaluate.hpp>
#include <titop/graph/data_digits.hpp>
#include <titop/graph/linalg/eigen.hpp>
#include <titop/graph/linalg/index.hpp>
#include <titop/graph/linalg/rounding.hpp>
#include <titop/graph/support/steady_random.hpp>

/// Motions and forces that the digits of modal data cannot determine. An error e of a block's
/// direct term D changes its inputs by u = K e, K from the joint system with all bodies mounted on
/// the block. With ports scaled to one unit, the error of a mass is `mass`: it makes the system
/// singular if |K| reaches 1 / mass. A port freed in a subspace F alone has K = F (F' D F)^-1 F':
/// this is the least eigenvalue of D there, for any directions in which joints, chains or equations
/// leave the port free. The error of shapes W enters W' W twice: |K| reaches 1 / shapes^2.
namespace titop::detail {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;
using linalg::at;
using solve::RowMatrix;

/// First all blocks by so many random errors at once. At least this share of the effect of one
/// block's error on its port is visible in one of them, except in one case of 10^4 at the limit.
constexpr int kSums = 4;
constexpr double kShows = 0.1;

constexpr std::size_t kMostNamed = 8;

struct DataPort {
  int node = -1, channel = -1;  ///< channel of the node's block
  int gives = -1, takes = -1;   ///< signals
  int group = -1;               ///< row group of its output
  bool by_shapes = false;       ///< its direct term is W' W
  const FromData* block = nullptr;

  double noise() const {
    const DataDigits& d = block->digits();
    return by_shapes ? d.shapes : d.mass;
  }
  /// |K| above which the data do not decide.
  double limit() const {
    return 1 / (by_shapes ? std::max(noise() * noise(), linalg::kProductRounding) : noise());
  }
};

class DigitJudge {
 public:
  explicit DigitJudge(const Factored& d)
      : k_(*d.skeleton), d_(d), g_(k_.stage.graph), rows_(real_rows(k_, d.numbers)) {
    find_ports();
  }

  std::vector<Note> judge() {
    note_contradictions();
    if (ports_.empty()) return std::move(notes_);
    std::vector<int> doubtful = by_sums();
    for (auto first = doubtful.begin(); first != doubtful.end() && mistakes_.size() < kMostNamed;) {
      const auto kind = [&](int p) {
        return std::pair(ports_[at(p)].node, ports_[at(p)].by_shapes);
      };
      const auto end =
          std::find_if(first, doubtful.end(), [&](int p) { return kind(p) != kind(*first); });
      decide({first, end});
      first = end;
    }
    if (!mistakes_.empty()) throw Error(std::move(mistakes_));
    return std::move(notes_);
  }

 private:
  void find_ports() {
    std::vector<int> group_of(g_.signals.size(), -1);
    for (int r = 0; r < static_cast<int>(k_.joint.rows.size()); ++r)
      if (const Row& row = k_.stage.rows[at(k_.joint.rows[at(r)])]; row.node >= 0)
        group_of[at(row.output)] = r;
    for (int n = 0; n < static_cast<int>(g_.nodes.size()); ++n) {
      const Node& node = g_.nodes[at(n)];
      const auto* const block = dynamic_cast<const FromData*>(node.block.get());
      if (!block || !d_.numbers.blocks[at(n)]->modes) continue;
      const int channels = static_cast<int>(node.block->interface().channels.size());
      for (const bool by_shapes : {true, false})
        for (int i = 0; i < channels; ++i) {
          const Channel& c = g_.channels[at(node.first_channel + i)];
          const bool force = c.takes == Takes::force;
          if (force != by_shapes) continue;
          const int gives = force ? c.accel : c.force, takes = force ? c.force : c.accel;
          if (group_of[at(gives)] >= 0)
            ports_.push_back({n, i, gives, takes, group_of[at(gives)], by_shapes, block});
        }
    }
  }

  /// Prescribed parents with children driven where the modes do not move them: refused if anything
  /// depends on the forces. Otherwise the body is not among the rows.
  void note_contradictions() {
    for (int n = 0; n < static_cast<int>(g_.nodes.size()); ++n)
      if (const auto* block = dynamic_cast<const FromData*>(g_.nodes[at(n)].block.get()))
        note_contradiction(n, *block);
  }

  /// Equations that drive an acceleration.
  std::vector<const Equation*> driving(const Channel& c) const {
    std::vector<const Equation*> result;
    for (const Equation& e : g_.equations)
      if (e.target == c.accel && !e.of_block) result.push_back(&e);
    return result;
  }

  void note_contradiction(int n, const FromData& block) {
    const Node& node = g_.nodes[at(n)];
    const int channels = static_cast<int>(node.block->interface().channels.size());
    const Modal* const modal = d_.numbers.blocks[at(n)]->modes.get();
    std::vector<int> driven;
    bool prescribed = false;
    for (int i = 0; i < channels; ++i) {
      const Channel& c = g_.channels[at(node.first_channel + i)];
      if (g_.signals[at(c.force)].active && g_.signals[at(c.accel)].active) return;
      const auto equations = driving(c);
      if (c.takes == Takes::force && !equations.empty()) driven.push_back(i);
      if (c.takes == Takes::accel)
        prescribed = std::ranges::any_of(equations, [&](const Equation* e) {
          return !e->terms.empty() && std::ranges::all_of(e->terms, [&](const Term& t) {
            return g_.signals[at(t.signal)].node < 0;
          });
        });
    }
    if (!prescribed) return;
    for (const int i : driven) {
      const Channel& c = g_.channels[at(node.first_channel + i)];
      const Signal& u = g_.signals[at(c.force)];
      for (const Equation* e : driving(c)) {
        const MatrixXd S = e->part.whole() ? MatrixXd::Identity(u.size, u.size) : e->part.rows();
        note_contradiction(node, block, i, S, modal, u.first);
      }
    }
  }

  /// Rows S of channel i are driven.
  void note_contradiction(const Node& node, const FromData& block, int i, MatrixXd S,
                          const Modal* modal, int first) {
    const VectorXd sizes = block.digits().size.segment(first, S.cols());
    for (Index k = 0; k < S.rows(); ++k)
      if (const double size = S.row(k).cwiseProduct(sizes.transpose()).norm(); size > 0)
        S.row(k) /= size;
    const MatrixXd moved = modal ? MatrixXd(S * modal->W.middleCols(first, S.cols()).transpose())
                                 : MatrixXd::Zero(S.rows(), 1);
    const Eigen::JacobiSVD<MatrixXd> svd(moved, Eigen::ComputeFullU);
    const Index last = S.rows() - 1;
    const double left = last < moved.cols() ? svd.singularValues()(last) : 0;
    if (left > block.digits().shapes) return;
    const Block::Cause cause =
        block.beyond_digits(i, S.transpose() * svd.matrixU().col(last), left);
    notes_.push_back({Note::Kind::warning, "digits",
                      fmt::format("{} is driven, the parent prescribed, and {} {}: these "
                                  "contradict each other. No output depends on it: left out ({})",
                                  channel_name(g_, node.first_channel + i), node.name, cause.why,
                                  cause.way_out)});
  }

  VectorXd size(const DataPort& p) const {
    const Signal& u = g_.signals[at(p.takes)];
    return p.block->digits().size.segment(u.first, u.size);
  }
  Index row(const DataPort& p) const { return k_.joint.plan->row_first[at(p.group)]; }

  /// The inputs of these ports, one below the other, times their sizes.
  MatrixXd inputs(const std::vector<int>& ports, const RowMatrix<double>& rhs) const {
    const RowMatrix<double> unknowns = d_.factors->solve(rhs);
    const RowMatrix<double> known = RowMatrix<double>::Zero(
        d_.layout().order() + static_cast<Index>(d_.layout().inputs.size()), rhs.cols());
    Index count = 0;
    for (const int p : ports) count += size(ports_[at(p)]).size();
    MatrixXd result(count, rhs.cols());
    Index first = 0;
    for (const int p : ports) {
      const VectorXd s = size(ports_[at(p)]);
      RowMatrix<double> u = RowMatrix<double>::Zero(s.size(), rhs.cols());
      rows_.add_value(ports_[at(p)].takes, unknowns, known, d_.layout().known_first, u.data());
      result.middleRows(first, s.size()) = s.asDiagonal() * u;
      first += s.size();
    }
    return result;
  }

  /// Ports to judge block by block: random errors of all data together change their input by a
  /// tenth of limit_of_doubt or more.
  std::vector<int> by_sums() const {
    std::vector<int> all(ports_.size()), result;
    RowMatrix<double> rhs = RowMatrix<double>::Zero(k_.joint.plan->unknowns, kSums);
    SteadyRandom random;
    for (std::size_t p = 0; p < ports_.size(); ++p) {
      all[p] = static_cast<int>(p);
      const VectorXd s = size(ports_[p]);
      for (Index i = 0; i < s.size(); ++i)
        for (int j = 0; j < kSums; ++j) rhs(row(ports_[p]) + i, j) = random.unit() * s(i);
    }
    const MatrixXd u = inputs(all, rhs);
    Index first = 0;
    for (const int p : all) {
      const Index n = size(ports_[at(p)]).size();
      if (!(u.middleRows(first, n).cwiseAbs().maxCoeff() < kShows * limit_of_doubt(ports_[at(p)])))
        result.push_back(p);
      first += n;
    }
    return result;
  }

  static double limit_of_doubt(const DataPort& p) {
    return p.limit() * (p.by_shapes ? linalg::kOneDigit * linalg::kOneDigit : linalg::kOneDigit);
  }

  /// These ports of one block, which all take forces or all accelerations.
  void decide(const std::vector<int>& ports) {
    Index count = 0;
    for (const int p : ports) count += size(ports_[at(p)]).size();
    RowMatrix<double> rhs = RowMatrix<double>::Zero(k_.joint.plan->unknowns, count);
    VectorXd sizes(count);
    Index first = 0;
    for (const int p : ports) {
      const VectorXd s = size(ports_[at(p)]);
      for (Index i = 0; i < s.size(); ++i) rhs(row(ports_[at(p)]) + i, first + i) = s(i);
      sizes.segment(first, s.size()) = s;
      first += s.size();
    }
    const Eigen::JacobiSVD<MatrixXd> svd(inputs(ports, rhs), Eigen::ComputeFullU);
    const DataPort& port = ports_[at(ports.front())];
    const double K = svd.singularValues()(0);
    if (K < limit_of_doubt(port)) return;
    const VectorXd u = svd.matrixU().col(0);
    double left = 1 / K;
    if (port.by_shapes) {
      // By the shapes themselves: their squares have half the digits.
      left = std::sqrt(left);
      if (K >= port.limit()) left = std::min(left, moved(ports, sizes, u));
    }
    report(ports, sizes, u, left);
  }

  /// |W u| of these ports, u times their sizes.
  double moved(const std::vector<int>& ports, const VectorXd& sizes, const VectorXd& u) const {
    const MatrixXd& W = d_.numbers.blocks[at(ports_[at(ports.front())].node)]->modes->W;
    VectorXd sum = VectorXd::Zero(W.rows());
    Index first = 0;
    for (const int p : ports) {
      const Signal& takes = g_.signals[at(ports_[at(p)].takes)];
      for (Index i = 0; i < takes.size; ++i, ++first)
        if (sizes(first) > 0) sum += W.col(takes.first + i) * (u(first) / sizes(first));
    }
    return sum.norm();
  }

  void report(const std::vector<int>& ports, const VectorXd& sizes, const VectorXd& u,
              double left) {
    // The port that has most of it.
    Index first = 0, best_first = 0;
    int best = ports.front();
    double most = -1;
    for (const int p : ports) {
      const Index n = size(ports_[at(p)]).size();
      if (const double norm = u.segment(first, n).norm(); norm > most)
        most = norm, best = p, best_first = first;
      first += n;
    }
    const DataPort& port = ports_[at(best)];
    const Index n = size(port).size();
    VectorXd direction = u.segment(best_first, n);
    for (Index i = 0; i < n; ++i)
      direction(i) = sizes(best_first + i) > 0 ? direction(i) / sizes(best_first + i) : 0;
    const Node& node = g_.nodes[at(port.node)];
    const std::string name = channel_name(g_, node.first_channel + port.channel);
    const Block::Cause cause = port.block->beyond_digits(port.channel, direction, left);
    // If an equation imposes the motion, no mode can follow it. Otherwise the result depends on all
    // bodies coupled to the port, and exact data determine it.
    const bool imposed =
        !port.by_shapes || !driving(g_.channels[at(node.first_channel + port.channel)]).empty();
    if (left > port.noise() || !imposed) {
      notes_.push_back(
          {Note::Kind::warning, "digits",
           fmt::format("{} {}: less than one digit of its effect is known", name, cause.why)});
      return;
    }
    const char* const how = port.by_shapes ? "is driven" : "is free";
    const char* const undecided = port.by_shapes ? "force" : "motion";
    mistakes_.push_back(
        {Code::improper,
         fmt::format("{} {} where the digits of its data do not determine its {}", name, how,
                     undecided),
         {fmt::format("{} {}", node.name, cause.why), "added at " + to_string(node.where)},
         cause.way_out});
  }

  const Skeleton& k_;
  const Factored& d_;
  const Graph& g_;
  const solve::JointRows<double> rows_;
  std::vector<DataPort> ports_;
  std::vector<Mistake> mistakes_;
  std::vector<Note> notes_;
};

}  // namespace

std::vector<Note> judge_data_digits(const Factored& d) { return DigitJudge(d).judge(); }

}  // namespace titop::detail
