#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <titop/blocks/bushing.hpp>
#include <titop/blocks/specified.hpp>
#include <titop/graph/linalg/eigen.hpp>
#include <titop/graph/linalg/rounding.hpp>
#include <titop/graph/opened.hpp>

namespace titop {
namespace {

using Eigen::MatrixXd;

const Interface& bushing_face() {
  static const Interface shared{
      {{"child", 6, Takes::accel}, {"parent", 6, Takes::accel}},
      {},
      {{"displacement", 6, Quantity::position}, {"rate", 6, Quantity::velocity}},
      {"x", "y", "z", "rx", "ry", "rz", "x_rate", "y_rate", "z_rate", "rx_rate", "ry_rate",
       "rz_rate"},
      rates_follow(6)};
  return shared;
}

/// Entries have different units: each is judged against the diagonal of its row and column.
void check_matrix(const Matrix6& m, std::string_view subject) {
  const auto refuse = [&](const std::string& why, const char* hint) {
    throw Error(Code::bad_value, fmt::format("the Bushing's {} is {}", subject, why), hint);
  };
  if (!m.allFinite())
    throw Error(Code::not_finite, fmt::format("the Bushing's {} is not finite", subject),
                "give finite numbers");
  Vector6 size = Vector6::Zero();
  for (int i = 0; i < 6; ++i) {
    if (m(i, i) < 0)
      refuse(
          fmt::format("{} on axis {}", m(i, i), bushing_face().states[static_cast<std::size_t>(i)]),
          "springs and dampers must be 0 or more");
    size(i) = std::sqrt(m(i, i));
  }
  Matrix6 scaled = Matrix6::Zero();
  for (int i = 0; i < 6; ++i)
    for (int j = 0; j < 6; ++j) {
      const double scale = size(i) * size(j);
      if (std::abs(m(i, j) - m(j, i)) > linalg::kMatrixDigits * std::max(scale, std::abs(m(i, j))))
        refuse(fmt::format("not symmetric: {} and {} at ({}, {})", m(i, j), m(j, i), i + 1, j + 1),
               "give the full symmetric matrix, (x, y, z, rx, ry, rz)");
      if (scale == 0 && m(i, j) != 0)
        refuse(fmt::format("not positive semidefinite: 0 on the diagonal beside {} at ({}, {})",
                           m(i, j), i + 1, j + 1),
               "a coupled axis needs a stiffness of its own");
      if (scale > 0) scaled(i, j) = m(i, j) / scale;
    }
  const Eigen::SelfAdjointEigenSolver<Matrix6> solver(scaled, Eigen::EigenvaluesOnly);
  if (const double least = solver.eigenvalues()(0); least < -linalg::kMatrixDigits)
    refuse(fmt::format("not positive semidefinite: scaled to a diagonal of 1 its least eigenvalue "
                       "is {:.3g}",
                       least),
           "check the signs and sizes of the coupling terms");
}

class BushingBlock : public Block, public Specified<Bushing> {
 public:
  explicit BushingBlock(const Bushing& spec) : spec_(spec) {}
  const Bushing& spec() const override { return spec_; }
  std::string_view type() const override { return "Bushing"; }
  const Interface& interface() const override { return bushing_face(); }
  std::shared_ptr<const Dynamics> dynamics(ParameterValues values) const override {
    const Matrix6 K = spec_.stiffness.at(values), C = spec_.damping.at(values);
    check_matrix(K, "stiffness");
    check_matrix(C, "damping");
    const MatrixXd I = MatrixXd::Identity(6, 6), O = MatrixXd::Zero(6, 6);
    auto d = std::make_shared<Dynamics>();
    d->A = (MatrixXd(12, 12) << O, I, O, O).finished();
    d->B = (MatrixXd(12, 12) << O, O, I, -I).finished();
    d->C = (MatrixXd(24, 12) << K, C, K, C, I, O, O, I).finished();
    d->D = MatrixXd::Zero(24, 12);
    return d;
  }
  Pattern feedthrough() const override { return Pattern::Constant(24, 12, false); }
  std::optional<Kinematics> kinematics(ParameterValues values) const override {
    Kinematics k{.reference = 1, .tau = {}, .Phi = {}};
    k.tau.assign(2, MatrixXd::Identity(6, 6));
    k.Phi = {MatrixXd::Identity(6, 12), MatrixXd::Zero(6, 12)};
    k.stiffness = Eigen::VectorXd::Zero(12);
    k.stiffness.head(6) = spec_.stiffness.at(values).diagonal();
    return k;
  }
  std::vector<Value> values() const override {
    std::vector<Value> all;
    for (const SixAxes* m : {&spec_.stiffness, &spec_.damping})
      for (const SixAxes::Entry& e : m->entries()) all.push_back(e.value);
    return all;
  }
  /// z = the displacement or the rate of axis i, w acts on axis j; and likewise j and i.
  std::optional<Opened> opened(ParameterValues values,
                               std::span<const int> parameters) const override {
    std::vector<OpenedPair> pairs;
    const auto add = [&](const Value& v, int of, int on, int rate) {
      pairs.push_back({v,
                       {},
                       Eigen::VectorXd::Unit(24, on) + Eigen::VectorXd::Unit(24, 6 + on),
                       Eigen::RowVectorXd::Unit(12, of + rate),
                       {}});
    };
    for (const auto& [m, rate] : {std::pair(&spec_.stiffness, 0), {&spec_.damping, 6}})
      for (const SixAxes::Entry& e : m->entries()) {
        add(e.value, e.column, e.row, rate);
        if (e.row != e.column) add(e.value, e.row, e.column, rate);
      }
    return with_pairs(*dynamics(values), pairs, parameters);
  }
  std::optional<Cause> why_singular(int, ParameterValues) const override {
    return Cause{"is a massless spring",
                 "give the body on it mass and inertia, or impose its "
                 "motion instead of the force on it"};
  }

 private:
  Bushing spec_;
};

}  // namespace

SixAxes::SixAxes(Value x, Value y, Value z, Value rx, Value ry, Value rz) {
  int i = 0;
  for (const Value& v : {x, y, z, rx, ry, rz}) {
    numbers_(i, i) = v.nominal();
    if (v.is_parameter()) entries_.push_back({i, i, v});
    ++i;
  }
}

SixAxes SixAxes::with(int row, int column, Value value) const {
  if (std::min(row, column) < 1 || std::max(row, column) > 6)
    throw Error(Code::bad_value, fmt::format("entry ({}, {}) of a 6 x 6 matrix", row, column),
                "rows and columns count from 1 to 6: x, y, z, rx, ry, rz");
  SixAxes m = *this;
  const int i = std::min(row, column) - 1, j = std::max(row, column) - 1;
  std::erase_if(m.entries_, [&](const Entry& e) { return e.row == i && e.column == j; });
  m.entries_.push_back({i, j, value});
  m.numbers_(i, j) = m.numbers_(j, i) = value.nominal();
  m.diagonal_ = m.diagonal_ && i == j;
  return m;
}

Matrix6 SixAxes::at(ParameterValues values) const {
  Matrix6 m = numbers_;
  for (const Entry& e : entries_) m(e.row, e.column) = m(e.column, e.row) = e.value.at(values);
  return m;
}

Matrix6 SixAxes::nominal() const { return numbers_; }

BlockPtr as_block(const Bushing& spec) {
  check_matrix(spec.stiffness.nominal(), "stiffness");
  check_matrix(spec.damping.nominal(), "damping");
  return std::make_shared<BushingBlock>(spec);
}

Bushing::Handle bushing(Diagram& d, std::string name, const DualPort<6>& a, const DualPort<6>& b,
                        const Rotation& T_ba, const Bushing& spec, SourceLine at) {
  const Bushing::Handle result = d.add(name, spec, at);
  // Its ends are massless: the force of each is added to the sum of forces at its point.
  detail::mount(result.child.accel, result.child.reaction, a.accel, a.force, {}, at, -1);
  detail::mount(result.parent.accel, result.parent.reaction, b.accel, b.force,
                detail::to_joint(T_ba, a.accel, name, at), at);
  return result;
}

}  // namespace titop
