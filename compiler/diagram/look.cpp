#include <fmt/format.h>

#include <Eigen/Geometry>
#include <cmath>
#include <titop/compiler/diagram/picture.hpp>
#include <titop/graph/linalg/index.hpp>
#include <titop/graph/linalg/rounding.hpp>

namespace titop::diagram {
namespace {

using Eigen::MatrixXd;
using linalg::at;

/// A term as a sign, a gain, and words, read from the signal's side.
struct TermText {
  bool minus = false;
  std::string box, part;
  bool rotation = false;

  void put(const std::string& word) { box = box.empty() ? word : word + " " + box; }
};

std::string frame(const Graph& g, int f) {
  if (f == kUnknownFrame) return "?";
  return f < 0 ? "" : g.nodes[at(f)].name;
}

std::string arrow(const std::string& to, const std::string& from) {
  return to.empty() && from.empty() ? "T" : fmt::format("T({}←{})", to, from);
}

void put_gain(TermText& r, double k) {
  if (k < 0) r.minus = !r.minus;
  if (std::abs(k) != 1) r.put(fmt::format("{:.4g}", std::abs(k)));
}

/// A multiple of a rotation of 3-vectors: |k|, 0 if it is none.
double rotation_scale(const MatrixXd& m) {
  const Eigen::Index n = m.rows();
  if (n != m.cols() || (n != 3 && n != 6)) return 0;
  const double k = m.row(0).norm();
  const MatrixXd square = m * m.transpose() - k * k * MatrixXd::Identity(n, n);
  const bool split = n == 3 || (m.topRightCorner(3, 3).isZero(0) &&
                                (m.topLeftCorner(3, 3) - m.bottomRightCorner(3, 3)).isZero(0));
  return k > 0 && split && square.cwiseAbs().maxCoeff() <= linalg::kMatrixDigits * k * k ? k : 0;
}

/// ".linear" for [1 0], ".angular" for [0 1]; empty for anything else.
std::string selection(const MatrixXd& m) {
  if (m.rows() != 3 || m.cols() != 6) return {};
  MatrixXd first = MatrixXd::Zero(3, 6), second = first;
  first.leftCols(3).setIdentity();
  second.rightCols(3).setIdentity();
  return m == first ? ".linear" : m == second ? ".angular" : "";
}

bool is_diagonal(const Pattern& p) {
  if (p.rows() != p.cols()) return false;
  for (Eigen::Index i = 0; i < p.rows(); ++i)
    for (Eigen::Index j = 0; j < p.cols(); ++j)
      if (i != j && p(i, j)) return false;
  return true;
}

/// After `lower` a term is one matrix: its text is recovered from its numbers, its declared
/// structure and the frames at its ends.
void put_matrix(TermText& r, const Matrix& matrix, const std::string& to, const std::string& from) {
  const MatrixXd& m = *matrix.value;
  const Pattern pattern = matrix.pattern ? *matrix.pattern : Pattern(m.array() != 0);
  if (is_diagonal(pattern) && m.size() > 0 && (m.diagonal().array() == m(0, 0)).all()) {
    put_gain(r, m(0, 0));
  } else if (const double k = rotation_scale(m); k > 0) {
    r.put(to != from && !to.empty() && !from.empty() ? arrow(to, from) : "T");
    r.rotation = true;
    const Eigen::Matrix3d T = m.topLeftCorner(3, 3);
    const double sign = T.col(0).cross(T.col(1)).dot(T.col(2)) < 0 ? -1 : 1;
    put_gain(r, sign * (std::abs(k - 1) < linalg::kMatrixDigits ? 1 : k));
  } else if (const std::string part = selection(m); !part.empty()) {
    r.part = part;
  } else {
    r.put(fmt::format("M {}×{}", m.rows(), m.cols()));
  }
}

TermText read(const Graph& g, const Term& term, const std::string& to, const std::string& from) {
  TermText r;
  r.minus = term.sign < 0;
  if (std::abs(term.sign) != 1) put_gain(r, std::abs(term.sign));
  for (auto f = term.factors.rbegin(); f != term.factors.rend(); ++f) {
    if (const auto* k = std::get_if<Value>(&*f)) {
      const bool named = k->is_parameter() && at(k->index()) < g.parameters.size();
      if (named) r.put(g.parameters[at(k->index())].name);
      put_gain(r, named ? k->scale() : k->nominal());
    } else if (const auto* T = std::get_if<Rotation>(&*f)) {
      if (T->is_identity()) continue;
      r.put(arrow(T->to(), T->from()));
      r.rotation = true;
    } else if (const auto* m = std::get_if<Matrix>(&*f)) {
      put_matrix(r, *m, to, from);
    } else {
      r.part += std::get<Part>(*f).name();
    }
  }
  return r;
}

/// "6, B": size and frame of a vector; scalars need no words.
std::string extent(int size, const std::string& in) {
  if (size <= 1) return {};
  return in.empty() ? fmt::format("{}", size) : fmt::format("{}, {}", size, in);
}

std::string joined(const std::string& a, const std::string& b) {
  return a.empty() || b.empty() ? a + b : a + " " + b;
}

}  // namespace

Look look(const Picture& p, const Assignment& a, const Term& term) {
  const Graph& g = p.graph;
  const Signal& s = g.signals[at(term.signal)];
  const std::string from = frame(g, s.frame);
  const std::string to = a.target < 0 ? from : frame(g, g.signals[at(a.target)].frame);
  const TermText r = read(g, term, to, from);
  Look result{.minus = r.minus, .box = r.box, .rotation = r.rotation};
  result.rows = rows_of(g, term);
  result.before = extent(r.part.empty() ? s.size : result.rows, from);
  // Two frames with the same axes: no box, but both names.
  if (r.box.empty() && !to.empty() && to != from && !from.empty() && s.size > 1)
    result.before += "=" + to;
  if (term.of == Term::Of::reaction) result.before = joined(result.before, ".reaction");
  if (term.of == Term::Of::position) result.before = joined(result.before, ".position");
  if (term.of == Term::Of::rate) result.before = joined(result.before, ".rate");
  result.before = joined(result.before, r.part);
  if (r.rotation || result.rows != s.size) result.after = extent(result.rows, to);
  result.after = joined(result.after, a.part);
  if (result.box.empty()) {
    result.before = joined(result.before, a.part);
    result.after.clear();
  }
  return result;
}

}  // namespace titop::diagram
