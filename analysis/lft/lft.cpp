#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <titop/analysis/lft/close.hpp>
#include <titop/analysis/lft/lft.hpp>
#include <titop/analysis/lft/lower_bounds.hpp>
#include <titop/analysis/lft/opening.hpp>
#include <titop/analysis/lft/structured.hpp>
#include <titop/compiler/definition/compare.hpp>
#include <titop/compiler/system/compile_graph.hpp>
#include <titop/graph/closed_form.hpp>
#include <titop/graph/linalg/eigen.hpp>
#include <titop/graph/linalg/index.hpp>
#include <titop/graph/linalg/similarity_scaling.hpp>

namespace titop {
namespace {

using Eigen::Index;
using Eigen::MatrixXcd;
using Eigen::MatrixXd;
using Eigen::VectorXd;
using linalg::at;

/// The pairs of each parameter with the deviation normalised: z' = gain z - shape w.
StateSpace normalised(StateSpace m, const std::vector<Delta>& deltas,
                      const std::vector<int>& sizes) {
  Index first = 0;
  for (std::size_t i = 0; i < deltas.size(); ++i) {
    const ParameterMap& map = deltas[i].map;
    m.C.middleRows(first, sizes[i]) *= map.gain;
    m.D.middleRows(first, sizes[i]) *= map.gain;
    m.D.block(first, first, sizes[i], sizes[i]).diagonal().array() -= map.shape;
    first += sizes[i];
  }
  return m;
}

/// Names the pairs "w m 1", "z m 1", ...
void name_pairs(StateSpace& m, const std::vector<Delta>& deltas) {
  for (const Delta& d : deltas)
    for (int i = 0; i < d.size; ++i) {
      m.inputs[at(d.first + i)] = fmt::format("w {} {}", d.parameter, i + 1);
      m.outputs[at(d.first + i)] = fmt::format("z {} {}", d.parameter, i + 1);
    }
}

VectorXd at_all_pairs(const std::vector<Delta>& deltas, const VectorXd& of_parameter) {
  Index n = 0;
  for (const Delta& d : deltas) n += d.size;
  VectorXd result(n);
  for (std::size_t i = 0; i < deltas.size(); ++i)
    result.segment(deltas[i].first, deltas[i].size)
        .setConstant(of_parameter(static_cast<Index>(i)));
  return result;
}

/// Refuses the first corner of the box at which the direct terms of the loop are singular, or
/// between which and the nominal values they are. Of more than 2^12 corners those whose last
/// parameters are at their least values.
void check_corners(const StateSpace& m, const std::vector<Delta>& deltas) {
  const auto q = static_cast<Index>(deltas.size());
  const long corners = 1L << std::min<Index>(q, 12);
  for (long c = 0; c < corners; ++c) {
    VectorXd d(q);
    for (Index i = 0; i < q; ++i) d(i) = i < 12 && (c >> i & 1) != 0 ? 1 : -1;
    const double margin = detail::well_posed(m, at_all_pairs(deltas, d));
    if (margin > detail::kWellPosed) continue;
    std::string where;
    for (Index i = 0; i < q; ++i) {
      const Delta& x = deltas[at(i)];
      where += fmt::format("{}{} = {:.6g}", i > 0 ? ", " : "", x.parameter,
                           d(i) > 0 ? x.map.to : x.map.from);
    }
    throw Error(
        Code::ill_posed,
        fmt::format("the direct terms are singular {} {}",
                    margin < -detail::kWellPosed ? "between the nominal values and" : "at", where),
        "give a smaller range: an algebraic loop or a mass matrix has no inverse there");
  }
}

/// "k = 4.1, a = -2"
std::string to_text(const ParameterList& values) {
  std::string text;
  for (const auto& [name, value] : values)
    text += fmt::format("{}{} = {:.6g}", text.empty() ? "" : ", ", name, value);
  return text.empty() ? "nominal values" : text;
}

/// The largest relative difference of two transfers with deltas in [-1, 1], at some points;
/// infinite if they could be compared at none.
double difference(const StateSpace& a, const std::vector<int>& pairs_a, const StateSpace& b,
                  const std::vector<int>& pairs_b) {
  double worst = 0;
  bool compared = false;
  for (int point = 1; point <= 6; ++point) {
    const auto deltas = [&](const std::vector<int>& pairs) {
      std::vector<double> all;
      for (std::size_t i = 0; i < pairs.size(); ++i)  // [Weyl]: spread over the box
        all.insert(all.end(), at(pairs[i]),
                   0.9 * std::sin(point * 2.4 + static_cast<double>(i) * 1.7));
      return VectorXd(Eigen::Map<const VectorXd>(all.data(), static_cast<Index>(all.size())));
    };
    const auto x = detail::closed(a, deltas(pairs_a)), y = detail::closed(b, deltas(pairs_b));
    if (!x || !y) continue;
    compared = true;
    const std::complex<double> s{0.3 * point, std::pow(2.0, point - 3)};
    const Eigen::MatrixXcd G = x->transfer(s), H = y->transfer(s);
    const double size = G.size() > 0 ? G.cwiseAbs().maxCoeff() : 0;
    if (size > 0) worst = std::max(worst, (G - H).cwiseAbs().maxCoeff() / size);
  }
  return compared ? worst : HUGE_VAL;
}

/// Reduced and normalised, with the parameters' pairs; not reduced if that has another transfer.
detail::Structured small_model(const StateSpace& opened, const std::vector<int>& sizes,
                               const std::vector<Delta>& deltas) {
  const StateSpace whole = normalised(opened, deltas, sizes);
  detail::Structured small = detail::reduced(whole, sizes);
  constexpr double kSame = 1e-9;
  if (difference(whole, sizes, small.m, small.sizes) <= kSame) return small;
  return {whole, sizes, small.margin};
}

/// The largest sum of magnitudes of a column.
double norm1(const MatrixXcd& m) { return m.cwiseAbs().colwise().sum().maxCoeff(); }

/// z of (I - loop) z = F; none if that is singular: if it is as small as the rounding of I and loop
/// would make it, or its reciprocal condition number is (kWellPosed).
std::optional<MatrixXcd> solved_loop(const MatrixXcd& loop, const MatrixXcd& F) {
  if (loop.size() == 0) return F;
  const MatrixXcd E = MatrixXcd::Identity(loop.rows(), loop.rows()) - loop;
  const Eigen::PartialPivLU<MatrixXcd> lu(E);
  if (!(lu.rcond() * norm1(E) > detail::kWellPosed * (1 + norm1(loop)))) return std::nullopt;
  return MatrixXcd(lu.solve(F));
}

}  // namespace

Lft lft(const System& system, const ParameterRanges& ranges) {
  require_state_space(system.stage().graph);
  const std::vector<detail::IsolatedParameter> list = detail::isolated(system, ranges);
  std::vector<passes::ToOpen> to_open;
  for (const auto& p : list)
    to_open.push_back({p.index, p.map.kind == ParameterMap::Kind::quarter_angle});
  Lft f{System(detail::compile_opened(detail::data_of(system), to_open))};
  const detail::OpenedMatrices opened = detail::opened_matrices(f.opened_, list);
  for (std::size_t i = 0; i < list.size(); ++i)
    f.deltas_.push_back({.parameter = ranges[i].first,
                         .built = opened.sizes[i],
                         .map = list[i].map,
                         .where = opened.where[i]});
  f.take(small_model(opened.m, opened.sizes, f.deltas_));
  f.find_lower_bounds(list);
  const bool fewer = std::any_of(f.deltas_.begin(), f.deltas_.end(),
                                 [](const Delta& d) { return d.size < d.at_least; });
  if (fewer || f.m_.order() < f.states_at_least_)  // a rank was taken too low
    f.take({normalised(opened.m, f.deltas_, opened.sizes), opened.sizes, f.margin_});
  check_corners(f.m_, f.deltas_);
  return f;
}

void Lft::take(detail::Structured model) {
  margin_ = model.margin;
  m_ = std::move(model.m);
  int first = 0;
  for (std::size_t i = 0; i < deltas_.size(); ++i) {
    deltas_[i].first = first;
    deltas_[i].size = model.sizes[i];
    first += model.sizes[i];
  }
  name_pairs(m_, deltas_);
}

void Lft::take_reduced(StateSpace m) {
  m_ = std::move(m);
  states_at_least_ = 0;
  for (Delta& d : deltas_) d.at_least = 0;
  not_decided_ = "M is reduced";
}

void Lft::find_lower_bounds(const std::vector<detail::IsolatedParameter>& list) {
  constexpr int kFew = 60;
  std::vector<int> parameters, sizes;
  for (std::size_t i = 0; i < list.size(); ++i) {
    parameters.push_back(list[i].index);
    sizes.push_back(deltas_[i].size);
  }
  const Stage& stage = opened_.stage();
  const int states = m_.order() + occurrences() <= kFew ? m_.order() : 0;
  const detail::LowerBounds low =
      detail::lower_bounds(stage, stage.values, parameters, sizes, states);
  for (std::size_t i = 0; i < list.size(); ++i) deltas_[i].at_least = low.at_least[i];
  states_at_least_ = low.states;
  not_decided_ = low.why_not;
}

int Lft::occurrences() const {
  int sum = 0;
  for (const Delta& d : deltas_) sum += d.size;
  return sum;
}

VectorXd Lft::deltas_at(const ParameterList& values) const {
  VectorXd d = VectorXd::Zero(static_cast<Index>(deltas_.size()));
  std::vector<Mistake> mistakes;
  std::vector<std::string> seen;
  for (const auto& [name, value] : values) {
    const auto found = std::find_if(deltas_.begin(), deltas_.end(),
                                    [&](const Delta& x) { return x.parameter == name; });
    if (found == deltas_.end()) {
      std::string known;
      for (const Delta& x : deltas_) known += (known.empty() ? "" : ", ") + x.parameter;
      mistakes.push_back({Code::unknown_name,
                          fmt::format("the LFT has no parameter {}", name),
                          {},
                          "its parameters are " + known});
    } else if (std::find(seen.begin(), seen.end(), name) != seen.end()) {
      mistakes.push_back({Code::duplicate_name,
                          fmt::format("parameter {} is set twice", name),
                          {},
                          "keep one of the two values"});
    } else if (!(value >= found->map.from && value <= found->map.to)) {
      mistakes.push_back({Code::bad_value,
                          fmt::format("{} = {} is outside of its range, {:.6g} to {:.6g}", name,
                                      value, found->map.from, found->map.to),
                          {},
                          "give lft a range that has it"});
    } else {
      d(found - deltas_.begin()) = found->map.delta(value);
    }
    seen.push_back(name);
  }
  if (!mistakes.empty()) throw Error(std::move(mistakes));
  return at_all_pairs(deltas_, d);
}

StateSpace Lft::at(const ParameterList& values) const {
  auto result = detail::closed(m_, deltas_at(values));
  if (!result)
    throw Error(Code::singular, "the direct terms of the LFT are singular at " + to_text(values),
                "take others: an algebraic loop or a mass matrix has no inverse there");
  return std::move(*result);
}

std::vector<MatrixXcd> Lft::transfers(std::complex<double> s,
                                      std::span<const ParameterList> values) const {
  MatrixXcd M = m_.transfer(s);
  const Index r = occurrences(), nu = M.cols() - r, ny = M.rows() - r;
  MatrixXd sizes = M.topLeftCorner(r, r).cwiseAbs();
  const VectorXd d = linalg::similarity_scaling(sizes);  // of w and z, for any units
  M.topRows(r) = MatrixXcd(d.cwiseInverse().asDiagonal() * M.topRows(r));
  M.leftCols(r) = MatrixXcd(M.leftCols(r) * d.asDiagonal());
  std::vector<MatrixXcd> result;
  for (const ParameterList& list : values) {
    const VectorXd deltas = deltas_at(list);
    const MatrixXcd loop = M.topLeftCorner(r, r) * deltas.asDiagonal();
    const auto z = solved_loop(loop, M.topRightCorner(r, nu));
    if (!z)
      throw Error(Code::singular,
                  fmt::format("s = {:.6g}{:+.6g}j is a pole of the LFT at {}", s.real(), s.imag(),
                              to_text(list)),
                  "take another s, or damp the model");
    result.emplace_back(M.bottomRightCorner(ny, nu) +
                        M.bottomLeftCorner(ny, r) * MatrixXcd(deltas.asDiagonal() * *z));
  }
  return result;
}

}  // namespace titop
