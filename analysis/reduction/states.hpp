#pragma once

#include <titop/analysis/reduction/reduced_system.hpp>
#include <titop/analysis/reduction/split.hpp>

/// A reduced model by states, if there is no second-order form. For the library's own files.
namespace titop::detail {

/// D plus parts that are not coupled to each other: integrals, the kept part, the balanced part.
struct States {
  /// A part, and its transfer by poles if it has enough eigenvectors: left / (s - pole) * right.
  struct PartialFractions {
    SpectralPart part;
    Eigen::VectorXcd pole;
    Eigen::MatrixXcd left, right;
  };
  std::vector<PartialFractions> pieces;
  Eigen::MatrixXd D;
  std::string why;  ///< there is no second-order form

  Eigen::Index order() const;
  /// Outputs x inputs. O(order), O(order^3) for pieces without eigenvectors. Throws singular.
  Eigen::MatrixXcd transfer(std::complex<double> s) const;
  std::vector<std::complex<double>> poles() const;  ///< those with Im >= 0
  /// "kept1", ..., "balanced1", ...: the last piece is the balanced one.
  StateSpace state_space() const;
  /// Throws singular if poles are too close to defective, except for two that are 0.
  ModalModel modal() const;
  /// Per pole (or pair) with the blocks of the model's states (by name) that take part.
  std::vector<KeptMode> modes(const std::vector<std::string>& states) const;
};

States::PartialFractions piece(SpectralPart part);

/// C (s - A)^-1 B by LU. Throws singular. O(order^3).
Eigen::MatrixXcd transfer(const SpectralPart& part, std::complex<double> s);

}  // namespace titop::detail
