#pragma once

#include <limits>

/// Constants of rounding in double that several decisions share (docs/numerics.md).
namespace titop::linalg {

/// Distance of 1 to the next double, twice the unit roundoff u.
inline constexpr double kEpsilon = std::numeric_limits<double>::epsilon();
/// Rounding of a sum of up to 128 products, of the sum of their magnitudes: gamma_n = n u [Higham,
/// Accuracy and Stability of Numerical Algorithms, 3.1]. A smaller sum is rounding.
inline constexpr double kProductRounding = 64 * kEpsilon;
/// Half the digits of double, the root of its rounding: two equal eigenvalues or singular values,
/// and the place of a maximum, are known no better from matrices with all their digits [Golub, Van
/// Loan 7.2].
inline constexpr double kHalfDigits = 0x1p-26;
/// Distance, relative to their modulus, of two roots that are one for exact data: half the digits,
/// times up to 64 of their condition.
inline constexpr double kDoubleRoot = 64 * kHalfDigits;
/// Rounding of products of a few rotations, relative to their terms, with room for axes of twelve
/// typed digits: a smaller component, asymmetry or work is 0.
inline constexpr double kAxisRounding = 1e-12;
/// Remainder of a unit vector beside others: if it is smaller the vector is in their span, to
/// within the digits of a static response.
inline constexpr double kInSpan = 1e-7;
/// A matrix is symmetric, semidefinite or orthonormal, and an axis depends on others, to this share
/// of its size: nine typed digits, or the rounding of an elimination.
inline constexpr double kMatrixDigits = 1e-9;

/// Rounding of sums of sums of products (some thousand units), relative to their terms: a smaller
/// sum is 0.
inline constexpr double kSumsOfSums = 1e-12;

/// The accuracy that is promised, six digits less than double has: larger errors of results are
/// reported, smaller effects on them need not be kept, and derivatives that agree to it count as
/// smooth.
inline constexpr double kWarn = 1e-9;
/// Numbers read from a text file have some six digits: a smaller relative difference, or share of
/// the largest, is 0.
inline constexpr double kTextDigits = 1e-6;
/// Three digits: results with a larger error are not used, nor are pivots below this share of the
/// best, which would cost more than three digits.
inline constexpr double kThreeDigits = 1e-3;
/// Times one sample of rounding, which may be small by chance: a smaller number may be rounding
/// alone.
inline constexpr double kNoise = 1e3;
/// A number is larger than another beyond rounding: otherwise the first in the graph is taken, so
/// that a choice does not depend on the last bits.
inline constexpr double kTie = 1 + 1e-9;
/// Of the largest: those that are as large count as equal, where eigenvectors and factors have lost
/// some digits; the first is taken.
inline constexpr double kEqual = 1 - 1e-6;
/// A tenth, one decimal digit: a result that its data, or one step of refinement, change by more
/// has none.
inline constexpr double kOneDigit = 0.1;
/// Steps of refinement that shrink by less do not converge.
inline constexpr double kShrinks = 0.25;
/// Of the norm of a matrix: poles as near as that are one number.
inline constexpr double kOneNumber = 100 * kEpsilon;

/// Relative: frequencies, poles and dampings this near are equal. The vectors of two such modes
/// have no digits of their own [Golub, Van Loan 8.1.3].
inline constexpr double kSameFrequency = 1e-9;
/// A pole is on the imaginary axis if its real part is below this share of its modulus: it may be
/// rounding.
inline constexpr double kPoleOnAxis = 1e-9;

}  // namespace titop::linalg
