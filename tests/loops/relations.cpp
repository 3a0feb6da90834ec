#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <set>
#include <titop/compiler/loops/redundant.hpp>
#include <titop/compiler/loops/relations.hpp>
#include <titop/graph/linalg/eigen.hpp>
#include <titop/graph/linalg/index.hpp>

#include "support/rng.hpp"

/// Ranks and followers of relations that share columns, block by block, against singular values of
/// all of them at once.

using namespace titop::loops;
using Eigen::Index;
using Eigen::MatrixXd;
using titop_test::Rng;

namespace {

using titop::linalg::at;

Index width(const Relations& r) { return static_cast<Index>(r.role.size()); }

MatrixXd dense(const Relations& r, std::size_t blocks) {
  MatrixXd all(0, width(r));
  for (std::size_t b = 0; b < blocks; ++b) {
    const Index first = all.rows();
    all.conservativeResize(first + r.blocks[b].M.rows(), Eigen::NoChange);
    all.bottomRows(r.blocks[b].M.rows()).setZero();
    for (std::size_t k = 0; k < r.blocks[b].columns.size(); ++k)
      all.col(r.blocks[b].columns[k]).tail(r.blocks[b].M.rows()) =
          r.blocks[b].M.col(static_cast<Index>(k));
  }
  return all;
}

Index rank(const MatrixXd& m) {
  if (m.size() == 0) return 0;
  return (Eigen::JacobiSVD<MatrixXd>(m).singularValues().array() > 1e-9).count();
}

MatrixXd null_space(const MatrixXd& m) {
  const Eigen::JacobiSVD<MatrixXd, Eigen::FullPivHouseholderQRPreconditioner> svd(
      m, Eigen::ComputeFullV);
  return svd.matrixV().rightCols(m.cols() - (svd.singularValues().array() > 1e-9).count());
}

/// Loops side by side, as in a grid: each has columns of its own, and shares others with those on
/// either side. Some loops repeat combinations of others; some columns are unknowns; some loops
/// have a row with one entry, which sets its column to 0.
Relations loops(Rng& rng) {
  Relations r;
  const int count = 3 + rng.below(6), across = 1 + rng.below(3), size = 1 + rng.below(4);
  const int columns = count * across * 2;
  r.role.assign(at(columns), Relations::Role::coordinate);
  r.weight = Eigen::VectorXd::Ones(columns);
  const bool unknowns = rng.below(2) == 0;
  for (int c = 0; c < columns; ++c) {
    r.weight(c) = rng.below(3) == 0 ? 1e-2 : 1;
    if (unknowns && rng.below(5) == 0) r.role[at(c)] = Relations::Role::unknown, r.weight(c) = 0;
  }
  for (int b = 0; b < count; ++b) {
    std::set<int> own;
    for (int k = 0; k < 4 * across; ++k)
      own.insert((2 * across * b + k) % columns);  // the last meets the first: a ring
    if (rng.below(4) == 0) own.insert(rng.below(columns));
    RowBlock block{{own.begin(), own.end()}, {}};
    block.M.resize(size, static_cast<Index>(own.size()));
    for (Index i = 0; i < size; ++i)
      for (Index j = 0; j < block.M.cols(); ++j)
        block.M(i, j) = rng.below(3) == 0 ? 0 : rng.between(-1, 1);
    if (rng.below(4) == 0) {
      block.M.row(0).setZero();
      block.M(0, rng.below(static_cast<int>(block.M.cols()))) = 1;
    }
    if (b > 1 && rng.below(3) == 0) {  // one row is a combination of two others
      const auto &one = r.blocks[at(b - 1)], &two = r.blocks[at(rng.below(b - 1))];
      std::set<int> all(block.columns.begin(), block.columns.end());
      all.insert(one.columns.begin(), one.columns.end());
      all.insert(two.columns.begin(), two.columns.end());
      RowBlock wide{{all.begin(), all.end()}, {}};
      wide.M = MatrixXd::Zero(size, static_cast<Index>(all.size()));
      const auto add = [&](const RowBlock& from, Index row, Index to, double factor) {
        for (std::size_t k = 0; k < from.columns.size(); ++k)
          wide.M(to, std::lower_bound(wide.columns.begin(), wide.columns.end(), from.columns[k]) -
                         wide.columns.begin()) += factor * from.M(row, static_cast<Index>(k));
      };
      for (Index i = 1; i < size; ++i) add(block, i, i, 1);
      add(one, 0, 0, 0.7), add(two, size - 1, 0, -0.4);
      block = std::move(wide);
    }
    r.blocks.push_back(std::move(block));
    r.unit.push_back(std::vector<int>(at(size), b));
  }
  return r;
}

/// Loops one after the other, as in a truss: none has a column to itself, every fifth has one row
/// that is a combination of the two loops before it.
Relations strip(Rng& rng, int count) {
  Relations r;
  const int columns = 2 * count + 4;
  r.role.assign(at(columns), Relations::Role::coordinate);
  r.weight = Eigen::VectorXd::Ones(columns);
  for (int b = 0; b < count; ++b) {
    RowBlock block;
    for (int c = 2 * b; c < 2 * b + 6; ++c) block.columns.push_back(c);
    block.M.resize(2, 6);
    for (double& x : block.M.reshaped()) x = rng.between(-1, 1);
    if (b % 5 == 4) {
      const RowBlock &one = r.blocks[at(b - 1)], &two = r.blocks[at(b - 2)];
      block.columns.clear();
      for (int c = 2 * b - 4; c < 2 * b + 6; ++c) block.columns.push_back(c);
      MatrixXd M = MatrixXd::Zero(2, 10);
      M.bottomRightCorner(1, 6) = block.M.row(1);
      M.row(0).segment(2, 6) = 0.7 * one.M.row(0).tail(6);
      M.row(0).head(6) -= 0.4 * two.M.row(1).tail(6);
      block.M = M;
    }
    r.blocks.push_back(std::move(block));
    r.unit.push_back({b, b});
  }
  return r;
}

}  // namespace

TEST_CASE("scaled relations: the same whatever rows and columns are measured in, free columns 1") {
  for (std::uint64_t seed = 1; seed <= 100; ++seed) {
    CAPTURE(seed);
    Rng rng(seed);
    Relations r = loops(rng);
    for (std::size_t b = 0; b < r.blocks.size(); ++b)
      for (std::size_t i = 0; i < r.unit[b].size(); ++i)
        r.unit[b][i] = static_cast<int>(2 * b + i % 2);
    for (double& w : r.weight) w = rng.below(3) == 0 ? w : 0;
    Relations other = r;
    std::vector<double> of_unit(2 * r.blocks.size()), of_column(r.role.size());
    for (auto* list : {&of_unit, &of_column})
      for (double& x : *list) x = std::ldexp(1, rng.below(60) - 30);
    for (Index c = 0; c < width(r); ++c)
      if (r.weight(c) > 0) of_column[at(c)] = 1;  // energy defines these units
    for (std::size_t b = 0; b < r.blocks.size(); ++b)
      for (Index i = 0; i < r.blocks[b].M.rows(); ++i)
        for (Index j = 0; j < r.blocks[b].M.cols(); ++j)
          other.blocks[b].M(i, j) *=
              of_unit[at(r.unit[b][at(i)])] * of_column[at(r.blocks[b].columns[at(j)])];
    for (Index c = 0; c < width(r); ++c) other.weight(c) /= of_column[at(c)];
    scale(r), scale(other);
    const MatrixXd M = dense(r, r.blocks.size());
    CHECK((dense(other, r.blocks.size()) - M).norm() <= 1e-12 * M.norm());
    for (Index c = 0; c < width(r); ++c)
      if (r.weight(c) == 0 && M.col(c).norm() > 0) CHECK(std::abs(M.col(c).norm() - 1) <= 1e-12);
  }
}

TEST_CASE("scaled relations: stiffnesses have no influence") {
  for (std::uint64_t seed = 1; seed <= 50; ++seed) {
    CAPTURE(seed);
    Rng rng(seed);
    Relations r = loops(rng);
    Relations other = r;
    for (double& w : other.weight) w *= std::ldexp(1, rng.below(200) - 100);
    scale(r), scale(other);
    CHECK(dense(other, r.blocks.size()) == dense(r, r.blocks.size()));
  }
}

TEST_CASE(
    "scaled relations are equilibrated, and a tiny lever, to its last digit, leaves it there") {
  const int hinges = 7, tiny = 2;  // one of these at the closing point itself
  std::vector<double> lengths;
  for (const double lever : {0.0, 1e-15, 1e-12, 1e-9, 1e-6}) {
    CAPTURE(lever);
    Rng rng(3);
    Relations r{.role = std::vector(at(hinges), Relations::Role::coordinate),
                .weight = Eigen::VectorXd::Zero(hinges)};
    RowBlock block{{0, 1, 2, 3, 4, 5, 6}, MatrixXd(6, hinges)};
    for (Index j = 0; j < hinges; ++j) {
      const MatrixXd cross = rng.matrix(3, 1), axis = rng.matrix(3, 1);
      block.M.col(j) << cross * (j == 0 ? 0 : j < tiny ? lever : 1), axis;
    }
    r.blocks.push_back(block);
    r.unit.push_back({0, 0, 0, 1, 1, 1});
    const ScaleFactors f = scale(r);
    const MatrixXd& M = r.blocks[0].M;
    // Half of every column with a lever for the translations; 2 % per factor.
    const double translations = (hinges - tiny) / 2.0, rotations = hinges - translations;
    CHECK(std::abs(M.topRows(3).squaredNorm() / translations - 1) <= 0.05);
    CHECK(std::abs(M.bottomRows(3).squaredNorm() / rotations - 1) <= 0.05);
    lengths.push_back(f.row[0](3) / f.row[0](0));
    CHECK(std::abs(lengths.back() / lengths.front() - 1) <= 1e-6);
  }
}

TEST_CASE("the number of dependent coordinates follows from geometry, their choice from softness") {
  for (std::uint64_t seed = 1; seed <= 100; ++seed)
    for (const double near : {0.0, 1e-14, 1e-7, 1e-6, 1.0}) {
      CAPTURE(seed);
      CAPTURE(near);
      Rng rng(seed);
      const Index rows = 2 + rng.below(3), columns = rows + 4;
      MatrixXd M = rng.matrix(rows, columns), of_others = rng.matrix(1, rows - 1);
      for (auto* m : {&M, &of_others})
        for (double& x : m->reshaped()) x += std::copysign(0.5, x);
      // The last row is a combination of the others, plus `near` times its own.
      if (near < 1) M.bottomRows(1) = of_others * M.topRows(rows - 1) + near * M.bottomRows(1);
      Relations r{.role = std::vector(at(columns), Relations::Role::coordinate),
                  .weight = Eigen::VectorXd(columns)};
      RowBlock block{{}, M};
      for (Index c = 0; c < columns; ++c) {
        block.columns.push_back(static_cast<int>(c));
        r.weight(c) = std::ldexp(1, rng.below(80) - 40);
      }
      r.blocks.push_back(block);
      r.unit.push_back({});
      for (Index i = 0; i < rows; ++i) r.unit.back().push_back(static_cast<int>(i));
      const Independent found = independent(r);
      const Index rank = near < 1e-9 ? rows - 1 : rows;
      CHECK(static_cast<Index>(found.follow.size()) == rank);
      CHECK(found.doubtful() == (near == 1e-7 || near == 1e-6));
      // In units of energy a dependent coordinate is no larger than those that it depends on,
      // except for pivots that differ by less than a thousandth.
      for (const auto& f : found.follow)
        for (const auto& [c, factor] : f.of)
          CHECK(std::abs(factor) * r.weight(c) <= 1e4 * r.weight(f.dependent));
    }
}

TEST_CASE("redundant directions and fixed columns: as by singular values of all relations") {
  int repeated = 0, held = 0;
  for (std::uint64_t seed = 1; seed <= 400; ++seed) {
    CAPTURE(seed);
    Rng rng(seed);
    Relations r = loops(rng);
    scale(r);
    const Redundancy found = redundancy(r);
    REQUIRE(found.blocks.size() == r.blocks.size());
    Index before = 0;
    for (std::size_t b = 0; b < r.blocks.size(); ++b) {
      const MatrixXd& directions = found.blocks[b].directions;
      const Index rows = r.blocks[b].M.rows(), now = rank(dense(r, b + 1));
      CHECK(directions.rows() == rows - (now - before));
      before = now;
      CHECK((directions * directions.transpose() -
             MatrixXd::Identity(directions.rows(), directions.rows()))
                .norm() <= 1e-12);
      // They follow from the blocks before: they are 0 if these are 0.
      const MatrixXd N =
          b == 0 ? MatrixXd(MatrixXd::Identity(width(r), width(r))) : null_space(dense(r, b));
      const MatrixXd all = dense(r, b + 1);
      CHECK((directions * all.bottomRows(rows) * N).norm() <= 1e-9);
      repeated += static_cast<int>(directions.rows());
    }
    const MatrixXd N = null_space(dense(r, r.blocks.size()));
    std::set<int> still;
    for (Index c = 0; c < width(r); ++c)
      if (N.row(c).norm() <= 1e-11) still.insert(static_cast<int>(c));
    CHECK(std::set<int>(found.held.begin(), found.held.end()) == still);
    held += static_cast<int>(still.size());
  }
  CHECK(repeated >= 100);
  CHECK(held >= 100);
}

TEST_CASE("followers: as many as the rank, and right in every remaining motion") {
  int of_others = 0;
  for (std::uint64_t seed = 1; seed <= 400; ++seed) {
    CAPTURE(seed);
    Rng rng(seed);
    Relations r = loops(rng);
    if (seed % 2 == 0)  // stiff next to soft
      for (double& w : r.weight) w *= std::ldexp(1, rng.below(80) - 40);
    const Independent found = independent(r);
    const MatrixXd R = dense(r, r.blocks.size()), N = null_space(R);
    std::vector<Index> unknowns;
    for (Index c = 0; c < width(r); ++c)
      if (r.role[at(c)] == Relations::Role::unknown) unknowns.push_back(c);
    const Index rows = rank(R) - rank(R(Eigen::all, unknowns));
    CHECK(static_cast<Index>(found.follow.size()) == rows);
    std::set<int> known;
    std::set<int> followers;
    for (const auto& f : found.follow) followers.insert(f.dependent);
    CHECK(followers.size() == found.follow.size());
    for (const auto& f : found.follow) {
      CHECK(r.role[at(f.dependent)] != Relations::Role::unknown);
      Eigen::RowVectorXd off = N.row(f.dependent);
      double size = 1;
      for (const auto& [c, factor] : f.of) {
        CHECK(r.role[at(c)] != Relations::Role::unknown);
        CHECK((!followers.contains(c) || known.contains(c)));  // in turn
        of_others += known.contains(c);
        off -= factor * N.row(c);
        size = std::max(size, std::abs(factor));
      }
      CHECK(off.norm() <= 1e-10 * size);
      known.insert(f.dependent);
    }
  }
  CHECK(of_others >= 100);
}

TEST_CASE("redundant directions along a truss: the same, and no more columns open at once") {
  for (std::uint64_t seed = 1; seed <= 5; ++seed) {
    CAPTURE(seed);
    for (const int count : {30, 600}) {
      Rng rng(seed);
      Relations r = strip(rng, count);
      scale(r);
      const Redundancy found = redundancy(r);
      CHECK(found.widest <= 20);
      Index repeated = 0;
      for (int b = 0; b < count; ++b) {
        const Redundant& block = found.blocks[at(b)];
        CHECK(!block.doubtful());
        CHECK(block.directions.rows() == (b % 5 == 4 ? 1 : 0));
        repeated += block.directions.rows();
      }
      if (count == 30) CHECK(rank(dense(r, r.blocks.size())) == 2 * count - repeated);
    }
  }
}
