#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <titop/compiler/loops/second_order.hpp>
#include <titop/graph/linalg/eigen.hpp>
#include <titop/graph/linalg/index.hpp>
#include <titop/graph/support/steady_random.hpp>

namespace titop::loops {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;
using Vector6d = Eigen::Matrix<double, 6, 1>;
using linalg::at;

constexpr std::size_t kMostChains = 20;  ///< a millisecond or two
constexpr int kMotions = 3;

/// Lie bracket of two small motions (translation of a fixed point, rotation).
Vector6d bracket(const Vector6d& a, const Vector6d& b) {
  Vector6d result;
  result.head<3>() = a.tail<3>().cross(b.head<3>()) - b.tail<3>().cross(a.head<3>());
  result.tail<3>() = a.tail<3>().cross(b.tail<3>());
  return result;
}

/// The place of a column on the way round; -1: not on it, or no joint.
std::ptrdiff_t place(const FormColumn& column, const Closing& c, const Graph& g) {
  const auto on_way = [&](int point) {
    if (at(point) >= g.channels.size()) return false;  // the ground
    if (column.kind == FormColumn::Kind::states) return g.channels[at(point)].node == column.id;
    return g.signals[at(g.equations[at(column.id)].target)].channel == point;
  };
  if (column.kind != FormColumn::Kind::states && column.kind != FormColumn::Kind::angle) return -1;
  const auto found = std::find_if(c.chain.begin(), c.chain.end(), on_way);
  return found == c.chain.end() ? -1 : found - c.chain.begin();
}

/// The joints of a chain in the order of the way round, each with its columns in the component.
struct ChainJoint {
  std::ptrdiff_t place = 0;
  const MatrixXd* screws = nullptr;  ///< 6 x its columns
  std::vector<int> columns = {};     ///< -1: it does not move
};

std::vector<ChainJoint> joints(const Component& component, const Closing& c, const Graph& g) {
  std::vector<ChainJoint> result;
  for (const auto& [column, screws] : c.form) {
    ChainJoint joint{place(column, c, g), &screws};
    if (joint.place < 0 || screws.rows() != 6) return {};
    for (int i = 0; i < screws.cols(); ++i) {
      const ScalarColumn scalar{column, i};
      const auto found =
          std::lower_bound(component.scalars.begin(), component.scalars.end(), scalar);
      const bool there = found != component.scalars.end() && *found == scalar;
      joint.columns.push_back(there ? static_cast<int>(found - component.scalars.begin()) : -1);
    }
    result.push_back(std::move(joint));
  }
  std::sort(result.begin(), result.end(),
            [](const ChainJoint& a, const ChainJoint& b) { return a.place < b.place; });
  return result;
}

/// The brackets of this motion around one chain, and the sum of their sizes, row by row.
struct Brackets {
  Vector6d sum = Vector6d::Zero(), size = Vector6d::Zero();
};

Brackets brackets(const std::vector<ChainJoint>& chain, const VectorXd& motion) {
  Brackets result;
  Vector6d before = Vector6d::Zero();
  for (const ChainJoint& joint : chain) {
    Vector6d here = Vector6d::Zero();
    for (std::size_t i = 0; i < joint.columns.size(); ++i)
      if (joint.columns[i] >= 0)
        here += joint.screws->col(static_cast<Index>(i)) * motion(joint.columns[i]);
    const Vector6d with = bracket(before, here);
    result.sum += with;
    result.size += with.cwiseAbs();
    before += here;
  }
  return result;
}

MatrixXd dense(const Component& c) {
  MatrixXd result = MatrixXd::Zero(6 * std::ssize(c.lines), std::ssize(c.scalars));
  for (std::size_t b = 0; b < c.relations.blocks.size(); ++b)
    for (std::size_t i = 0; i < c.relations.blocks[b].columns.size(); ++i)
      result.col(c.relations.blocks[b].columns[i]).segment<6>(6 * static_cast<Index>(b)) =
          c.relations.blocks[b].M.col(static_cast<Index>(i));
  return result;
}

/// The span of the columns of m, and its orthogonal complement. As reflectors one after the other:
/// a basis written out would have as many numbers as the square of m's rows.
class Span {
 public:
  explicit Span(const MatrixXd& m) : qr_(m) {
    while (rank_ < std::min(m.rows(), m.cols()) &&
           std::abs(qr_.matrixR()(rank_, rank_)) > kMatrixDigits)
      ++rank_;
  }
  /// Dimensions outside the span.
  Index left_out() const { return qr_.rows() - rank_; }
  /// A vector outside the span, by its coordinates there.
  VectorXd outside(const VectorXd& coordinates) const {
    VectorXd x = VectorXd::Zero(qr_.rows());
    x.tail(left_out()) = coordinates;
    return qr_.householderQ() * x;
  }
  /// The norm of the component outside the span.
  double outside_of(const VectorXd& x) const {
    const VectorXd along = qr_.householderQ().transpose() * x;
    return along.tail(left_out()).norm();
  }

 private:
  Eigen::ColPivHouseholderQR<MatrixXd> qr_;
  Index rank_ = 0;
};

}  // namespace

double stopped(const Component& scaled, const ScaleFactors& factors,
               const std::vector<const Closing*>& closings, const Graph& graph) {
  if (closings.size() > kMostChains) return -1;
  std::vector<std::vector<ChainJoint>> chains;
  for (const Closing* c : closings) {
    chains.push_back(joints(scaled, *c, graph));
    if (chains.back().empty()) return -1;
  }
  if (scaled.scalars.empty()) return 0;
  const MatrixXd relations = dense(scaled);
  const Span reached(relations), held(relations.transpose());
  if (reached.left_out() == 0 || held.left_out() == 0) return 0;
  detail::SteadyRandom random;
  double worst = 0;
  for (int k = 0; k < kMotions; ++k) {
    VectorXd by(held.left_out());
    for (double& x : by) x = random.next();
    const VectorXd motion = factors.column.cwiseProduct(held.outside(by));
    VectorXd sum(relations.rows()), size(relations.rows());
    for (std::size_t c = 0; c < chains.size(); ++c) {
      const Brackets b = brackets(chains[c], motion);
      sum.segment<6>(6 * static_cast<Index>(c)) = factors.row[c].cwiseProduct(b.sum);
      size.segment<6>(6 * static_cast<Index>(c)) = factors.row[c].cwiseProduct(b.size);
    }
    if (size.norm() > 0) worst = std::max(worst, reached.outside_of(sum) / size.norm());
  }
  return worst;
}

}  // namespace titop::loops
