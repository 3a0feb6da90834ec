#pragma once

#include <titop/compiler/system/dense_model.hpp>
#include <titop/compiler/system/system_data.hpp>

/// The passes with numbers, in their order, after those on the graph (compiler/passes/passes.hpp).
/// Each takes all that is compiled so far and returns it with its own result added; none reads the
/// result of a later one. They throw only for the user's mistakes.
namespace titop::steps {

/// A system while it is compiled; `data` refers to `skeleton`.
struct Compiled {
  std::shared_ptr<detail::Skeleton> skeleton;
  std::shared_ptr<detail::SystemData> data;
};

/// Skeleton::layout, Factored::states: every state, input and output has its name, and its row in
/// the model. O(nodes).
Compiled layout(Compiled c);

/// Numbers::blocks: A, B, C, D of every block at the parameters' values. O(blocks).
Compiled blocks(Compiled c);

/// Skeleton::joint, Numbers::coefficients: the equations of all interface unknowns, and the plan of
/// their elimination. O(terms).
Compiled join(Compiled c);

/// Skeleton::dependents: the data that depend on each parameter, for `update`; parameters on which
/// nothing depends are noted. O(terms).
Compiled depend(Compiled c);
bool has_parameters(const Compiled& c);

/// Factored::factors: all interface unknowns are eliminated, or the factors are singular. O(sum of
/// front sizes^3).
Compiled solve(Compiled c);

/// Factored::margins, Factored::weak_pivots: the margin of every loop is known, and whether
/// rounding was taken for a pivot (compiler/solve/weak_pivot.hpp).
Compiled pivots(Compiled c);

/// The factors are regular: hidden constraints and their derivatives are found and eliminated, with
/// the threshold of `pivots` (compiler/index_reduction/reduce.hpp). If the equations are singular
/// by a pivot that is rounding, internal forces and data are judged first: their errors name the
/// cause. Throws improper, ill_posed, kinematic_loop, structure, not_finite.
Compiled reduce(Compiled c);
bool has_no_pivot(const Compiled& c);

/// No output and no controller reads an internal force that the motion does not determine, or it is
/// noted (compiler/loops/internal_forces.hpp). Throws kinematic_loop.
Compiled forces(Compiled c);
bool is_overconstrained(const Compiled& c);

/// No motion and no force depends on digits that the data of flexible bodies do not have
/// (compiler/solve/data_digits.hpp). Throws improper.
Compiled digits(Compiled c);
bool has_data(const Compiled& c);

/// The certificate: a function of all the others. No pass before it depends on it; `minimize`
/// reads from it whether digits are lost.
Compiled certify(Compiled c);

/// A, B, C, D are written from the factors and compared with them. O(n^2); see
/// compiler/certificate/dense_check.hpp. Throws not_finite.
detail::Realization dense(const detail::SystemData& data);

/// The model is minimal, up to Options::minimize_up_to states, if the change of its transfer near
/// the removed modes is below 1e-8 (or ten times Options::resolution). O(n^3).
detail::Minimal minimize(const detail::SystemData& data, const detail::Realization& written);

}  // namespace titop::steps
