#pragma once

#include <Eigen/Core>
#include <complex>
#include <optional>
#include <titop/compiler/system/precision.hpp>
#include <vector>

namespace titop {

/// Cost of a transfer at one s.
struct TransferCost {
  int factorisations = 0;
  /// Right-hand sides solved for, steps of refinement and error estimates included.
  int columns = 0;
  int rows = 0;  ///< the same through the transposed factors
};

}  // namespace titop

/// Columns and rows of a transfer at one s, in any precision.
namespace titop::detail {

struct SystemData;

/// Inputs whose columns and outputs whose rows are requested: indices in the graph.
struct PartOfTransfer {
  std::vector<int> inputs, outputs;
};

/// The answer, in the order of the question.
struct TransferPart {
  Eigen::MatrixXcd columns;  ///< all outputs x scalars of the inputs
  Eigen::MatrixXcd rows;     ///< scalars of the outputs x all inputs
  TransferCost cost;
};

/// By one factorisation, a solve per column and a transposed one per row, each O(bodies). Judged,
/// refined and refused as System::transfer, whose columns and rows these are to 1e-12 of each
/// block. Throws also not_finite if numbers overflow.
TransferPart transfer_part(const SystemData& data, std::complex<double> s,
                           const PartOfTransfer& part, Precision precision = Precision::as_needed);

/// All columns: see System::transfer.
Eigen::MatrixXcd transfer_of(const SystemData& data, std::complex<double> s,
                             Precision precision = Precision::as_needed);

/// The same if there is a transfer: none at a pole, without a digit, or if it overflows.
std::optional<Eigen::MatrixXcd> transfer_if_any(const SystemData& data, std::complex<double> s);

/// The transfer by an elimination in long double, neither refined nor judged: its difference to
/// Precision::standard is the rounding of the elimination. Throws as System::transfer. O(bodies).
Eigen::MatrixXcd in_long_double(const SystemData& data, std::complex<double> s);

}  // namespace titop::detail
