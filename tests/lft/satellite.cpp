#include <doctest/doctest.h>
#include <fmt/format.h>

#include <titop/graph/linalg/eigen.hpp>

#include "lft/n17.hpp"
#include "support/rng.hpp"

/// Occurrences of the satellite's parameters as exact integers, and closing against update.

using namespace lft_test;

namespace {

struct Counts {
  int states;
  std::vector<int> sizes;
};

void check_counts(const Satellite& s, const Counts& built, const Counts& small) {
  const System system = compile(s.diagram());
  CHECK(system.order() == built.states);
  const Lft f = lft(system, ranges(s));
  INFO(to_string(f), " margin ", f.rank_margin().kept, " ", f.rank_margin().dropped);
  CHECK(f.m().order() == small.states);
  CHECK(f.states_at_least() == small.states);
  CHECK(f.not_decided() == "");
  for (std::size_t i = 0; i < 4; ++i) {
    CAPTURE(f.deltas()[i].parameter);
    CHECK(f.deltas()[i].built == built.sizes[i]);
    CHECK(f.deltas()[i].size == small.sizes[i]);
    CHECK(f.deltas()[i].at_least == small.sizes[i]);
  }
}

}  // namespace

TEST_CASE("occurrences of the satellite are least, and equal to those of the table") {
  const Counts built{12, {3, 16, 4, 2}};
  check_counts({}, built, built);
  check_counts({.axes = {3, 4, 5}}, built, built);
  check_counts({.axes = {3}}, built, {6, {2, 8, 2, 1}});
  check_counts({.axes = {4}}, built, {6, {2, 8, 2, 1}});
  check_counts({.axes = {5}}, built, {6, {1, 8, 2, 1}});
}

TEST_CASE("of a symmetric satellite modes that an axis does not move are left out") {
  const Counts built{12, {3, 16, 4, 2}};
  check_counts({.axes = {3, 4, 5}, .symmetric = true}, built, {10, {2, 16, 4, 2}});
  check_counts({.axes = {3}, .symmetric = true}, built, {4, {1, 8, 2, 1}});
  check_counts({.axes = {4}, .symmetric = true}, built, {2, {0, 0, 0, 0}});
}

TEST_CASE("closing the parameters equals compiling anew") {
  for (const bool rates : {false, true}) {
    const Satellite s{.rates = rates};
    const System system = compile(s.diagram());
    const Lft f = lft(system, ranges(s));
    INFO(to_string(f), " margin ", f.rank_margin().kept, " ", f.rank_margin().dropped);
    titop_test::Rng rng(3);
    double worst = 0;
    for (int i = 0; i < (rates ? 50 : 200); ++i) {
      ParameterList values;
      for (const Delta& d : f.deltas())
        values.emplace_back(d.parameter, d.map.value(rng.between(-0.999, 0.999)));
      const StateSpace at = f.at(values);
      const System other = system.update(values);
      const std::complex<double> z =
          i % 2 ? std::complex<double>(0.1, 1.3) : std::complex<double>(0.5, 6.0);
      const Eigen::MatrixXcd G = other.transfer(z, Precision::digits50);
      worst = std::max(worst, (at.transfer(z) - G).norm() / G.norm());
    }
    CHECK(worst <= 1e-12);
  }
}

TEST_CASE("names, order and units do not change the counts") {
  const Satellite renamed{.names = {"zz", "y", "x", "a"}, .prefix = "q"}, tonnes{.unit = 1000};
  check_counts(renamed, {12, {3, 16, 4, 2}}, {12, {3, 16, 4, 2}});
  check_counts(tonnes, {12, {3, 16, 4, 2}}, {12, {3, 16, 4, 2}});
  const Satellite roll{.axes = {3}, .unit = 1e-3};
  check_counts(roll, {12, {3, 16, 4, 2}}, {6, {2, 8, 2, 1}});
  ParameterRanges other = ranges(roll);
  std::swap(other[0], other[3]), std::swap(other[1], other[2]);
  const Lft f = lft(compile(roll.diagram()), other);
  CHECK(f.deltas()[0].parameter == "x");
  for (const auto& [i, size] : {std::pair(0u, 1), {1u, 2}, {2u, 8}, {3u, 2}})
    CHECK(f.deltas()[i].size == size);
}

namespace {

/// Closes w = diag(deltas) z without the pair `without`, by an inverse written out here.
Eigen::MatrixXcd closed_by_hand(const Lft& f, const std::vector<double>& deltas, int without,
                                std::complex<double> s) {
  const StateSpace& m = f.m();
  const Eigen::MatrixXcd M = m.transfer(s);
  const int r = f.occurrences();
  Eigen::VectorXd d = Eigen::VectorXd::Zero(r);
  for (std::size_t i = 0; i < deltas.size(); ++i)
    d.segment(f.deltas()[i].first, f.deltas()[i].size).setConstant(deltas[i]);
  if (without >= 0) d(without) = 0;
  const Eigen::MatrixXcd E =
      Eigen::MatrixXcd::Identity(r, r) - M.topLeftCorner(r, r) * d.asDiagonal();
  const Eigen::Index nu = M.cols() - r, ny = M.rows() - r;
  const Eigen::MatrixXcd z = E.fullPivLu().solve(M.topRightCorner(r, nu));
  return M.bottomRightCorner(ny, nu) + M.bottomLeftCorner(ny, r) * (d.asDiagonal() * z);
}

}  // namespace

TEST_CASE("no occurrence can be left out") {
  const Satellite s;
  const System system = compile(s.diagram());
  const Lft f = lft(system, ranges(s));
  const std::vector<double> deltas = {0.7, -0.4, 0.8, -0.6};
  ParameterList values;
  for (std::size_t i = 0; i < 4; ++i)
    values.emplace_back(f.deltas()[i].parameter, f.deltas()[i].map.value(deltas[i]));
  const std::complex<double> at{0.05, 1.4};
  const Eigen::MatrixXcd G = system.update(values).transfer(at);
  CHECK((closed_by_hand(f, deltas, -1, at) - G).norm() <= 1e-12 * G.norm());
  for (int k = 0; k < f.occurrences(); ++k) {
    CAPTURE(k);
    CHECK((closed_by_hand(f, deltas, k, at) - G).norm() >= 1e-6 * G.norm());
  }
}
