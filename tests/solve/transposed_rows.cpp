#include <doctest/doctest.h>

#include <boost/multiprecision/cpp_bin_float.hpp>
#include <titop/compiler/system/compile_graph.hpp>
#include <titop/compiler/system/system_data.hpp>
#include <titop/compiler/system/transfer_part.hpp>
#include <titop/graph/declared.hpp>
#include <titop/titop.hpp>

#include "generate/diagrams/random_diagram.hpp"
#include "lft/n17.hpp"
#include "support/lossy_row.hpp"
#include "support/transfer_error.hpp"

/// Rows of transfers, by solves with the transposed factors, against columns in other precisions.

using namespace titop;
using Eigen::Index;
using Eigen::MatrixXcd;

namespace {

std::vector<int> all_of(const auto& ports) { return detail::as_declared(ports); }

std::vector<Index> sizes_of(const auto& ports) {
  std::vector<Index> result;
  for (const int i : all_of(ports)) result.push_back(ports[static_cast<std::size_t>(i)].size);
  return result;
}

detail::TransferPart rows_of(const detail::SystemData& data, std::complex<double> s,
                             Precision precision = Precision::as_needed) {
  return detail::transfer_part(data, s, {{}, all_of(data.graph().outputs)}, precision);
}

}  // namespace

TEST_CASE("rows of the transfers of random scenes are those of their columns in 50 digits") {
  int compared = 0;
  for (std::uint64_t seed = 1; seed <= 40; ++seed) {
    const Diagram d =
        titop::generate::random_diagram(titop::generate::random_options(seed)).build();
    const auto data = detail::compile_graph(d.graph(), {});
    const Graph& g = data->graph();
    if (g.outputs.empty() || g.inputs.empty()) continue;
    CAPTURE(seed);
    const std::complex<double> s{0.4, 2.1};
    const MatrixXcd exact = System(data).transfer(s, Precision::digits50);
    for (const Precision p : {Precision::as_needed, Precision::twofold, Precision::digits50}) {
      const MatrixXcd rows = rows_of(*data, s, p).rows;
      REQUIRE(rows.rows() == exact.rows());
      REQUIRE(rows.cols() == exact.cols());
      CHECK(titop_test::transfer_error<MatrixXcd>({rows}, {exact}, sizes_of(g.outputs),
                                                  sizes_of(g.inputs)) <= 1e-12);
      ++compared;
    }
  }
  CHECK(compared >= 90);
}

TEST_CASE("single rows and columns: of these ports, in this order") {
  const lft_test::Satellite s{.rates = true};
  const auto data = detail::compile_graph(s.diagram().graph(), {});
  const auto outputs = all_of(data->graph().outputs), inputs = all_of(data->graph().inputs);
  REQUIRE(outputs.size() == 3);  // y, rate, position
  const std::complex<double> at{0.1, 1.3};
  const MatrixXcd all = System(data).transfer(at);
  const auto part = detail::transfer_part(*data, at, {inputs, {outputs[2], outputs[0]}});
  REQUIRE(part.rows.rows() == 12);
  const auto error = [](const MatrixXcd& a, const MatrixXcd& b) {
    return (a - b).norm() / b.norm();
  };
  CHECK(error(part.rows.topRows(6), all.bottomRows(6)) <= 1e-12);
  CHECK(error(part.rows.bottomRows(6), all.topRows(6)) <= 1e-12);
  CHECK(error(part.columns, all) <= 1e-14);
  CHECK(part.cost.factorisations == 1);
  CHECK(part.cost.columns >= 3 * 6);  // once, and once more with an estimate of rounding
  CHECK(part.cost.rows == 2 * part.cost.columns);
}

TEST_CASE("a reciprocal scene: a transposed solve is the solve with its ports swapped") {
  // Forces at the hub and at a tip, accelerations there: the transfer is symmetric [Maxwell,
  // Betti].
  Diagram d{"reciprocal"};
  Eigen::MatrixXd L(2, 6);
  L << 0.2, 1, 0.3, -0.1, 0.2, 0.9, 0.5, 0.1, 0.2, 0.4, 0, 0.3;
  ModalData boom;
  boom.omega = Eigen::Vector2d(2, 5);
  boom.xi = Eigen::Vector2d(0.01, 0.02);
  boom.L_P = L;
  boom.D_P = rigid_mass(6, 4 * Matrix3d::Identity(), Vector3d(-0.5, 0, 0));
  boom.children = {{"C", {1, 0.2, 0}, Eigen::MatrixXd(0.3 * L.transpose())}};
  auto hub = d.add("hub", RigidBody{.mass = 9,
                                    .inertia = 5 * Matrix3d::Identity(),
                                    .children = {{"C", {0.7, 0.4, -0.3}}}});
  auto arm = d.add("arm", FlexibleBody{boom});
  mount(arm, hub.child("C"), Rotation::about({0, 0, 1}, 0.5));
  hub.parent.force = -d.input("U", 6);
  arm.child.force += d.input("V", 6);
  d.output("y", 6) = hub.parent.accel;
  d.output("z", 6) = arm.child.accel;
  const auto data = detail::compile_graph(d.graph(), {});
  const auto outputs = all_of(data->graph().outputs), inputs = all_of(data->graph().inputs);
  for (const double omega : {0.3, 2.4, 40.0})
    for (const std::size_t port : {0u, 1u}) {
      const std::complex<double> s{0.02, omega};
      const MatrixXcd row = detail::transfer_part(*data, s, {{}, {outputs[port]}}).rows,
                      column = detail::transfer_part(*data, s, {{inputs[port]}, {}}).columns;
      CHECK((row - column.transpose()).norm() <= 1e-12 * column.norm());
    }
}

TEST_CASE("rows of lossy chains are right or refused") {
  for (const titop_test::LossyRow& row : titop_test::lossy_rows(300, 20)) {
    const auto data = detail::compile_graph(row.diagram().graph(), {});
    const Graph& g = data->graph();
    for (const std::complex<double> s : {std::complex<double>(0, 15.93), {0, 8}, {2.19, 2.23}}) {
      const MatrixXcd exact = System(data).transfer(s, Precision::digits50);
      const detail::TransferPart part = rows_of(*data, s);
      CHECK(titop_test::transfer_error<MatrixXcd>({part.rows}, {exact}, sizes_of(g.outputs),
                                                  sizes_of(g.inputs)) <= 1e-12);
      try {
        const MatrixXcd refined = rows_of(*data, s, Precision::refined).rows;
        CHECK(titop_test::transfer_error<MatrixXcd>({refined}, {exact}, sizes_of(g.outputs),
                                                    sizes_of(g.inputs)) <= 1e-12);
      } catch (const Error& error) {
        CHECK(error.has(Code::singular));
      }
    }
  }
}

TEST_CASE("where double has too few digits, rows are computed in finer arithmetic") {
  // A loop of gain k l = 1 - 2^-40 or so: double keeps four digits of 1 - k l.
  const double k = 1 + 0x1p-20, l = (1 - 0x1p-20) / 3;
  Diagram d{"near"};
  auto u = d.input("u");
  auto K = d.add("K", Lti{.D = Eigen::MatrixXd::Constant(1, 1, k)});
  auto L = d.add("L", Lti{.D = Eigen::MatrixXd::Constant(1, 1, l)});
  K.in = 3.0 * L.out + u;
  L.in = K.out;
  d.output("y") = K.out;
  const auto part = rows_of(*detail::compile_graph(d.graph(), {}), {0, 1});
  using Real = boost::multiprecision::cpp_bin_float_50;
  const double exact = static_cast<double>(Real(k) / (1 - 3 * Real(k) * Real(l)));
  CHECK(std::abs(part.rows(0, 0) - exact) <= 1e-12 * std::abs(exact));
  CHECK(part.cost.rows > 3);  // those of double alone
}
