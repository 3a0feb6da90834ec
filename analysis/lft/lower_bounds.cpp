#include <algorithm>
#include <random>
#include <titop/analysis/lft/lower_bounds.hpp>
#include <titop/compiler/definition/exact/solve.hpp>
#include <titop/graph/linalg/index.hpp>

namespace titop::detail {
namespace {

using Eigen::Index;
using exact::ExactMatrix;
using exact::Residue;
using linalg::at;

using Indices = std::vector<Index>;

/// Random numbers, the same in every run.
class Random {
 public:
  Residue operator()() {
    const auto part = [&] { return Residue(static_cast<int>(bits_() >> 34)); };
    const Residue high = part();
    return high * Residue(1 << 30) + part();
  }
  ExactMatrix matrix(Index rows, Index cols) {
    ExactMatrix m(rows, cols);
    for (Residue& entry : m.entries) entry = (*this)();
    return m;
  }

 private:
  std::mt19937_64 bits_{1};
};

ExactMatrix part(const ExactMatrix& m, const Indices& rows, const Indices& cols) {
  ExactMatrix p(static_cast<Index>(rows.size()), static_cast<Index>(cols.size()));
  for (Index i = 0; i < p.rows; ++i)
    for (Index j = 0; j < p.cols; ++j) p(i, j) = m(rows[at(i)], cols[at(j)]);
  return p;
}

ExactMatrix sum(ExactMatrix a, const ExactMatrix& b) {
  for (std::size_t i = 0; i < a.entries.size(); ++i) a.entries[i] += b.entries[i];
  return a;
}

/// m times diag(factors).
ExactMatrix scaled_columns(ExactMatrix m, const std::vector<Residue>& factors) {
  for (Index i = 0; i < m.rows; ++i)
    for (Index j = 0; j < m.cols; ++j) m(i, j) *= factors[at(j)];
  return m;
}

/// The matrix from [kept columns] to [kept rows] with the columns `in` fed by the rows `out` times
/// these factors.
ExactMatrix fed_back(const ExactMatrix& m, const Indices& out, const Indices& in,
                     const std::vector<Residue>& factors, const Indices& rows,
                     const Indices& cols) {
  ExactMatrix E = Residue(-1) * scaled_columns(part(m, out, in), factors);
  for (Index i = 0; i < E.rows; ++i) E(i, i) += 1;
  const ExactMatrix z = solved(E, part(m, out, cols));
  return sum(part(m, rows, cols), scaled_columns(part(m, rows, in), factors) * z);
}

/// Rank of the Loewner matrix of f, a function of one number, at `points` points on each side.
template <class F>
int degree(F f, int points, Index ny, Index nu, Random& random) {
  const Index k = points;
  const ExactMatrix R = random.matrix(nu, k), L = random.matrix(k, ny);
  std::vector<Residue> x(at(k)), y(at(k));
  ExactMatrix W(ny, k), V(k, nu);  // f(x_b) R_b, L_a f(y_a)
  Indices all_y(at(ny)), all_u(at(nu));
  for (Index i = 0; i < k; ++i) {
    x[at(i)] = random(), y[at(i)] = random();
    const ExactMatrix at_x = f(x[at(i)]), at_y = f(y[at(i)]);
    for (Index r = 0; r < ny; ++r)
      for (Index c = 0; c < nu; ++c) {
        W(r, i) += at_x(r, c) * R(c, i);
        V(i, c) += L(i, r) * at_y(r, c);
      }
  }
  const ExactMatrix left = V * R, right = L * W;
  ExactMatrix loewner(k, k);
  for (Index a = 0; a < k; ++a)
    for (Index b = 0; b < k; ++b)
      loewner(a, b) = (left(a, b) - right(a, b)) * (y[at(a)] - x[at(b)]).inverse();
  return rank_of(loewner);
}

/// The exact model of an opened diagram, and the places of its pairs and of the user's signals.
struct OpenedModel {
  exact::Model model;
  std::vector<int> parameter;  ///< of each pair
  Indices w, z, u, y;

  OpenedModel(const Graph& g, ParameterValues values)
      : model(exact::model_of(g, {.rotations = ExactRotations::nearest}, values)) {
    std::vector<Index> column(g.signals.size(), -1), row;
    Index next = 0;
    for (std::size_t s = 0; s < g.signals.size(); ++s)
      if (g.signals[s].role == Signal::Role::external) column[s] = next, next += g.signals[s].size;
    next = 0;
    for (const Output& o : g.outputs) row.push_back(next), next += o.size;
    std::vector<char> is_z(g.outputs.size(), 0);
    for (const Input& input : g.inputs) {
      for (int i = 0; i < input.size; ++i)
        (input.parameter >= 0 ? w : u).push_back(column[at(input.signal)] + i);
      if (input.parameter < 0) continue;
      const auto same = std::find_if(g.outputs.begin(), g.outputs.end(),
                                     [&](const Output& o) { return o.name == input.name; });
      const auto o = static_cast<std::size_t>(same - g.outputs.begin());
      is_z[o] = 1;
      for (int i = 0; i < input.size; ++i)
        z.push_back(row[o] + i), parameter.push_back(input.parameter);
    }
    for (std::size_t o = 0; o < g.outputs.size(); ++o)
      for (int i = 0; i < g.outputs[o].size && !is_z[o]; ++i) y.push_back(row[o] + i);
  }
  /// A random deviation for each parameter, at all of its pairs.
  std::vector<Residue> deviations(Random& random) const {
    std::vector<Residue> of(
        parameter.empty() ? 0 : at(*std::max_element(parameter.begin(), parameter.end())) + 1);
    for (Residue& d : of) d = random();
    std::vector<Residue> result;
    for (const int p : parameter) result.push_back(of[at(p)]);
    return result;
  }
};

/// The degree in parameter p, at most `most` + 2.
int degree_in(const OpenedModel& o, const ExactMatrix& M, int p, int most, Random& random) {
  const std::vector<Residue> deviations = o.deviations(random);
  Indices in, out, rows, cols;  // pairs of other parameters; then those of p and the signals
  std::vector<Residue> others;
  Index own = 0;
  for (std::size_t k = 0; k < o.parameter.size(); ++k) {
    const bool other = o.parameter[k] != p;
    (other ? in : cols).push_back(o.w[k]), (other ? out : rows).push_back(o.z[k]);
    if (other) others.push_back(deviations[k]);
    own += !other;
  }
  cols.insert(cols.end(), o.u.begin(), o.u.end());
  rows.insert(rows.end(), o.y.begin(), o.y.end());
  const ExactMatrix N = fed_back(M, out, in, others, rows, cols);
  Indices first, ys, us;
  for (Index k = 0; k < own; ++k) first.push_back(k);
  for (Index k = own; k < N.rows; ++k) ys.push_back(k);
  for (Index k = own; k < N.cols; ++k) us.push_back(k);
  const auto f = [&](const Residue& d) {
    return fed_back(N, first, first, std::vector<Residue>(at(own), d), ys, us);
  };
  return degree(f, most + 2, static_cast<Index>(ys.size()), static_cast<Index>(us.size()), random);
}

int degree_in_s(const OpenedModel& o, int most, Random& random) {
  const std::vector<Residue> deviations = o.deviations(random);
  const auto f = [&](const Residue& s) {
    return fed_back(transfer_of(o.model, s), o.z, o.w, deviations, o.y, o.u);
  };
  return degree(f, most + 2, static_cast<Index>(o.y.size()), static_cast<Index>(o.u.size()),
                random);
}

}  // namespace

LowerBounds lower_bounds(const Stage& stage, ParameterValues values,
                         const std::vector<int>& parameters, const std::vector<int>& most,
                         int states) {
  LowerBounds b;
  b.at_least.assign(parameters.size(), 0);
  if (stage.chained) {
    b.why_not = "chains close, which they do only up to rounding of their data";
    return b;
  }
  try {
    Random random;
    const OpenedModel o(*stage.source, values);
    const ExactMatrix M = transfer_of(o.model, random());
    for (std::size_t i = 0; i < parameters.size(); ++i)
      b.at_least[i] = degree_in(o, M, parameters[i], most[i], random);
    if (states > 0) b.states = degree_in_s(o, states, random);
  } catch (const exact::Undecided& u) {
    b = {std::vector<int>(parameters.size(), 0), 0, u.why};
  }
  return b;
}

}  // namespace titop::detail
