#include <titop/blocks/opened_flexible_body.hpp>
#include <titop/graph/linalg/index.hpp>
#include <titop/graph/opened.hpp>

namespace titop {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::RowVectorXd;
using Eigen::VectorXd;

/// The pairs of one body, mode by mode.
class ModalPairs {
 public:
  ModalPairs(const FlexibleBody::Spec& spec, const detail::ModalParameters& modes,
             const MatrixXd& W)
      : spec_(spec), modes_(modes), W_(W), n_(modes.omega.size()) {
    for (Index i = 0; i < n_; ++i) {
      if (!has_values(i)) continue;
      frequency_and_damping(i);
      entries(i);
    }
  }

  std::vector<OpenedPair> list;

 private:
  /// An entry of W: its input, the factor of its value, and the child that it belongs to; -1: P.
  struct Place {
    const Value* value;
    Index input;
    double sign;
    int child;
  };

  bool has_values(Index i) const {
    const int mode = static_cast<int>(i + 1);
    return spec_.values.omega.contains(mode) || spec_.values.xi.contains(mode) ||
           !places(i).empty();
  }

  RowVectorXd state(Index k) const { return RowVectorXd::Unit(2 * n_, k); }

  /// A pair whose w adds `factor` w to etadd of mode i, and so W_i' factor w to the outputs.
  OpenedPair on_mode(Index i, const Value& value, double factor) const {
    return {value, factor * VectorXd::Unit(2 * n_, n_ + i), factor * W_.row(i).transpose(), {}, {}};
  }

  void frequency_and_damping(Index i) {
    const auto value = [&](const std::map<int, Value>& values, double number) {
      const auto found = values.find(static_cast<int>(i + 1));
      return found == values.end() ? Value(number) : found->second;
    };
    const double w = modes_.omega(i), x = modes_.xi(i);
    const Value omega = value(spec_.values.omega, w), xi = value(spec_.values.xi, x);
    const std::size_t first = list.size();
    list.push_back(on_mode(i, omega, -w));
    list.back().of_states = state(i);
    list.push_back(on_mode(i, xi, -2 * w));
    list.back().of_states = state(n_ + i);
    list.push_back(on_mode(i, omega, -1));
    list.back().of_states = w * state(i) + 2 * x * state(n_ + i);
    list.back().of_pairs = {{first, 1}, {first + 1, 2}};
    accelerates_ = {{first, -w}, {first + 1, -2 * w}, {first + 2, -1}};
  }

  /// The entries of W in the row of mode i.
  std::vector<Place> places(Index i) const {
    std::vector<Place> result;
    const auto add = [&](const std::vector<ModeValues::Entry>& of, Index first, double sign,
                         int child) {
      for (const ModeValues::Entry& e : of)
        if (e.mode == i + 1) result.push_back({&e.value, first + e.component - 1, sign, child});
    };
    const auto& children = spec_.data->children;
    for (std::size_t c = 0; c < children.size(); ++c)
      if (const auto of = spec_.values.Phi_C.find(children[c].name); of != spec_.values.Phi_C.end())
        add(of->second, static_cast<Index>(6 * c), 1, static_cast<int>(c));
    add(spec_.values.L_P, W_.cols() - 6, -1, -1);
    return result;
  }

  void entries(Index i) {
    const std::vector<Place> of_mode = places(i);
    for (const Place& p : of_mode) {
      accelerates_.emplace_back(list.size(), p.sign);
      list.push_back(on_mode(i, *p.value, p.sign));
      list.back().of_inputs = RowVectorXd::Unit(W_.cols(), p.input);
      list.back().scale_z = true;
    }
    const double w = modes_.omega(i), x = modes_.xi(i);
    for (const Place& p : of_mode) {
      list.push_back({*p.value, {}, p.sign * VectorXd::Unit(W_.cols(), p.input), {}, {}});
      OpenedPair& pair = list.back();
      pair.of_states = -w * w * state(i) - 2 * x * w * state(n_ + i);
      pair.of_inputs = W_.row(i);
      pair.of_pairs = accelerates_;
      if (p.child < 0) continue;
      pair.moves = p.child;
      pair.moved_by = Vector6::Unit(p.input - 6 * p.child);
      pair.of_motion_states = state(i);
    }
  }

  const FlexibleBody::Spec& spec_;
  const detail::ModalParameters& modes_;
  const MatrixXd& W_;
  Index n_;
  std::vector<std::pair<std::size_t, double>> accelerates_;  ///< pairs in etadd of the last mode
};

}  // namespace

Opened opened_flexible_body(const FlexibleBody::Spec& spec, const detail::ModalParameters& modes,
                            const MatrixXd& W, const Dynamics& dynamics,
                            std::span<const int> parameters) {
  return with_pairs(dynamics, ModalPairs(spec, modes, W).list, parameters);
}

}  // namespace titop
