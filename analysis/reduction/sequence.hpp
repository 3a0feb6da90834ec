#pragma once

#include <titop/analysis/reduction/small.hpp>

/// The order in which modes and vectors are added. For the library's own files only.
namespace titop::detail {

/// The full transfer on samples of the ray, and the scale of each pair.
struct Samples {
  std::vector<double> omega;            ///< [rad/s], ascending
  std::vector<std::complex<double>> s;  ///< on the ray
  std::vector<Eigen::MatrixXcd> H;      ///< outputs x inputs
  Eigen::MatrixXd peak;                 ///< outputs x inputs, with the floor of pairs that are 0
  Eigen::MatrixXd alike;  ///< the pairs if ports were coupled equally to all modes, or the
                          ///< cancelling terms, if these are larger: scale of the rounding
};

/// H - Hr on one sample. Throws not_finite, with the frequency, if either is not.
Eigen::MatrixXcd difference(const Samples& full, const Eigen::MatrixXcd& Hr, std::size_t k);
inline Eigen::MatrixXcd difference(const Samples& full, const Small& small, std::size_t k) {
  return difference(full, small.transfer(full.s[k]), k);
}

/// Largest |H - Hr| / peak over the samples, per pair.
Eigen::MatrixXd errors(const Samples& full, const Small& small);

/// One nested sequence of models of increasing accuracy: it does not depend on the required
/// accuracy, so that more accuracy never gives a smaller order.
///
/// Each step starts where the error is largest, for one input and one output (unit vectors:
/// independent of units, and symmetry classes stay separate). If dropped modes of the band explain
/// half of the error there, the one with the largest term is added; otherwise the static-like
/// response (Lambda - omega^2)^-1 b of the modes above the band to that input and, if outputs and
/// inputs are not collocated, the same for that output as the next step: often the first suffices.
/// W is 0 on the band's modes: no added vector can have a pole in the band that the whole has not.
///
/// An omitted mode keeps its asymptote: its static part if it is in the band or above it,
/// its limit at infinite frequency if it is below.
class Sequence {
 public:
  /// `high`: upper end of the band [rad/s].
  Sequence(const Whole& whole, const Samples& samples, double high);

  /// One step more; false if no step reduces the error.
  bool grow();

  /// One model of the sequence.
  struct Step {
    Eigen::Index kept = 0, columns = 0;  ///< modes of the band and columns of W so far
    double error = 0;                    ///< on the samples
  };
  const std::vector<Step>& steps() const { return steps_; }
  Small model(std::size_t step) const { return model(choice(step)); }

  /// The coordinates of a model beside the motions without stiffness.
  struct Choice {
    std::vector<Eigen::Index> kept;  ///< modes of the band
    Eigen::MatrixXd vectors;         ///< as they were added, not orthogonal: elastic modes x count
    std::size_t size() const { return kept.size() + static_cast<std::size_t>(vectors.cols()); }
  };
  Choice choice(std::size_t step) const;
  Small model(const Choice& choice) const;

 private:
  struct WorstPair {
    Eigen::Index output = 0, input = 0;
    std::size_t sample = 0;
    double error = 0;
  };
  WorstPair evaluate();
  bool stalled() const;

  Small small(const std::vector<Eigen::Index>& kept, const Eigen::MatrixXd& W) const;
  bool extend(const WorstPair& worst);
  bool keep_one(const WorstPair& worst, double least);
  /// Terms of dropped modes in this error: of each alone, or, coupled, of all added together.
  Eigen::VectorXcd own_terms(const WorstPair& worst, const std::vector<Eigen::Index>& modes) const;
  Eigen::VectorXcd coupled_terms(const WorstPair& worst,
                                 const std::vector<Eigen::Index>& modes) const;
  bool add_columns(const WorstPair& worst);
  bool add(Eigen::VectorXd column);
  bool add_pending();
  void note(const WorstPair& worst);

  const Whole& whole_;
  const Samples& samples_;
  Eigen::Index inside_ = 0;  ///< elastic modes in the band or below it
  std::vector<char> below_;  ///< mode by mode: its poles lie below the band
  bool collocated_ = false;
  std::vector<Eigen::Index> kept_;
  std::vector<char> is_kept_;
  Eigen::MatrixXd W_;        ///< elastic modes x columns
  Eigen::MatrixXd added_;    ///< the same before they were made orthogonal
  Eigen::VectorXd pending_;  ///< the output's column to the input's that came last; or empty
  Small model_;
  WorstPair worst_;
  std::vector<Eigen::MatrixXcd> error_;
  std::vector<Step> steps_;
};

}  // namespace titop::detail
