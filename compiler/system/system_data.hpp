#pragma once

#include <atomic>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <titop/compiler/certificate/check.hpp>
#include <titop/compiler/certificate/dense_check.hpp>
#include <titop/compiler/solve/factored.hpp>
#include <titop/compiler/system/system.hpp>

/// The data behind a System. For the library's own files only.
namespace titop::detail {

/// Per parameter of the graph the data that depend on it, for `update`. O(terms).
std::vector<Dependents> find_dependents(const Stage& stage, const solve::JointSystem& joint);

/// Data of a System: the factors, and results that are computed at their first use.
struct SystemData : Factored {
  mutable std::once_flag check_once;
  mutable Check check;

  mutable std::once_flag dense_once;
  mutable StateSpace dense;
  mutable double dense_against_factors = -1;
  mutable DenseError dense_error{{-1}, {-1}};
  mutable std::vector<Note> dense_notes;
  mutable OrderVerdict dense_order;
  mutable std::atomic<bool> dense_ready = false;  ///< all of the above may be read

  /// The certificate: computed by `compile`; of an updated system at the first call.
  const Check& checked() const;
};

/// True if new values of these parameters change the input of pass `close`: the kinematics of a
/// block, or equations between motions. Masses and stiffnesses do not.
bool moves_chains(const Skeleton& skeleton, const std::vector<int>& changed, ParameterValues before,
                  ParameterValues now);

/// The transfer if there is one: none at a pole, without a digit, or if it overflows.
std::optional<Eigen::MatrixXcd> transfer_if_any(const System& system, std::complex<double> s);

/// All passes and the certificate once more for these values of the parameters. States that
/// followed from the others still do, if that keeps the digits. `note` adds to the notes.
std::shared_ptr<const SystemData> compile_again(const Skeleton& old,
                                                const std::vector<double>& values,
                                                const std::function<void(SystemData&)>& note);

/// Replaces the dense model by the minimal one if the change of its transfer near the removed modes
/// is below 1e-8 (or ten times Options::resolution); reports it in dense_order and dense_notes.
void minimize_checked(const System& system, const SystemData& data, StateSpace& dense);

}  // namespace titop::detail
