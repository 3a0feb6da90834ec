#include <doctest/doctest.h>

#include <titop/graph/linalg/eigen.hpp>
#include <titop/titop.hpp>

#include "support/rng.hpp"

/// Multiple poles and poles at 0, which have no vectors of their own: orders by theory.

using namespace titop;
using namespace titop_test;
using Complex = std::complex<double>;
using Eigen::Index;
using Eigen::MatrixXd;

namespace {

StateSpace model(const MatrixXd& A, const MatrixXd& B, const MatrixXd& C) {
  StateSpace m{A, B, C, MatrixXd::Zero(C.rows(), B.cols()), {}, {}, {}};
  for (Index i = 0; i < A.rows(); ++i) m.states.push_back("x" + std::to_string(i));
  for (Index i = 0; i < B.cols(); ++i) m.inputs.push_back("u" + std::to_string(i));
  for (Index i = 0; i < C.rows(); ++i) m.outputs.push_back("y" + std::to_string(i));
  return m;
}

/// Order and transfer of the minimal model.
template <class Transfer>
void is(int order, const Transfer& G, const StateSpace& m) {
  const Minimized r = minimize(m);
  CAPTURE(to_string(r.order));
  CHECK(r.order.decided());
  CHECK(r.model.order() == order);
  for (const Complex s : {Complex(0.3, 2), Complex(0.01, 0.02), Complex(5, 40)})
    CHECK(std::abs(r.model.transfer(s)(0, 0) - G(s)) <= 1e-13 * std::abs(G(s)));
}

}  // namespace

TEST_CASE("whole clusters: a pole at 0 that the output does not see, or the input does not move") {
  const MatrixXd A{{-1, 1}, {1, -1}}, e1{{1}, {0}};
  const auto G = [](Complex s) { return 1.0 / (s + 2.0); };
  const StateSpace unseen = model(A, e1, MatrixXd{{1, -1}});
  is(1, G, unseen);
  is(1, G, model(A, MatrixXd{{1}, {-1}}, e1.transpose()));
  // Its static gain exists once the pole has left.
  CHECK(std::abs(minimize(unseen).model.transfer(0)(0, 0) - 0.5) <= 1e-15);
  is(
      2, [](Complex s) { return (s + 1.0) / (s * (s + 2.0)); }, model(A, e1, e1.transpose()));
}

TEST_CASE("whole clusters: double poles of which one factor cancels, and sums that need two") {
  const MatrixXd A{{0, 1}, {-25, -10}}, B{{0}, {1}};
  const auto lag = [](Complex s) { return 1.0 / (s + 5.0); };
  const auto both = [&](Complex s) { return lag(s) * lag(s) + lag(s); };
  is(1, lag, model(A, B, MatrixXd{{5, 1}}));
  is(1, lag, model(A.transpose(), MatrixXd{{5}, {1}}, B.transpose()));
  is(2, both, model(A, B, MatrixXd{{6, 1}}));
  is(2, both,
     model(MatrixXd{{0, 1, 0}, {-25, -10, 0}, {0, 0, -5}}, MatrixXd{{0}, {1}, {1}},
           MatrixXd{{1, 0, 1}}));
  is(2, both,
     model(MatrixXd{{-5, 1, 0}, {0, -5, 0}, {0, 0, -5}}, MatrixXd{{0}, {1}, {1}},
           MatrixXd{{1, 0, 1}}));
}

TEST_CASE("whole clusters: a slow pole that nothing moves leaves beside a fast block") {
  for (const double a : {1e-9, 1e-8, 1e-7, -1e-8}) {
    CAPTURE(a);
    is(
        2, [](Complex s) { return 1.0 / (s * s + 0.3 * s + 4.0); },
        model(MatrixXd{{a, 0, 0}, {0, 0, 1}, {0, -4, -0.3}}, MatrixXd{{0}, {0}, {1}},
              MatrixXd{{4, 1, 0}}));
  }
}

namespace {

struct Planted {
  StateSpace model;
  int order;
};

/// A Jordan block of size k at `pole`, of which inputs move the first r coordinates and the first q
/// are unobservable: r - q of it count. With it pairs that count, all in turned coordinates.
Planted planted(Rng& rng, Index k, Index r, Index q, double pole, Index pairs) {
  const Index n = k + 2 * pairs;
  MatrixXd A = MatrixXd::Zero(n, n), B = rng.matrix(n, 2), C = rng.matrix(2, n);
  A.diagonal().head(k).setConstant(pole);
  for (Index i = 0; i + 1 < k; ++i) A(i, i + 1) = rng.between(0.5, 2);
  for (Index i = 0; i < pairs; ++i) {
    const double w = 3.0 + 2.0 * double(i);
    A.block(k + 2 * i, k + 2 * i, 2, 2) << -0.1, w, -w, -0.1;
  }
  B.middleRows(r, k - r).setZero();
  C.leftCols(q).setZero();
  const MatrixXd T = Eigen::HouseholderQR<MatrixXd>(rng.matrix(n, n)).householderQ();
  return {model(T * A * T.transpose(), T * B, C * T.transpose()),
          static_cast<int>(std::max<Index>(0, r - q) + 2 * pairs)};
}

}  // namespace

TEST_CASE("whole clusters: 400 planted Jordan blocks, at 0 and elsewhere: never decided wrong") {
  Rng rng(2718);
  int right = 0;
  for (int trial = 0; trial < 400; ++trial) {
    const Index k = 1 + rng.below(3), r = rng.below(int(k) + 1), q = rng.below(int(k) + 1);
    const int others = rng.below(3);
    const Planted p = planted(rng, k, r, q, rng.chance(0.5) ? 0 : -1, others);
    CAPTURE(trial);
    const Minimized m = minimize(p.model);
    CAPTURE(to_string(m.order));
    CHECK(m.order.lowest <= p.order);
    CHECK(m.order.highest >= p.order);
    right += m.order.decided() && m.model.order() == p.order;
  }
  CHECK(right >= 396);
}
