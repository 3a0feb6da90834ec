#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <titop/blocks/fe/modal_checks.hpp>
#include <titop/graph/linalg/eigen.hpp>
#include <titop/graph/linalg/rounding.hpp>
#include <utility>

namespace titop {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

namespace {

double noise_of(const ModalData& data) { return 10 * std::pow(10, -data.digits); }

/// Mode shapes also have the rounding error of their eigenproblem, about 1e-14 of the largest
/// entry; entries below this bound count as zero motion.
constexpr double kOfShapes = 1e-11;

double shape_noise(const ModalData& data) { return std::max(noise_of(data), kOfShapes); }

/// Reference sizes of its rows: the largest of their kind, translations or rotations, or of the
/// other kind times (over) the distance from P.
Vector6 row_sizes(const ModalChild& child) {
  const Vector6 norms = child.Phi_C.rowwise().norm();
  const double translation = norms.head<3>().maxCoeff(), rotation = norms.tail<3>().maxCoeff();
  const double length = child.PC.norm();
  Vector6 sizes;
  sizes.head<3>().setConstant(std::max(translation, rotation * length));
  sizes.tail<3>().setConstant(std::max(rotation, length > 0 ? translation / length : 0.0));
  return sizes;
}

/// The same of a line's rows, with those of the child at its middle: displacements, or rotations
/// times the line's length. A row of zeros is exact and has the size 0.
VectorXd shape_sizes(const ModalData& data, const ModalLine& line) {
  const VectorXd norms = line.Phi.rowwise().norm();
  const auto is_rotation = [&](Index i) {
    return line.shapes[static_cast<std::size_t>(i)].component >= 3;
  };
  double displacement = 0;
  for (Index i = 0; i < norms.size(); ++i)
    displacement = std::max(displacement, norms(i) * (is_rotation(i) ? line.length : 1));
  for (const ModalChild& child : data.children)
    if (child.name == line.name) {
      const Vector6 point = child.Phi_C.rowwise().norm();
      displacement = std::max(
          {displacement, point.head<3>().maxCoeff(), point.tail<3>().maxCoeff() * line.length});
    }
  VectorXd sizes = VectorXd::Zero(norms.size());
  for (Index i = 0; i < norms.size(); ++i)
    if (norms(i) > 0) sizes(i) = is_rotation(i) ? displacement / line.length : displacement;
  return sizes;
}

/// The same space, spanned by vectors with as many zeros as possible (Gauss-Jordan on the columns,
/// the largest entry as pivot): a basis that can be read and does not depend on rounding.
MatrixXd readable(MatrixXd W) {
  for (Index k = 0; k < W.cols(); ++k) {
    Index row = 0, column = 0;
    W.rightCols(W.cols() - k).cwiseAbs().maxCoeff(&row, &column);
    W.col(k).swap(W.col(k + column));
    W.col(k) /= W(row, k);
    for (Index j = 0; j < W.cols(); ++j)
      if (j != k) W.col(j) -= W(row, j) * W.col(k);
  }
  return W;
}

/// Rows of Phi, their names and reference sizes.
struct NamedRows {
  MatrixXd Phi;
  VectorXd sizes;
  std::vector<std::string> names;
};

NamedRows rows_of(const ModalChild& child) {
  NamedRows rows{child.Phi_C, row_sizes(child), {}};
  for (int i = 0; i < 6; ++i) rows.names.emplace_back(component_name(i));
  return rows;
}

void append(NamedRows& rows, const MatrixXd& Phi, const VectorXd& sizes) {
  const Index before = rows.sizes.size();
  rows.Phi.conservativeResize(before + Phi.rows(), Phi.cols());
  rows.Phi.bottomRows(Phi.rows()) = Phi;
  rows.sizes.conservativeResize(before + sizes.size());
  rows.sizes.tail(sizes.size()) = sizes;
}

/// First coefficient 1, small ones left out.
std::string combination(const VectorXd& w, const std::vector<std::string>& names) {
  const double largest = w.cwiseAbs().maxCoeff();
  std::string text;
  double first = 0;
  for (Index i = 0; i < w.size(); ++i) {
    if (std::abs(w(i)) < linalg::kTextDigits * largest) continue;
    if (first == 0) first = w(i);
    const double c = w(i) / first;
    if (!text.empty()) text += c < 0 ? " - " : " + ";
    const bool one = std::abs(std::abs(c) - 1) < linalg::kTextDigits;
    const std::string& name = names[static_cast<std::size_t>(i)];
    text += one ? name : fmt::format("{:.3g} {}", std::abs(c), name);
  }
  return text;
}

struct RowRank {
  int rank = 0;
  double condition = 0;
  std::vector<std::string> blocked = {};
};

/// Rows that are negligible compared with the others are blocked by themselves.
RowRank rank_of(const NamedRows& rows, double noise) {
  RowRank result;
  const VectorXd norms = rows.Phi.rowwise().norm();
  std::vector<Index> moving;
  for (Index i = 0; i < norms.size(); ++i) {
    if (norms(i) > noise * rows.sizes(i))
      moving.push_back(i);
    else
      result.blocked.push_back(rows.names[static_cast<std::size_t>(i)]);
  }
  const auto count = static_cast<Index>(moving.size());
  if (count == 0) return result;
  const MatrixXd A = norms(moving).cwiseInverse().asDiagonal() * rows.Phi(moving, Eigen::all);
  // A = R'Q': its singular values are those of the small R', for any number of modes.
  MatrixXd R = MatrixXd::Zero(count, count);
  const Eigen::HouseholderQR<MatrixXd> qr(A.transpose());
  const Index upper = std::min(count, A.cols());
  R.topRows(upper) = qr.matrixQR().topRows(upper).triangularView<Eigen::Upper>();
  const Eigen::JacobiSVD<MatrixXd> svd(R.transpose(), Eigen::ComputeFullU);
  const VectorXd sigma = svd.singularValues();
  const Index rank = (sigma.array() > noise).count();
  result.rank = static_cast<int>(rank);
  result.condition = sigma(0) / sigma(rank - 1);
  const MatrixXd still = readable(svd.matrixU().rightCols(count - rank));
  for (Index k = 0; k < still.cols(); ++k) {
    VectorXd w = VectorXd::Zero(norms.size());
    w(moving) = still.col(k).cwiseQuotient(norms(moving));
    result.blocked.push_back(combination(w, rows.names));
  }
  return result;
}

}  // namespace

std::string combination(const Vector6& w) {
  return combination(w, {"x", "y", "z", "rx", "ry", "rz"});
}

ChildRank child_rank(const ModalData& data, const ModalChild& child) {
  RowRank r = rank_of(rows_of(child), shape_noise(data));
  return {child.name, r.rank, r.condition, std::move(r.blocked)};
}

LineRank line_rank(const ModalData& data, const ModalLine& line) {
  NamedRows rows;
  for (const ModalChild& child : data.children)
    if (child.name == line.name) rows = rows_of(child);
  append(rows, line.Phi, shape_sizes(data, line));
  for (const LineShape& shape : line.shapes) rows.names.push_back(to_string(shape));
  RowRank r = rank_of(rows, shape_noise(data));
  return {line.name, static_cast<int>(rows.names.size()), r.rank, r.condition,
          std::move(r.blocked)};
}

DataDigits data_digits(const ModalData& data) {
  const auto children = static_cast<Index>(data.children.size());
  Index row = 6 * children;
  for (const ModalLine& line : data.lines) row += static_cast<Index>(line.shapes.size());
  DataDigits result{VectorXd::Zero(row + 6), shape_noise(data), noise_of(data)};
  for (Index c = 0; c < children; ++c) {
    const ModalChild& child = data.children[static_cast<std::size_t>(c)];
    const Vector6 sizes = row_sizes(child);
    for (int i = 0; i < 6; ++i)
      if (!child.Phi_C.row(i).isZero(0)) result.size(6 * c + i) = sizes(i);
  }
  row = 6 * children;
  for (const ModalLine& line : data.lines)
    for (const double size : shape_sizes(data, line)) result.size(row++) = size;
  result.size.tail<6>() = data.D_P.diagonal().cwiseSqrt();
  return result;
}

}  // namespace titop
