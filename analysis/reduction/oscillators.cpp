#include <cmath>
#include <limits>
#include <numeric>
#include <titop/analysis/reduction/oscillators.hpp>
#include <titop/graph/linalg/eigen.hpp>
#include <titop/graph/linalg/index.hpp>
#include <titop/graph/linalg/rounding.hpp>
#include <titop/graph/linalg/similarity_scaling.hpp>
#include <titop/graph/nodes/lti.hpp>

namespace titop::detail {
namespace {

using Eigen::Index;
using Eigen::Matrix2d;
using Eigen::MatrixXd;
using Eigen::RowVector2d;
using Eigen::VectorXd;

/// Terms of omega^2 = a b - c d, and of det T, over it: more of them would cost it a digit.
constexpr double kTerms = 10;
/// Of two columns of B, in roundings of their cross product: they move the part in one direction.
constexpr double kOneDirection = 8 * linalg::kEpsilon;

/// A part in coordinate and rate, z = T x.
struct Oscillator {
  double stiffness = 0, damping = 0;
  Matrix2d T;
};

/// A row t with t B = 0: the coordinate that inputs move by its rate only. None if columns of B
/// have two directions.
std::optional<RowVector2d> unmoved(const MatrixXd& B) {
  Index largest = 0;
  if (B.cwiseAbs().colwise().sum().maxCoeff(&largest) == 0) return RowVector2d(1, 0);
  const Eigen::Vector2d b = B.col(largest) / B.col(largest).cwiseAbs().maxCoeff();
  for (Index j = 0; j < B.cols(); ++j) {
    // Columns of any size, whose product may be no number.
    const Eigen::Vector2d c =
        B.col(j) / std::max(B.col(j).cwiseAbs().maxCoeff(), std::numeric_limits<double>::min());
    const double one = b(0) * c(1), other = b(1) * c(0);
    if (std::abs(one - other) > kOneDirection * (std::abs(one) + std::abs(other)))
      return std::nullopt;
  }
  // Of a coordinate as it is, the unit stays.
  return b(0) == 0 ? RowVector2d(1, 0) : b(1) == 0 ? RowVector2d(0, 1) : RowVector2d(b(1), -b(0));
}

/// True if these two terms leave all digits but one of their difference.
bool differ(double one, double other) {
  return std::abs(one) + std::abs(other) <= kTerms * std::abs(one - other);
}

std::optional<Oscillator> oscillator(const Matrix2d& A, const MatrixXd& B) {
  const double one = A(0, 0) * A(1, 1), other = A(0, 1) * A(1, 0);
  Oscillator o{.stiffness = one - other, .damping = -A.trace(), .T = {}};
  if (!(o.stiffness > 0) || !(o.damping >= 0) || !differ(one, other)) return std::nullopt;
  const std::optional<RowVector2d> t = unmoved(B);
  if (!t) return std::nullopt;
  o.T << *t, *t * A;
  // The rate is another combination than the coordinate: t is no left eigenvector.
  if (!differ(o.T(0, 0) * o.T(1, 1), o.T(0, 1) * o.T(1, 0))) return std::nullopt;
  return o;
}

Oscillators sized(const Dynamics& d, Index count) {
  return {VectorXd(count),
          VectorXd(count),
          MatrixXd(count, d.B.cols()),
          MatrixXd(d.C.rows(), count),
          MatrixXd(d.C.rows(), count),
          {}};
}

/// Unit of a coordinate, a power of two, in which input and outputs act on it alike, as they do on
/// the modes of a structure: modes of any units are projected together.
double unit(const Eigen::RowVectorXd& b, const MatrixXd& C, double stiffness) {
  const double in = b.norm(),
               out = std::hypot(C.col(0).norm(), std::sqrt(stiffness) * C.col(1).norm());
  return in > 0 && out > 0 ? std::exp2(std::round((std::log2(out) - std::log2(in)) / 2)) : 1;
}

struct OscillatorParts {
  std::vector<std::pair<std::vector<int>, Oscillator>> parts;
  std::vector<int> others;
};

OscillatorParts find(const Dynamics& d) {
  OscillatorParts found;
  for (std::vector<int>& part : linalg::uncoupled_parts(d.A)) {
    std::optional<Oscillator> o;
    if (part.size() == 2) o = oscillator(d.A(part, part), d.B(part, Eigen::all));
    if (o)
      found.parts.emplace_back(std::move(part), *o);
    else
      found.others.insert(found.others.end(), part.begin(), part.end());
  }
  return found;
}

/// Not a block of one's own by this name.
bool is_lti(const Block& block) {
  const Interface& face = block.interface();
  return block.type() == "Lti" && face.channels.empty() && face.inputs.size() == 1 &&
         face.outputs.size() == 1 && block.values().empty();
}

}  // namespace

std::optional<Oscillators> oscillators(const Block& block) {
  if (!is_lti(block)) return std::nullopt;
  const auto d = block.dynamics({});
  const OscillatorParts found = find(*d);
  if (found.parts.empty()) return std::nullopt;
  Oscillators o = sized(*d, std::ssize(found.parts));
  for (Index j = 0; j < o.stiffness.size(); ++j) {
    const auto& [states, part] = found.parts[linalg::at(j)];
    o.stiffness(j) = part.stiffness;
    o.damping(j) = part.damping;
    const Eigen::RowVectorXd b = part.T.row(1) * d->B(states, Eigen::all);
    const MatrixXd C = d->C(Eigen::all, states) * part.T.inverse();
    const double scale = unit(b, C, part.stiffness);
    o.b.row(j) = scale * b;
    o.c_q.col(j) = C.col(0) / scale;
    o.c_v.col(j) = C.col(1) / scale;
    o.q.push_back(states.front());
    o.v.push_back(states.back());
  }
  o.others = found.others;
  o.rest = {d->A(found.others, found.others), d->B(found.others, Eigen::all),
            d->C(Eigen::all, found.others), d->D};
  return o;
}

BlockPtr lti_of(const Oscillators& o) {
  const Index n = o.stiffness.size(), first = o.rest.A.rows(), all = first + 2 * n;
  const bool in_place = std::ssize(o.q) == n;
  const auto places = [&](const std::vector<int>& given, Index from, Index count) {
    std::vector<int> result(linalg::at(count));
    std::iota(result.begin(), result.end(), static_cast<int>(from));
    return in_place ? given : result;
  };
  const std::vector<int> rest = places(o.others, 0, first), q = places(o.q, first, n),
                         v = places(o.v, first + n, n);
  Lti lti{.A = MatrixXd::Zero(all, all),
          .B = MatrixXd::Zero(all, o.rest.D.cols()),
          .C = MatrixXd(o.rest.D.rows(), all),
          .D = o.rest.D};
  lti.A(rest, rest) = o.rest.A;
  lti.A(q, v) = MatrixXd::Identity(n, n);
  lti.A(v, q) = (-o.stiffness).asDiagonal().toDenseMatrix();
  lti.A(v, v) = (-o.damping).asDiagonal().toDenseMatrix();
  lti.B(rest, Eigen::all) = o.rest.B;
  lti.B(v, Eigen::all) = o.b;
  lti.C(Eigen::all, rest) = o.rest.C;
  lti.C(Eigen::all, q) = o.c_q;
  lti.C(Eigen::all, v) = o.c_v;
  return as_block(lti);
}

std::optional<Graph> in_coordinates(const Graph& graph) {
  std::optional<Graph> result;
  for (std::size_t i = 0; i < graph.nodes.size(); ++i)
    if (const auto o = oscillators(*graph.nodes[i].block)) {
      if (!result) result = graph;
      result->nodes[i].block = lti_of(*o);
    }
  return result;
}

Oscillators projected(const Oscillators& o, const MatrixXd& V, const VectorXd& stiffness) {
  return {stiffness,           (V.transpose() * o.damping.asDiagonal() * V).diagonal(),
          V.transpose() * o.b, o.c_q * V,
          o.c_v * V,           o.rest};
}

}  // namespace titop::detail
