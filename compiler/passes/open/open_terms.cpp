#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <titop/compiler/passes/open/open_terms.hpp>
#include <titop/graph/linalg/index.hpp>

namespace titop::passes {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using linalg::at;

/// Multiplies every term from the left.
void times(std::vector<Term>& sum, const Factor& factor) {
  for (Term& t : sum) t.factors.insert(t.factors.begin(), factor);
}

Factor matrix(MatrixXd m) { return Matrix{std::make_shared<const MatrixXd>(std::move(m))}; }

/// The same matrix on each of the three-vectors of a signal of 3 or 6.
Factor on_each(const MatrixXd& m, int rows) {
  const Index n = rows / 3;
  MatrixXd all = MatrixXd::Zero(n * m.rows(), n * m.cols());
  for (Index i = 0; i < n; ++i) all.block(i * m.rows(), i * m.cols(), m.rows(), m.cols()) = m;
  return matrix(std::move(all));
}

/// Right-handed axes as rows, the third along the unit vector r.
Matrix3d across(const Vector3d& r) {
  Index least = 0;
  r.cwiseAbs().minCoeff(&least);
  Matrix3d V;
  V.row(0) = (Vector3d::Unit(least) - r(least) * r).normalized();
  V.row(1) = r.cross(V.row(0).transpose());
  V.row(2) = r;
  return V;
}

/// Its entries are 0, 1 and -1.
bool is_axis_permutation(const Matrix3d& V) {
  return (V.array() == 0 || V.array().abs() == 1).all();
}

constexpr int kMostTurns = 8;

}  // namespace

OpenTerms::OpenTerms(Graph& graph, ParameterValues values, std::span<const ToOpen> parameters,
                     std::vector<OpenedPairs>& pairs)
    : g_(graph), values_(values), parameters_(parameters), pairs_(pairs) {
  for (const Input& u : g_.inputs) names_.insert(u.name);
  for (const Output& y : g_.outputs) names_.insert(y.name);
}

const ToOpen* OpenTerms::find(const Value& value) const {
  if (!value.is_parameter()) return nullptr;
  const auto found = std::find_if(parameters_.begin(), parameters_.end(),
                                  [&](const ToOpen& p) { return p.parameter == value.index(); });
  return found == parameters_.end() ? nullptr : &*found;
}

bool OpenTerms::concerns(const Term& term) const {
  return std::any_of(term.factors.begin(), term.factors.end(), [&](const Factor& f) {
    if (const auto* k = std::get_if<Value>(&f)) return find(*k) != nullptr;
    const auto* T = std::get_if<Rotation>(&f);
    const auto values = T ? T->values() : std::vector<Value>{};
    return std::any_of(values.begin(), values.end(), [&](const Value& v) { return find(v); });
  });
}

int OpenTerms::pair(int parameter, int size, const std::string& where) {
  const std::string base = fmt::format("{}@{}", g_.parameters[at(parameter)].name, where);
  std::string name = base;
  for (int i = 2; !names_.insert(name).second; ++i) name = fmt::format("{} {}", base, i);
  const int w = add_input(g_, name, size);
  g_.inputs.back().parameter = parameter;
  g_.outputs.push_back({.name = name, .size = size, .set = true});
  g_.outputs.back().declared = static_cast<int>(g_.outputs.size()) - 1;
  pairs_.push_back({name, parameter, size, where});
  return w;
}

/// k x = nominal x + scale w, z = x.
void OpenTerms::times_value(std::vector<Term>& sum, const Value& value, const std::string& where) {
  const int w = pair(value.index(), rows_of(g_, sum.front()), where);
  g_.outputs.back().terms = sum;
  times(sum, Value(value.at(values_)));
  sum.push_back({.signal = w, .factors = {Value(value.scale())}});
}

/// How many turns by the channel's angle this angle is; 0 if none.
int OpenTerms::number_of_turns(const Value& angle, const std::string& where) {
  const ToOpen& p = *find(angle);
  const double turns = std::abs(angle.scale()) * (p.full_turn ? 2 : 1);
  if (turns == std::round(turns) && turns >= 1 && turns <= kMostTurns)
    return static_cast<int>(turns);
  const std::string& name = g_.parameters[at(p.parameter)].name;
  mistakes.push_back(
      {Code::not_rational,
       fmt::format("{}: the angle of {} is {} times the parameter {}", g_.name, where,
                   angle.scale(), name),
       {},
       fmt::format("declare a parameter for the smallest of its angles, of which all "
                   "others are 1 to {} times, or use sweep",
                   p.full_turn ? kMostTurns / 2 : kMostTurns)});
  return 0;
}

/// u becomes u + V' [J; 0] w, z = 2 [I, 0] V u + J w.
void OpenTerms::turn_more(std::vector<Term>& sum, const Rotation& V, int parameter, double sign,
                          const std::string& where) {
  const int rows = rows_of(g_, sum.front());
  const MatrixXd J = MatrixXd{{0, -sign}, {sign, 0}};
  MatrixXd into = MatrixXd::Zero(3, 2);
  into.topRows(2) = J;
  const int w = pair(parameter, rows / 3 * 2, where);
  std::vector<Term>& z = g_.outputs.back().terms;
  z = sum;
  times(z, V);
  times(z, on_each(2 * MatrixXd::Identity(2, 3), rows));
  z.push_back({.signal = w, .factors = {on_each(J, rows)}});
  sum.push_back({.signal = w, .factors = {V.inverse(), on_each(into, rows)}});
}

void OpenTerms::times_turn(std::vector<Term>& sum, const Rotation::Turn& turn,
                           const std::string& where) {
  const int turns = number_of_turns(turn.angle, where);
  const Matrix3d axes = across(turn.axis);
  const Rotation V = Rotation::matrix(axes);
  const double sign = turn.angle.scale() < 0 ? -1 : 1, nominal = turn.angle.at(values_);
  for (int i = 0; i < turns; ++i) turn_more(sum, V, turn.angle.index(), sign, where);
  if (is_axis_permutation(axes)) {
    times(sum, Rotation::about(turn.axis, nominal));
  } else {  // three factors, so that exact arithmetic finds the same axis in each
    times(sum, V);
    times(sum, Rotation::about(Vector3d::UnitZ(), nominal));
    times(sum, V.inverse());
  }
}

void OpenTerms::times_rotation(std::vector<Term>& sum, const Rotation& T,
                               const std::string& where) {
  const auto& steps = T.steps();
  for (auto step = steps.rbegin(); step != steps.rend(); ++step) {
    const auto* turn = std::get_if<Rotation::Turn>(&*step);
    if (turn && find(turn->angle))
      times_turn(sum, *turn, where);
    else
      times(sum, Rotation::of_steps({*step}));
  }
}

std::vector<Term> OpenTerms::written_out(const Term& term, const std::string& where) {
  std::vector<Term> sum{{.signal = term.signal, .of = term.of, .sign = term.sign}};
  for (auto f = term.factors.rbegin(); f != term.factors.rend(); ++f) {
    const auto* k = std::get_if<Value>(&*f);
    const auto* T = std::get_if<Rotation>(&*f);
    if (k && find(*k))
      times_value(sum, *k, where);
    else if (T)
      times_rotation(sum, *T, where);
    else
      times(sum, *f);
  }
  return sum;
}

std::vector<Term> OpenTerms::opened(std::vector<Term> terms, const std::string& where) {
  if (std::none_of(terms.begin(), terms.end(), [&](const Term& t) { return concerns(t); }))
    return terms;
  std::vector<Term> result;
  for (Term& t : terms) {
    if (!concerns(t)) {
      result.push_back(std::move(t));
      continue;
    }
    std::vector<Term> more = written_out(t, where);
    result.insert(result.end(), std::make_move_iterator(more.begin()),
                  std::make_move_iterator(more.end()));
  }
  return result;
}

}  // namespace titop::passes
