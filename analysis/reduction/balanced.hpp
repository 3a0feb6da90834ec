#pragma once

#include <optional>
#include <titop/analysis/reduction/gramians.hpp>
#include <titop/analysis/reduction/ray.hpp>
#include <titop/analysis/reduction/states.hpp>

/// Selection of the balanced model for a scene. For the library's own files only.
namespace titop::detail {

/// Models of every order of a system without M, D, K: integrals and poles on the axis or right of
/// it whole, the rest balanced and truncated.
///
/// Inputs and outputs are scaled by port sizes derived from the pairs' peaks (port_sizes), so that
/// the Hankel singular values bound errors relative to these. Of each order there are up to four
/// models: balanced over the whole axis, or with low-passes at the band's upper end, which reduces
/// dynamics outside the band but has no a-priori bound; and reduced by truncation or by singular
/// perturbation. The model with the least error on the samples is taken; low-passes only if no
/// other model meets the target. An order is accepted as soon as one model meets it, so that more
/// accuracy never gives a smaller order.
///
/// One factorisation gives the errors of all orders at one sample (`learn`): a model that fails is
/// checked where its error is largest, and all orders that clearly fail there are skipped.
class Balanced {
 public:
  /// `split` and `samples` must outlive this object. O(60 n^3).
  Balanced(const StateSpace& model, const Split& split, const Samples& samples, double high);

  struct Choice {
    Eigen::Index order = 0;  ///< of the balanced part
    bool weighted = false, truncated = true;
    double error = 0;  ///< on the samples, relative to the pairs' peaks
  };
  /// The least order from this one on with an error up to this; none if there is no such order.
  std::optional<Choice> find(Eigen::Index from, double target) const;
  /// The model of least error of the largest orders there are.
  Choice best() const;

  States model(const Choice& choice) const;
  /// Outputs x inputs: bound of each pair by the dropped singular values, everywhere right of the
  /// axis, in the pair's own units; 0 x 0: none.
  Eigen::MatrixXd anywhere(const Choice& choice) const;

  Eigen::Index integrals() const { return split_.integrals.order(); }
  Eigen::Index kept() const { return kept_.part.order(); }
  Eigen::Index silent() const { return split_.kept.order() - kept(); }
  Eigen::Index stable() const { return split_.stable.order(); }
  int unstable() const;  ///< states of poles right of the axis

 private:
  const Balancing& balancing(const Choice& c) const { return *balancings_[c.weighted ? 1 : 0]; }
  /// On the samples; HUGE_VAL if it is more than the limit, or the model not stable.
  double error(const Choice& choice, double limit) const;
  /// True if the learnt errors are clearly above this target.
  bool fails(const Choice& choice, double target) const;
  /// Notes the errors of all orders of this kind of cut on this sample. O(5 n^3).
  void learn(const Choice& choice, std::size_t sample) const;

  const Split& split_;
  States::PartialFractions kept_;
  Eigen::MatrixXd D_;
  const Samples& samples_;
  std::vector<Eigen::MatrixXcd> rest_;  ///< of the samples, without the kept part
  PortSizes sizes_;
  std::optional<Balancing> balancings_[2];
  /// By weighted, truncated, order: an error on some sample, 0 if none is known.
  mutable Eigen::VectorXd seen_[2][2];
};

}  // namespace titop::detail
