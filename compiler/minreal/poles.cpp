#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <numeric>
#include <optional>
#include <titop/compiler/minreal/at_zero.hpp>
#include <titop/compiler/minreal/poles.hpp>
#include <titop/compiler/minreal/poles_of.hpp>
#include <titop/compiler/realization/proportional.hpp>
#include <titop/graph/error.hpp>
#include <titop/graph/linalg/dense.hpp>

/// Poles of any model, with their blocks.
namespace titop {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;

std::string block_of(const std::string& state) { return state.substr(0, state.rfind('.')); }

Pole make_pole(std::complex<double> s, bool pair) {
  Pole p;
  p.s = s;
  p.pair = pair;
  p.omega = std::abs(s);
  p.hertz = p.omega / (2 * std::numbers::pi);
  p.damping = p.omega > 0 ? -s.real() / p.omega + 0.0 : 0;
  return p;
}

void set_blocks(Pole& pole, const StateSpace& model, const VectorXd& share) {
  std::map<std::string, double> sum;
  for (Eigen::Index i = 0; i < share.size(); ++i)
    sum[block_of(model.states[static_cast<std::size_t>(i)])] += share(i);
  const double total = share.sum();
  for (const auto& [name, value] : sum)
    if (total > 0 && value >= 0.05 * total) pole.blocks.emplace_back(name, value / total);
  std::stable_sort(pole.blocks.begin(), pole.blocks.end(),
                   [](const auto& a, const auto& b) { return a.second > b.second; });
}

/// Poles of yddot + z ydot + w2 y = 0: a pair, or two real ones, the slow one by their product.
std::vector<Pole> roots(double w2, double z) {
  const double half = z / 2, omega = std::sqrt(std::max(w2, 0.0));
  const double root2 = w2 > 0 ? (half - omega) * (half + omega) : half * half - w2;
  if (root2 < 0) return {make_pole({-half, std::sqrt(-root2)}, true)};
  const double fast = -(half + std::copysign(std::sqrt(root2), half));
  return {make_pole(fast != 0 ? w2 / fast : 0, false), make_pole(fast, false)};
}

/// Poles of yddot + Z ydot + S y = 0; false if it has no proportional_modes.
bool proportional_poles(const StateSpace& model, const SecondOrder& form, std::vector<Pole>& out) {
  const std::optional<ProportionalModes> modes = proportional_modes(form);
  if (!modes) return false;
  const auto& [lambda, V] = modes->undamped.modes;
  const MatrixXd right = form.D * V, left = form.D_inverse.transpose() * V;
  for (Eigen::Index k = 0; k < lambda.size(); ++k) {
    VectorXd share = VectorXd::Zero(model.A.rows());
    share(form.q) = right.col(k).cwiseProduct(left.col(k)).cwiseAbs();
    for (Pole& p : roots(lambda(k), modes->z(k))) {
      set_blocks(p, model, share);
      out.push_back(std::move(p));
    }
  }
  return true;
}

/// The eigensystem of a whole model, of which each pole takes the nearest eigenvalue that no other
/// has taken.
class Shares {
 public:
  explicit Shares(const MatrixXd& A)
      : e_(linalg::eigensystem(A)), left_(static_cast<std::size_t>(A.rows()), 1) {}

  Eigen::VectorXcd values() const { return e_.values; }
  /// Participation factors of the states.
  VectorXd take(std::complex<double> s) {
    Eigen::Index best = -1;
    for (Eigen::Index k = 0; k < e_.values.size(); ++k)
      if (left_[static_cast<std::size_t>(k)] &&
          (best < 0 || std::abs(e_.values(k) - s) < std::abs(e_.values(best) - s)))
        best = k;
    left_[static_cast<std::size_t>(best)] = 0;
    return e_.V.col(best).cwiseProduct(e_.W.row(best).transpose()).cwiseAbs();
  }

 private:
  linalg::Eigensystem e_;
  std::vector<char> left_;
};

void general_poles(const StateSpace& model, const MatrixXd& rounding, std::vector<Pole>& out) {
  Shares shares(model.A);
  const MatrixXd rest = minreal::without_poles_at_zero(model, rounding);
  const Eigen::Index zeros = model.A.rows() - rest.rows();
  const Eigen::VectorXcd values = zeros == 0 ? shares.values() : linalg::eigenvalues(rest);
  const auto add = [&](std::complex<double> s) {
    const VectorXd share = shares.take(s);
    if (s.imag() < 0) return;
    Pole p = make_pole(s, s.imag() > 0);
    set_blocks(p, model, share);
    out.push_back(std::move(p));
  };
  for (const std::complex<double> s : values) add(s);
  for (Eigen::Index k = 0; k < zeros; ++k) add(0);
}

/// States that no state depends on through A, or that depend on no state (a free hinge's angle,
/// then its rate; an integrator): exact poles at A(j, j), mostly 0, that a numerical eigenvalue
/// routine would smear. Takes them out of the model, one after the other; returns the places of the
/// states that stay.
std::vector<Eigen::Index> deflate(StateSpace& m, MatrixXd& energy, std::vector<Pole>& out) {
  std::vector<Eigen::Index> stay(static_cast<std::size_t>(m.A.rows()));
  std::iota(stay.begin(), stay.end(), Eigen::Index{0});
  for (bool found = true; found;) {
    found = false;
    for (Eigen::Index j = 0; j < m.A.rows() && !found; ++j) {
      const auto zero_but = [&](const auto& line) {
        for (Eigen::Index i = 0; i < line.size(); ++i)
          if (i != j && line(i) != 0) return false;
        return true;
      };
      if (!zero_but(m.A.col(j)) && !zero_but(m.A.row(j))) continue;
      found = true;
      Pole p = make_pole(m.A(j, j), false);
      p.blocks.emplace_back(block_of(m.states[static_cast<std::size_t>(j)]), 1.0);
      out.push_back(std::move(p));
      std::vector<Eigen::Index> keep;
      for (Eigen::Index i = 0; i < m.A.rows(); ++i)
        if (i != j) keep.push_back(i);
      m.A = m.A(keep, keep).eval();
      if (energy.size() > 0) energy = energy(keep, keep).eval();
      stay.erase(stay.begin() + j);
      m.states.erase(m.states.begin() + j);
      if (j < std::ssize(m.rates)) m.rates.erase(m.rates.begin() + j);
    }
  }
  return stay;
}

}  // namespace

std::vector<Pole> poles(const StateSpace& model, const MatrixXd& rounding, const MatrixXd& energy) {
  return detail::poles_of(
      model, [&] { return rounding; }, energy);
}

std::vector<Pole> detail::poles_of(const StateSpace& model,
                                   const std::function<MatrixXd()>& rounding,
                                   const MatrixXd& energy) {
  if (model.A.rows() != model.A.cols())
    throw Error(Code::size, fmt::format("poles: A is {} x {}", model.A.rows(), model.A.cols()),
                "give a square A");
  std::vector<Pole> result;
  StateSpace rest{model.A, {}, {}, {}, model.states, {}, {}, model.rates};
  if (std::ssize(rest.states) != rest.A.rows()) {  // without names all is one block
    rest.states.assign(static_cast<std::size_t>(rest.A.rows()), "x");
    rest.rates.clear();
  }
  MatrixXd energy_of_rest = energy;
  const std::vector<Eigen::Index> stay = deflate(rest, energy_of_rest, result);
  std::vector<Pole> others;
  const SecondOrder form = second_order(rest, energy_of_rest);
  if (!form.found || !proportional_poles(rest, form, others)) {
    others.clear();
    if (rest.order() > 0) {
      const MatrixXd of_all = rounding();
      general_poles(rest, of_all.size() > 0 ? MatrixXd(of_all(stay, stay)) : of_all, others);
    }
  }
  result.insert(result.end(), others.begin(), others.end());
  std::stable_sort(result.begin(), result.end(), [](const Pole& a, const Pole& b) {
    return a.omega != b.omega ? a.omega < b.omega : a.s.real() < b.s.real();
  });
  return result;
}

std::string xi_of_bodies(const Pole& p) {
  const std::string least = fmt::format("{:.4g}", p.least_xi),
                    largest = fmt::format("{:.4g}", p.largest_xi);
  return least == largest ? least : least + " to " + largest;
}

std::string to_string(const std::vector<Pole>& list) {
  std::string text = fmt::format("{:>14} {:>14} {:>12}  {}\n", "rad/s", "Hz", "damping", "blocks");
  for (const Pole& p : list) {
    std::string blocks;
    for (const auto& [name, share] : p.blocks)
      blocks += fmt::format("{}{} {:.0f} %", blocks.empty() ? "" : ", ", name, 100 * share);
    text += fmt::format("{:>14.7g} {:>14.7g} {:>12.4g}  {}{}{}\n", p.omega, p.hertz, p.damping,
                        blocks, p.pair ? "" : "  (real)",
                        p.unlike_bodies() ? fmt::format("  (bodies: xi {})", xi_of_bodies(p)) : "");
  }
  return text;
}

}  // namespace titop
