#include <doctest/doctest.h>

#include <limits>
#include <titop/compiler/solve/backward_error.hpp>

#include "support/lossy_row.hpp"

using namespace titop;
using titop_test::LossyRow;
using Count = titop_test::LossyRowCount;
using Double = std::complex<double>;

namespace {

/// Waves in a row held at its base, with a force on its tip.
LossyRow row_of(int n) { return {n, 20, LossyRow::Base::held, LossyRow::Tip::force}; }

}  // namespace

TEST_CASE("lossy rows: the transfer of every length, damping and causality is right") {
  Count count;
  for (const int n : {10, 30, 100, 300})
    for (const double damping : {0.0, 0.1, 20.0, 1e3})
      for (const LossyRow& row : titop_test::lossy_rows(n, damping)) {
        const System system = compile(row.diagram());
        CHECK(system.certificate().pivot_growth <= 100);  // pivots of at least 0.1 of their column
        for (const double re : {0.0, 2.19, 20.0})
          for (const double im : {0.031, 2.23, 8.0, 15.93}) count.ask(system, row, {re, im});
      }
  MESSAGE(count.tried, " tried, ", count.wrong, " wrong, ", count.refused, " refused");
  CHECK(count.wrong == 0);
  CHECK(count.refused == 0);
}

TEST_CASE("lossy rows: positions of the tip and forces on the wall, by Python in 80 digits") {
  // K + C s + M s^2 of the row, eliminated from the wall on; a force of 1 N on the tip.
  struct {
    int n;
    double omega;
    Double tip, wall;
  } const rows[] = {{100,
                     15.93,
                     {-2.2498497274964244e-3, -1.2045955621989646e-3},
                     {1.6136108251871849e-28, 1.4111847106416609e-28}},
                    {300,
                     15.93,
                     {-2.2498497274964244e-3, -1.2045955621989646e-3},
                     {-3.8969685096521795e-84, 2.4671993977000509e-84}},
                    {300,
                     8,
                     {-6.5825469841364579e-3, -4.4063459770586584e-3},
                     {-2.9205546226479089e-58, 6.0030654193830491e-58}}};
  for (const auto& row : rows) {
    const System system = compile(row_of(row.n).diagram());
    const Double s(0, row.omega);
    for (const Precision precision : {Precision::standard, Precision::refined, Precision::twofold,
                                      Precision::digits50, Precision::as_needed}) {
      CAPTURE(row.n);
      CAPTURE(row.omega);
      const Eigen::MatrixXcd G = system.transfer(s, precision);
      CHECK(std::abs(G(0, 0) - row.wall) <= 1e-12 * std::abs(row.wall));
      CHECK(std::abs(G(1, 0) - s * s * row.tip) <= 1e-12 * std::abs(s * s * row.tip));
    }
  }
}

TEST_CASE("lossy rows: of two thousand masses") {
  Count count;
  const LossyRow row = row_of(2000);
  const System system = compile(row.diagram());
  for (const Double s : {Double(0, 15.93), Double(0, 8), Double(2.19, 2.23), Double(0, 0.1)})
    count.ask(system, row, s);
  CHECK(count.wrong == 0);
  CHECK(count.refused == 0);
}

TEST_CASE("lossy rows: every precision is right, none is refused") {
  Count count;
  const LossyRow row = row_of(150);
  const System system = compile(row.diagram());
  for (const Precision precision :
       {Precision::standard, Precision::refined, Precision::twofold, Precision::digits50})
    for (const Double s : {Double(0, 15.93), Double(0, 8), Double(2.19, 2.23)})
      count.ask(system, row, s, precision);
  CHECK(count.wrong == 0);
  CHECK(count.refused == 0);
}

TEST_CASE("lossy rows: after an update from a thousand times the damping, and back") {
  Count count;
  const auto [held, driven, free, free_driven] = titop_test::lossy_rows(300, 20);
  for (const LossyRow& row : {held, driven, free, free_driven}) {
    LossyRow strong = row;
    strong.damping = 2e4;
    const System first = compile(strong.diagram("c"));
    const System second = first.update({{"c", 20.0}}), third = second.update({{"c", 2e4}});
    for (const Double s : {Double(0, 15.93), Double(0, 8), Double(2.19, 2.23)}) {
      count.ask(second, row, s);
      count.ask(third, strong, s);
    }
  }
  CHECK(count.tried == 24);
  CHECK(count.wrong == 0);
  CHECK(count.refused == 0);
}

TEST_CASE("lossy rows: A, B, C, D, and the steps of apply, of sixty masses") {
  Count by_model, by_apply;
  for (const double damping : {0.1, 20.0})
    for (const LossyRow& row : titop_test::lossy_rows(60, damping)) {
      const System system = compile(row.diagram(), {.minimize_up_to = 0});
      const StateSpace& m = system.state_space();
      StateSpace read = m;  // column by column from apply
      const Eigen::Index n = m.order();
      for (Eigen::Index j = 0; j <= n; ++j) {
        const Eigen::VectorXd all = Eigen::VectorXd::Unit(n + 1, j);
        const System::Rates r = system.apply(all.head(n), all.tail(1));
        if (j < n)
          read.A.col(j) = r.xdot, read.C.col(j) = r.y;
        else
          read.B.col(0) = r.xdot, read.D.col(0) = r.y;
      }
      for (const Double s : {Double(2.19, 2.23), Double(0, 0.31)}) {
        by_model.judge(m.transfer(s), row, s);
        by_apply.judge(read.transfer(s), row, s);
      }
    }
  CHECK(by_model.tried == 16);
  CHECK(by_model.wrong == 0);
  CHECK(by_apply.wrong == 0);
}

TEST_CASE("backward error: the worst row by its own terms, threes of a vector together") {
  using titop::solve::RowMatrix;
  titop::solve::Structure structure;
  structure.add_variable(6, 3);
  structure.add_variable(1);
  structure.add_row(6, std::vector{0, 1});
  structure.add_row(1, std::vector{0, 1});
  const titop::solve::Plan plan = titop::solve::plan(structure);
  RowMatrix<double> residual = RowMatrix<double>::Zero(7, 2), magnitudes = residual;
  magnitudes.setConstant(4);
  CHECK(titop::solve::backward_error(plan, residual, magnitudes) == 0);
  const int six = plan.row_first[0], one = plan.row_first[1];
  residual(six + 1, 0) = -0x1p-40;
  magnitudes.block(six, 0, 3, 1) << 0x1p-40, 0x1p-40, 0x1p-20;  // a zero of a turned vector
  CHECK(titop::solve::backward_error(plan, residual, magnitudes) == 0x1p-20);
  residual(six + 4, 1) = 0x1p-12;
  CHECK(titop::solve::backward_error(plan, residual, magnitudes) == 0x1p-14);
  residual(one, 1) = 0x1p-100;  // small, and all that the row has
  magnitudes(one, 1) = 0x1p-99;
  CHECK(titop::solve::backward_error(plan, residual, magnitudes) == 0.5);
  residual(one, 1) = 1e-300;
  magnitudes(one, 1) = 1e-300;
  CHECK(titop::solve::backward_error(plan, residual, magnitudes) == 0x1p-14);
  residual(one, 1) = std::numeric_limits<double>::quiet_NaN();
  CHECK(std::isinf(titop::solve::backward_error(plan, residual, magnitudes)));
  // Seven scalars in each row.
  CHECK(titop::solve::backward_error_of_rounding(plan, 0x1p-52) == 8 * 15 * 0x1p-52);
}
