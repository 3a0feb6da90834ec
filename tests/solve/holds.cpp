#include <doctest/doctest.h>

#include <boost/multiprecision/cpp_bin_float.hpp>
#include <boost/multiprecision/eigen.hpp>
#include <titop/compiler/solve/backward_error.hpp>
#include <titop/compiler/solve/refined_solution.hpp>
#include <titop/compiler/solve/scalar.hpp>

#include "sparse_system.hpp"

/// Solutions by factors with a planted mistake do not hold, in any precision.

using namespace solve_test;
using titop_test::Rng;
using Double = std::complex<double>;
using Twofold = std::complex<titop::solve::DoubleDouble>;
using titop::solve::Complex50;
using Real = boost::multiprecision::cpp_bin_float_50;

namespace {

template <class T>
std::vector<RowEntries<T>> entries_in(const std::vector<RowEntries<double>>& entries) {
  std::vector<RowEntries<T>> result;
  for (const RowEntries<double>& row : entries) {
    result.emplace_back();
    for (const MatrixXd& block : row)
      result.back().push_back(
          block.unaryExpr([](double x) { return titop::solve::Scalar<T>::from(x); }));
  }
  return result;
}

/// A x = b by the factors of another matrix, refined `steps` times. The results are the unknowns.
template <class T>
class Solution final : public titop::detail::RefinedSolution<T> {
 public:
  Solution(const System& right, const System& factored, const MatrixXd& b, int steps)
      : factors_(factors_of<T>(factored.structure, entries_in<T>(factored.entries))),
        A_(b.rows(), b.rows()),
        b_(titop::solve::lifted<T>(b)),
        exact_(b) {
    const MatrixXd A = right.to_dense();
    MatrixXd ordered = A;
    const titop::solve::Plan& plan = factors_.plan();
    const std::vector<int> row = places(plan.row_first, plan.structure.row_size),
                           column = places(plan.first, plan.structure.variable_size);
    for (Eigen::Index i = 0; i < A.rows(); ++i)
      for (Eigen::Index j = 0; j < A.cols(); ++j) ordered(row[at(i)], column[at(j)]) = A(i, j);
    A_ = titop::solve::lifted<T>(ordered);
    const Eigen::MatrixX<Real> wide = ordered.cast<Real>();
    exact_ = wide.fullPivLu().solve(b.cast<Real>()).eval().template cast<double>();
    this->unknowns_ = factors_.solve(b_);
    for (int i = 0; i < steps; ++i) this->improve();
  }

  titop::solve::RowMatrix<T> solve(const RowMatrix<T>& rhs) const override {
    return factors_.solve(rhs);
  }
  double weakest_pivot() const override { return factors_.health().weakest; }
  bool singular() const { return factors_.health().singular; }

  /// The largest error of an unknown, over the largest unknown.
  double error() const {
    return (titop::solve::in_double(this->unknowns_) - exact_).cwiseAbs().maxCoeff() /
           exact_.cwiseAbs().maxCoeff();
  }

 private:
  using Dense = Eigen::Matrix<T, Eigen::Dynamic, Eigen::Dynamic>;

  static std::vector<int> places(const std::vector<int>& first, const std::vector<int>& sizes) {
    std::vector<int> result;
    for (std::size_t i = 0; i < sizes.size(); ++i)
      for (int k = 0; k < sizes[i]; ++k) result.push_back(first[i] + k);
    return result;
  }
  static double size(const Dense& x) {
    double largest = 0;
    for (Eigen::Index i = 0; i < x.size(); ++i)
      largest = std::max(largest, titop::solve::size_of(x(i)));
    return largest;
  }
  static MatrixXd sizes(const Dense& x) {
    return x.unaryExpr([](const T& entry) { return titop::solve::size_of(entry); });
  }

  RowMatrix<T> residual(RowMatrix<double>* magnitudes) const override {
    if (magnitudes) *magnitudes = sizes(A_) * sizes(this->unknowns_) + sizes(b_);
    return b_ - A_ * this->unknowns_;
  }
  double relative_to_results(const RowMatrix<T>& change) const override {
    return size(change) / size(this->unknowns_);
  }
  Eigen::ArrayXd sizes_of_unknowns(const RowMatrix<Double>& unknowns) const override {
    return unknowns.cwiseAbs().reshaped();
  }
  double backward_error(const RowMatrix<T>& residual,
                        const RowMatrix<double>& magnitudes) const override {
    return titop::solve::backward_error(factors_.plan(), residual, magnitudes);
  }
  double backward_error_of_rounding(double epsilon) const override {
    return titop::solve::backward_error_of_rounding(factors_.plan(), epsilon);
  }

  Eigen::VectorXd unit_sizes() const override { return Eigen::VectorXd::Ones(A_.cols()); }
  Eigen::VectorXd sums_of(const Eigen::VectorXd& unit) const override { return sizes(A_) * unit; }

  titop::solve::Factors<T> factors_;
  Dense A_;
  RowMatrix<T> b_;
  MatrixXd exact_;
};

struct Count {
  int tried = 0, wrong = 0, refused = 0;
};

/// A mistake in one entry of the matrix that is factored; wrong: passed on with an error.
template <class T>
Count with_a_mistake(double factor, int steps) {
  Count count;
  for (std::uint64_t seed = 1; seed <= 10; ++seed) {
    Rng rng(seed);
    for (const Kind& kind : kinds(rng)) {
      const System right = random_system(kind.links, kind.n, rng, 2);
      System factored = right;
      RowEntries<double>& row = factored.entries[at(rng.below(kind.n))];
      MatrixXd& block = row[at(rng.below(static_cast<int>(row.size())))];
      block(rng.below(static_cast<int>(block.rows())), 0) *= factor;
      const Solution<T> found(right, factored, rng.matrix(right.size(), 1), steps);
      if (found.singular()) continue;
      const bool refused = !found.holds();
      CAPTURE(seed);
      CAPTURE(kind.name);
      if (factor == 1) CHECK(found.holds());
      ++count.tried;
      count.refused += refused;
      count.wrong += !refused && !(found.error() <= 1e-11);
    }
  }
  return count;
}

template <class T>
void check_mistakes() {
  for (const double factor : {1.0, 1 + 1e-3, 1.5, -1.0, 100.0}) {
    CAPTURE(factor);
    const Count count = with_a_mistake<T>(factor, 1);
    CHECK(count.tried >= 50);
    CHECK(count.wrong == 0);
    if (factor == 1)
      CHECK(count.refused == 0);
    else
      CHECK(count.refused >= count.tried / 2);
  }
}

}  // namespace

TEST_CASE("a mistake in the factors is noticed by the equations that do not hold") {
  check_mistakes<Double>();
  check_mistakes<Twofold>();
  check_mistakes<Complex50>();
}
