#include <fmt/format.h>

#include <algorithm>
#include <mutex>
#include <optional>
#include <set>
#include <titop/graph/linalg/shifted.hpp>
#include <titop/graph/nodes/lti.hpp>
#include <titop/graph/opened.hpp>
#include <titop/graph/paths.hpp>
#include <titop/graph/pole.hpp>
#include <titop/graph/state_space.hpp>

namespace titop {
namespace {

using Eigen::MatrixXd;

/// With fewer states a dense solution takes less than 50 us. From here on a Schur form saves time
/// after 4 to 7 points (graph/linalg/shifted.hpp), and a compile with its certificate takes more.
constexpr Eigen::Index kManyStates = 32;

/// The number in place of which a value stands; null if there is none.
double* entry_of(Dynamics& d, const Lti::Entry& e) {
  MatrixXd* m = e.matrix == 'A'   ? &d.A
                : e.matrix == 'B' ? &d.B
                : e.matrix == 'C' ? &d.C
                : e.matrix == 'D' ? &d.D
                                  : nullptr;
  if (!m || e.row < 1 || e.row > m->rows() || e.column < 1 || e.column > m->cols()) return nullptr;
  return &(*m)(e.row - 1, e.column - 1);
}

/// Puts the nominal values into the matrices. Throws bad_value for a place that is none, and for
/// two values at one place.
void fill(Dynamics& d, const std::vector<Lti::Entry>& entries) {
  std::set<const double*> filled;
  for (const Lti::Entry& e : entries) {
    double* number = entry_of(d, e);
    if (!number)
      throw Error(Code::bad_value,
                  fmt::format("Lti: a value is given for {}({}, {})", e.matrix, e.row, e.column),
                  "matrices are A, B, C and D, rows and columns count from 1");
    if (!filled.insert(number).second)
      throw Error(
          Code::bad_value,
          fmt::format("Lti: two values are given for {}({}, {})", e.matrix, e.row, e.column),
          "give one value per place: a sum of parameters is a parameter of its own");
    *number = e.value.nominal();
  }
}

class LtiBlock : public Block {
 public:
  LtiBlock(std::string_view type, Dynamics matrices, std::vector<Lti::Entry> entries = {})
      : type_(type),
        matrices_(std::make_shared<const Dynamics>(std::move(matrices))),
        entries_(std::move(entries)) {
    const auto n = static_cast<int>(matrices_->A.rows());
    face_.inputs.push_back({"in", static_cast<int>(matrices_->D.cols())});
    face_.outputs.push_back({"out", static_cast<int>(matrices_->D.rows())});
    for (int i = 1; i <= n; ++i) face_.states.push_back(fmt::format("x{}", i));
    for (int i = 0; i < n; ++i)
      face_.rates.push_back(
          matrices_->B.row(i).isZero(0) && !has_value(i) ? unit_entry(matrices_->A, i) : -1);
  }
  std::string_view type() const override { return type_; }
  const Interface& interface() const override { return face_; }
  const std::vector<Lti::Entry>& entries() const { return entries_; }
  std::shared_ptr<const Dynamics> dynamics(ParameterValues values) const override {
    if (entries_.empty()) return matrices_;
    auto d = std::make_shared<Dynamics>(*matrices_);
    for (const Lti::Entry& e : entries_) *entry_of(*d, e) = e.value.at(values);
    return d;
  }
  std::vector<Value> values() const override {
    std::vector<Value> all;
    for (const Lti::Entry& e : entries_) all.push_back(e.value);
    return all;
  }
  /// z = the state or input of the entry's column, w acts on its row.
  std::optional<Opened> opened(ParameterValues values,
                               std::span<const int> parameters) const override {
    std::vector<OpenedPair> pairs;
    for (const Lti::Entry& e : entries_) {
      const bool on_state = e.matrix == 'A' || e.matrix == 'B',
                 of_state = e.matrix == 'A' || e.matrix == 'C';
      OpenedPair p{e.value, {}, {}, {}, {}};
      (on_state ? p.on_states : p.on_outputs) =
          Eigen::VectorXd::Unit(on_state ? matrices_->A.rows() : matrices_->D.rows(), e.row - 1);
      (of_state ? p.of_states : p.of_inputs) = Eigen::RowVectorXd::Unit(
          of_state ? matrices_->A.rows() : matrices_->D.cols(), e.column - 1);
      pairs.push_back(std::move(p));
    }
    return with_pairs(*dynamics(values), pairs, parameters);
  }
  /// O(states^2) after the first call.
  Response response(std::complex<double> s, ParameterValues values) const override {
    if (matrices_->A.rows() < kManyStates || !entries_.empty()) return Block::response(s, values);
    std::call_once(solver_once_, [&] {
      try {
        solver_.emplace(matrices_->A, matrices_->B);
        paths_ = paths(matrices_->A, matrices_->B);
      } catch (const Error&) {  // no Schur form: point by point
      }
    });
    if (!solver_) return Block::response(s, values);
    linalg::Solution x = solver_->solve(s);
    if (!(x.rcond > 0) || !x.z.allFinite()) throw pole_at(s, fmt::format("a {}", type_));
    Eigen::MatrixXcd X = x.z.cwiseProduct(paths_);
    Eigen::MatrixXcd Y = matrices_->C * X + matrices_->D;
    return {std::move(X), std::move(Y)};
  }
  /// A controller that was given without a direct term has none: its data are its type.
  Pattern feedthrough() const override {
    const bool direct = std::any_of(entries_.begin(), entries_.end(),
                                    [](const Lti::Entry& e) { return e.matrix == 'D'; });
    return Pattern::Constant(matrices_->D.rows(), matrices_->D.cols(),
                             direct || !matrices_->D.isZero(0));
  }
  /// A gain by another name.
  bool is_algebraic() const override { return matrices_->A.rows() == 0; }
  bool has_frame() const override { return false; }

 private:
  bool has_value(int state) const {
    return std::any_of(entries_.begin(), entries_.end(), [&](const Lti::Entry& e) {
      return (e.matrix == 'A' || e.matrix == 'B') && e.row == state + 1;
    });
  }

  std::string_view type_;
  Interface face_;
  std::shared_ptr<const Dynamics> matrices_;  ///< at nominal values
  std::vector<Lti::Entry> entries_;
  mutable std::once_flag solver_once_;
  mutable std::optional<linalg::ShiftedSolver> solver_;
  mutable MatrixXd paths_;  ///< to the states
};

/// y = the integral of u, also of a user's Lti: passes search for these.
bool is_integrator(const Dynamics& m) {
  const auto n = m.A.rows();
  return n > 0 && m.B.cols() == n && m.C.rows() == n && m.A.isZero(0) && m.B.isIdentity(0) &&
         m.C.isIdentity(0) && m.D.isZero(0);
}

}  // namespace

Lti::Handle::Handle(Graph* graph, int node)
    : in(detail::SignalRef(graph, detail::port_signal(*graph, node, "in"))),
      out(graph, detail::port_signal(*graph, node, "out")) {}

BlockPtr as_block(const Lti& spec) {
  Dynamics m{spec.A, spec.B, spec.C, spec.D};
  const auto n = m.A.rows();
  const auto nu = m.D.size() ? m.D.cols() : m.B.cols();
  const auto ny = m.D.size() ? m.D.rows() : m.C.rows();
  if (m.D.size() == 0) m.D = MatrixXd::Zero(ny, nu);
  if (n == 0 && m.B.size() == 0 && m.C.size() == 0) m.B.resize(0, nu), m.C.resize(ny, 0);
  if (n == 0) m.A.resize(0, 0);
  if (m.A.cols() != n || m.B.rows() != n || m.B.cols() != nu || m.C.rows() != ny ||
      m.C.cols() != n || nu == 0 || ny == 0)
    throw Error(Code::size,
                fmt::format("Lti: A is {}x{}, B {}x{}, C {}x{}, D {}x{}", spec.A.rows(),
                            spec.A.cols(), spec.B.rows(), spec.B.cols(), spec.C.rows(),
                            spec.C.cols(), spec.D.rows(), spec.D.cols()),
                "A must be n x n, B n x nu, C ny x n, D ny x nu, with nu and ny at least 1");
  fill(m, spec.values);
  for (const MatrixXd* matrix : {&m.A, &m.B, &m.C, &m.D})
    if (!matrix->allFinite())
      throw Error(Code::not_finite, "Lti: an entry is not finite", "check the matrices' source");
  std::vector<Lti::Entry> entries = spec.values;
  std::erase_if(entries, [](const Lti::Entry& e) { return !e.value.is_parameter(); });
  const bool integrates = entries.empty() && is_integrator(m);
  return std::make_shared<LtiBlock>(integrates ? "Integrator" : "Lti", std::move(m),
                                    std::move(entries));
}

std::vector<Lti::Entry> lti_values(const Block& block) {
  const auto* lti = dynamic_cast<const LtiBlock*>(&block);
  return lti ? lti->entries() : std::vector<Lti::Entry>{};
}

BlockPtr as_block(const Integrator& spec) {
  const int n = spec.size;
  if (n < 1)
    throw Error(Code::size, fmt::format("an Integrator of size {}", n), "give it 1 or more");
  return std::make_shared<LtiBlock>("Integrator",
                                    Dynamics{MatrixXd::Zero(n, n), MatrixXd::Identity(n, n),
                                             MatrixXd::Identity(n, n), MatrixXd::Zero(n, n)});
}

}  // namespace titop
