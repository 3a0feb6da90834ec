#pragma once

#include <memory>
#include <span>
#include <titop/compiler/certificate/check.hpp>
#include <titop/compiler/solve/factored.hpp>
#include <titop/compiler/system/dense_model.hpp>
#include <titop/graph/support/once.hpp>

/// The data behind a System. For the library's own files only.
namespace titop::detail {

/// Per parameter of the graph the data that depend on it, for `update`. O(terms).
std::vector<Dependents> find_dependents(const Stage& stage, const solve::JointSystem& joint);

/// Data of a System: the factors, and results that are computed at their first use.
struct SystemData : Factored {
  Once<Check> check;
  Once<std::vector<Note>> all_notes, all_dense_notes;
  Once<DenseModel> dense;

  /// The certificate: computed by `compile`; of an updated system at the first call.
  const Check& checked() const;
  /// Those of the passes, of updates and of the certificate.
  const std::vector<Note>& noted() const;
};

/// True if new values of these parameters change the input of pass `close`: the kinematics of a
/// block, or equations between motions. Masses and stiffnesses do not.
bool moves_chains(const Skeleton& skeleton, const std::vector<int>& changed, ParameterValues before,
                  ParameterValues now);

/// Throws not_finite.
[[noreturn]] void refuse_overflow(const std::string& subject);

/// All passes of `compile` once more for these values of the parameters. States that followed from
/// the others still do, if that keeps the digits.
std::shared_ptr<SystemData> compile_again(const SystemData& old, const std::vector<double>& values);

/// See System::update.
std::shared_ptr<const SystemData> updated(const SystemData& old,
                                          std::span<const std::pair<std::string, double>> values);

}  // namespace titop::detail
