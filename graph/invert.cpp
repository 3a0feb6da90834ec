#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <titop/graph/closed_form.hpp>
#include <titop/graph/invert.hpp>
#include <titop/graph/linalg/eigen.hpp>
#include <utility>

namespace titop {
namespace {

using Eigen::MatrixXd;

void add_names(std::vector<std::string>& names, const std::string& name, int size) {
  for (int i = 1; i <= size; ++i)
    names.push_back(size == 1 ? name : fmt::format("{}({})", name, i));
}

std::string dotted(const std::string& channel, const std::string& signal) {
  return channel.empty() ? signal : channel + "." + signal;
}

/// First scalar and count of "parent", "C1.angular", "parent(3)" inside a channel.
struct ScalarRange {
  int first, count;
};
ScalarRange range_of(const std::string& text, const ChannelSpec& c) {
  const std::string rest = text.substr(c.name.size());
  if (rest.empty()) return {0, c.size};
  if (rest == ".linear" && c.size == 6) return {0, 3};
  if (rest == ".angular" && c.size == 6) return {3, 3};
  if (rest.size() == 3 && rest.front() == '(' && rest.back() == ')' && rest[1] >= '1' &&
      rest[1] - '0' <= c.size)
    return {rest[1] - '1', 1};
  return {0, 0};
}

/// Rows and columns scaled to one size by powers of two: singularity does not depend on millimetres
/// or metres.
struct EquilibratedMatrix {
  MatrixXd matrix;
  Eigen::VectorXd rows, cols;

  explicit EquilibratedMatrix(MatrixXd m)
      : matrix(std::move(m)),
        rows(Eigen::VectorXd::Ones(matrix.rows())),
        cols(Eigen::VectorXd::Ones(matrix.cols())) {
    if (matrix.size() == 0) return;
    for (int sweep = 0; sweep < 5; ++sweep) {
      for (Eigen::Index i = 0; i < matrix.rows(); ++i) {
        const double row = by_two(matrix.row(i).cwiseAbs().maxCoeff());
        matrix.row(i) *= row, rows(i) *= row;
      }
      for (Eigen::Index j = 0; j < matrix.cols(); ++j) {
        const double col = by_two(matrix.col(j).cwiseAbs().maxCoeff());
        matrix.col(j) *= col, cols(j) *= col;
      }
    }
  }

 private:
  static double by_two(double size) {
    return size > 0 ? std::exp2(-std::round(std::log2(size))) : 1;
  }
};

}  // namespace

StateSpace model_of(const BlockPtr& block) {
  require_state_space(*block);
  std::vector<double> none;
  for (const Value& v : block->values())
    if (v.is_parameter()) {
      none.resize(std::max(none.size(), static_cast<std::size_t>(v.index()) + 1));
      none[static_cast<std::size_t>(v.index())] = v.parameter();
    }
  const auto d = block->dynamics(none);
  const Interface& face = block->interface();
  StateSpace m{d->A, d->B, d->C, d->dense_direct(), face.states, {}, {}};
  for (const ChannelSpec& c : face.channels) {
    const bool takes_force = c.takes == Takes::force;
    add_names(m.inputs, dotted(c.name, takes_force ? c.force_name : c.accel_name), c.size);
    add_names(m.outputs, dotted(c.name, takes_force ? c.accel_name : c.force_name), c.size);
  }
  for (const PortSpec& p : face.inputs) add_names(m.inputs, p.name, p.size);
  for (const PortSpec& p : face.outputs) add_names(m.outputs, p.name, p.size);
  return m;
}

namespace {

/// Throws for a number that is none of the model's, or that is named twice.
void check_numbers(std::vector<int> numbers, Eigen::Index size, const char* subject) {
  std::sort(numbers.begin(), numbers.end());
  for (const int i : numbers)
    if (i < 0 || i >= size)
      throw Error(Code::bad_value, fmt::format("{} {} of a model of {}", subject, i, size),
                  "numbers count from 0, in the order of StateSpace::inputs and outputs");
  const auto twice = std::adjacent_find(numbers.begin(), numbers.end());
  if (twice != numbers.end())
    throw Error(Code::bad_value, fmt::format("{} {} is in two pairs", subject, *twice),
                "exchange each input with one output");
}

/// Rank of these rows and columns of D, without pivots that are rounding of the other entries in
/// them, as of a 0 after a rotation of frames.
Eigen::Index rank_beyond_rounding(const MatrixXd& D, const std::vector<int>& rows,
                                  const std::vector<int>& columns) {
  constexpr double kRounding = 1e-14;  // of the largest entry: some fifty roundings
  if (rows.empty()) return 0;
  const MatrixXd part = EquilibratedMatrix(D).matrix(rows, columns);
  const Eigen::FullPivLU<MatrixXd> lu(part);
  return (lu.matrixLU().diagonal().cwiseAbs().array() > kRounding).count();
}

void check_names(const StateSpace& m) {
  require_fitting(m, "invert");
  if (std::ssize(m.inputs) == m.D.cols() && std::ssize(m.outputs) == m.D.rows()) return;
  throw Error(Code::size,
              fmt::format("invert: {} names of inputs and {} of outputs for D of {} x {}",
                          m.inputs.size(), m.outputs.size(), m.D.rows(), m.D.cols()),
              "name every input and output in StateSpace::inputs and outputs");
}

}  // namespace

StateSpace invert(const StateSpace& model, const std::vector<std::pair<int, int>>& pairs) {
  check_names(model);
  std::vector<int> in, out;
  for (const auto& [i, o] : pairs) in.push_back(i), out.push_back(o);
  check_numbers(in, model.D.cols(), "input");
  check_numbers(out, model.D.rows(), "output");
  const EquilibratedMatrix D_oi(model.D(out, in));
  Eigen::FullPivLU<MatrixXd> lu(D_oi.matrix);
  constexpr double kSingular = 1e-13;  // least pivot over the largest: some digits remain
  lu.setThreshold(kSingular);
  const Eigen::Index rank = std::min(lu.rank(), rank_beyond_rounding(model.D, out, in));
  if (rank < std::ssize(pairs))
    throw Error(Code::improper,
                fmt::format("the direct term from {} to {} has rank {} of {}",
                            in.empty() ? "" : model.inputs[static_cast<std::size_t>(in.front())],
                            out.empty() ? "" : model.outputs[static_cast<std::size_t>(out.front())],
                            rank, pairs.size()),
                "invert fewer degrees of freedom: the inverse would need derivatives");
  // u_i = R (y_o - C_o x - D_or u_r); the rest follows by substitution.
  const MatrixXd R = D_oi.cols.asDiagonal() * lu.inverse() * D_oi.rows.asDiagonal();
  MatrixXd K = -R * model.D(out, Eigen::all);  // of all inputs; the swapped columns become R
  K(Eigen::all, in) = R;
  const MatrixXd X = -R * model.C(out, Eigen::all);
  StateSpace result = model;
  result.A += model.B(Eigen::all, in) * X;
  result.C += model.D(Eigen::all, in) * X;
  result.B(Eigen::all, in).setZero();
  result.D(Eigen::all, in).setZero();
  result.B += model.B(Eigen::all, in) * K;
  result.D += model.D(Eigen::all, in) * K;
  result.C(out, Eigen::all) = X;
  result.D(out, Eigen::all) = K;
  for (const auto& [i, o] : pairs)
    std::swap(result.inputs[static_cast<std::size_t>(i)],
              result.outputs[static_cast<std::size_t>(o)]);
  return result;
}

StateSpace invert(const BlockPtr& block, const std::vector<std::string>& channels) {
  std::vector<std::pair<int, int>> pairs;
  for (const std::string& name : channels) {
    int first = 0;
    ScalarRange found{0, 0};
    std::string all;
    for (const ChannelSpec& c : block->interface().channels) {
      all += fmt::format("{}\"{}\"", all.empty() ? "" : ", ", c.name);
      if (found.count == 0 && name.compare(0, c.name.size(), c.name) == 0) {
        found = range_of(name, c);
        found.first += first;
      }
      first += c.size;
    }
    if (found.count == 0)
      throw Error(
          Code::unknown_name, fmt::format("a {} has no channel \"{}\"", block->type(), name),
          fmt::format("its channels are {}; \".linear\", \".angular\" or \"(1)\" ... \"(6)\" may "
                      "follow",
                      all));
    // By the interface's convention a channel's input and output have the same place.
    for (int k = found.first; k < found.first + found.count; ++k) pairs.emplace_back(k, k);
  }
  return invert(model_of(block), pairs);
}

}  // namespace titop
