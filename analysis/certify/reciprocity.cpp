#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <set>
#include <titop/analysis/certify/reciprocity.hpp>
#include <titop/compiler/passes/check/springs.hpp>
#include <titop/compiler/system/system.hpp>
#include <titop/graph/linalg/index.hpp>
#include <titop/graph/linalg/rounding.hpp>

namespace titop::certification {
namespace {

using Complex = std::complex<double>;
using Eigen::Index;
using Eigen::MatrixXcd;
using Eigen::MatrixXd;

using linalg::at;

/// Place of the largest asymmetry of square matrices.
struct Asymmetry {
  double worst = 0;
  std::size_t point = 0;  ///< index
  Index row = 0, column = 0;
};

/// |G_ij - G_ji|, the latter with momenta reversed if there are any, block by block (entries of one
/// block share their unit) over the largest of sqrt(|G_ii| |G_jj|), the blocks themselves, and the
/// possible rounding of a 0.
void add_asymmetry(const DualTransfers& t, std::size_t k, Asymmetry& found) {
  const MatrixXcd &G = t.G[k], &R = t.reversed.empty() ? G : t.reversed[k];
  const auto largest = [](const auto& m) { return m.cwiseAbs().maxCoeff(); };
  if (!G.allFinite() || !R.allFinite()) {
    found = {HUGE_VAL, k, 0, 0};
    return;
  }
  const Eigen::VectorXd diagonal = G.diagonal().cwiseAbs();
  const std::vector<int>& sizes = t.by.rows;
  for (Index i = 0, r = 0; i < static_cast<Index>(sizes.size()); r += sizes[at(i++)])
    for (Index j = 0, c = 0; j <= (t.reversed.empty() ? i : std::ssize(sizes) - 1);
         c += sizes[at(j++)]) {
      const Index m = sizes[at(i)], n = sizes[at(j)];
      const auto a = G.block(r, c, m, n), b = R.block(c, r, n, m);
      Index row = 0, column = 0;
      const double off = (a - b.transpose()).cwiseAbs().maxCoeff(&row, &column);
      if (off == 0) continue;
      const double size = std::max({std::sqrt(diagonal.segment(r, m).maxCoeff()) *
                                        std::sqrt(diagonal.segment(c, n).maxCoeff()),
                                    largest(a), largest(b), t.floor(r, c, m, n)});
      if (off > found.worst * size) found = {off / size, k, r + row, c + column};
    }
}

Asymmetry asymmetry(const DualTransfers& t) {
  Asymmetry found;
  for (std::size_t k = 0; k < t.G.size(); ++k) add_asymmetry(t, k, found);
  return found;
}

/// Gains of an algebraic block of very many ports against one another.
bool is_symmetric(const Dynamics& d, const Eigen::VectorXd& sign) {
  return std::all_of(d.sparse.begin(), d.sparse.end(), [&](const Gains& g) {
    const auto rows = static_cast<int>(g.gain.rows()), cols = static_cast<int>(g.gain.cols());
    if (g.row + rows > sign.size() || g.column + cols > sign.size()) return true;  // one-way ports
    const MatrixXd a = sign.segment(g.row, rows).asDiagonal() * g.gain;
    const MatrixXd b =
        sign.segment(g.column, cols).asDiagonal() * d.direct(g.column, g.row, cols, rows);
    return (a - b.transpose()).cwiseAbs().maxCoeff() <=
           linalg::kAxisRounding * a.cwiseAbs().maxCoeff();
  });
}

/// A block's response from its channels' inputs to their outputs is symmetric, except for the sign
/// of the force at points whose block has the motion as input and outputs the force that acts on
/// it.
bool is_reciprocal(const Block& block, ParameterValues values, Complex s) {
  DualTransfers own{{s}, {}, {}};
  std::vector<double> signs;
  for (const ChannelSpec& c : block.interface().channels) {
    const bool inward = c.takes == Takes::accel && !is_outward(c);
    signs.insert(signs.end(), at(c.size), inward ? -1 : 1);
    const int each = c.size % 3 == 0 ? 3 : 1;
    own.by.rows.insert(own.by.rows.end(), at(c.size / each), each);
  }
  const Eigen::VectorXd sign =
      Eigen::Map<const Eigen::VectorXd>(signs.data(), static_cast<Index>(signs.size()));
  if (const auto d = block.dynamics(values); !d->sparse.empty()) return is_symmetric(*d, sign);
  const MatrixXcd Y = block.response(s, values).Y.topLeftCorner(sign.size(), sign.size());
  own.G = {sign.asDiagonal() * Y};
  return asymmetry(own).worst <= linalg::kAxisRounding;
}

/// Names a node whose block alone is not reciprocal; empty if all are. Shared blocks are checked
/// once.
std::string exception_among(const Graph& g, ParameterValues values, Complex s) {
  std::set<const Block*> seen;
  for (const Node& node : g.nodes)
    if (seen.insert(node.block.get()).second && !is_reciprocal(*node.block, values, s))
      return fmt::format(
          "{} is not reciprocal by itself: gyroscopic terms, or data that are not symmetric",
          node.name);
  return "";
}

}  // namespace

FullCertificate::Reciprocity check_reciprocity(const System& system, const passes::DualPairs& pairs,
                                               const DualTransfers& transfers,
                                               std::string no_structure, ParameterValues values) {
  FullCertificate::Reciprocity r;
  r.forces = static_cast<int>(pairs.in.size());
  if (r.forces < 2) {
    r.why_not = r.forces == 0 ? passes::DualPairs::kNone
                              : "a single force has no other to exchange places with";
    return r;
  }
  r.done = true;
  const std::vector<Complex>& points = transfers.points;
  if (no_structure.empty())
    no_structure = exception_among(*system.stage().source, values, points[points.size() / 2]);
  r.structure = no_structure.empty();
  r.reversed = r.structure && !transfers.reversed.empty();
  r.momenta = passes::gyroscopic_points(*system.stage().source, values);
  r.why_no_structure = std::move(no_structure);
  const Asymmetry found = asymmetry(transfers);
  if (found.worst == 0) return r;
  r.asymmetry = found.worst;
  r.where = points[found.point];
  r.first = system.inputs()[at(pairs.in[at(found.row)])];
  r.second = system.inputs()[at(pairs.in[at(found.column)])];
  return r;
}

}  // namespace titop::certification
