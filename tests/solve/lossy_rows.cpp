#include <doctest/doctest.h>
#include <fmt/format.h>

#include <boost/multiprecision/cpp_complex.hpp>
#include <complex>
#include <limits>
#include <titop/compiler/solve/backward_error.hpp>
#include <titop/titop.hpp>
#include <vector>

/// Rows of equal masses in which waves decay: the effect of elimination on one front is harmless,
/// its product along the row is not. Against the recursion of the row's own dynamic stiffness in 50
/// digits, without a line of the library.

using namespace titop;

namespace {

using Big = boost::multiprecision::cpp_complex_50;
using Double = std::complex<double>;

Big big(Double z) { return {z.real(), z.imag()}; }
double size(const Big& z) { return static_cast<double>(abs(z)); }

enum class Base { held, free };
enum class Tip { force, motion };

struct Chain {
  int n;
  double damping;
  Base base;
  Tip tip;
};

constexpr double kMass = 1, kStiffness = 10, kBaseMass = 2;

/// Inputs: the force on the tip, or its acceleration. Outputs: the other one of the two, and the
/// force on the wall, or the acceleration of the free base.
System compiled(const Chain& row) {
  Diagram d{"row"};
  auto u = d.input("u");
  auto z = d.add("z000", SpringMass{.mass = kMass,
                                    .stiffness = kStiffness,
                                    .damping = row.damping,
                                    .parent_mass = row.base == Base::free ? kBaseMass : 0});
  if (row.base == Base::held)
    z.parent.accel = 0, d.output("base") = z.parent.reaction;
  else
    z.parent.force = 0, d.output("base") = z.parent.accel;
  for (int i = 1; i < row.n; ++i) {
    auto next = d.add(fmt::format("z{:03}", i),
                      SpringMass{.mass = kMass, .stiffness = kStiffness, .damping = row.damping});
    mount(next, z.child);
    z = next;
  }
  if (row.tip == Tip::force)
    z.child.force = u, d.output("tip") = z.child.accel;
  else
    z.child.accel = u, d.output("tip") = z.child.force;
  return compile(d);
}

/// An output, and the largest term that it is the sum of.
struct Exact {
  Big value;
  double term;
};
struct Answer {
  Exact tip, base;
};

/// Z: force over displacement of all up to a mass, which the next spring adds to.
Answer exact(const Chain& row, Double at) {
  const Big s = big(at), inertia = Big(kMass) * s * s, base = Big(kBaseMass) * s * s,
            k = Big(kStiffness) + Big(row.damping) * s;
  Big below, Z = inertia;  // displacement of the mass before over that of the present one
  std::vector<Big> ratio;
  double term = 0;
  for (int i = 0; i < row.n; ++i) {
    below = i > 0 ? Big(k / (Z + k)) : row.base == Base::held ? Big(0) : Big(k / (base + k));
    ratio.push_back(below);
    const Big spring = k * (Big(1) - below);
    term = size(inertia) + size(spring);
    Z = inertia + spring;
  }
  const Big x = row.tip == Tip::force ? Big(Big(1) / Z) : Big(Big(1) / (s * s));
  Big first = x;
  for (std::size_t i = ratio.size(); i-- > 1;) first *= ratio[i];
  const Exact tip = row.tip == Tip::force ? Exact{Big(s * s * x), size(s * s * x)}
                                          : Exact{Big(Z * x), term * size(x)};
  const Big end = row.base == Base::held ? Big(k * first) : Big(s * s * ratio[0] * first);
  return {tip, {end, size(end)}};
}

/// To 1e-8 of itself, or to 1e-12 of its largest term; below 1e-290 nothing has all its digits.
bool right(Double found, const Exact& exact) {
  const double off = size(big(found) - exact.value);
  return off <= 1e-8 * size(exact.value) || off <= 1e-12 * exact.term ||
         (size(exact.value) < 1e-290 && std::abs(found) < 1e-289);
}

struct Count {
  int tried = 0, wrong = 0, refused = 0;

  void ask(const System& system, const Chain& row, Double s, Precision precision) {
    ++tried;
    try {
      const Eigen::MatrixXcd G = system.transfer(s, precision);
      const Answer answer = exact(row, s);
      wrong += !right(G(0, 0), answer.base) || !right(G(1, 0), answer.tip);
    } catch (const Error& error) {
      CHECK(error.has(Code::singular));
      ++refused;
    }
  }
};

}  // namespace

TEST_CASE("lossy rows: the transfer of every length, damping and causality is right") {
  Count count;
  for (const int n : {10, 30, 100, 300})
    for (const double damping : {0.0, 0.1, 20.0, 1e3})
      for (const auto& [base, tip] : {std::pair(Base::held, Tip::force),
                                      {Base::held, Tip::motion},
                                      {Base::free, Tip::force},
                                      {Base::free, Tip::motion}}) {
        const Chain row{n, damping, base, tip};
        const System system = compiled(row);
        for (const double re : {0.0, 2.19, 20.0})
          for (const double im : {0.031, 2.23, 8.0, 15.93})
            count.ask(system, row, {re, im}, Precision::as_needed);
      }
  MESSAGE(count.tried, " tried, ", count.wrong, " wrong, ", count.refused, " refused");
  CHECK(count.wrong == 0);
  CHECK(count.refused == 0);
}

TEST_CASE("lossy rows: of two thousand masses") {
  Count count;
  const Chain row{2000, 20, Base::held, Tip::force};
  const System system = compiled(row);
  for (const Double s : {Double(0, 15.93), Double(0, 8), Double(2.19, 2.23), Double(0, 0.1)})
    count.ask(system, row, s, Precision::as_needed);
  CHECK(count.wrong == 0);
  CHECK(count.refused == 0);
}

TEST_CASE("lossy rows: every precision is right or says that it is not") {
  Count count;
  const Chain row{150, 20, Base::held, Tip::force};
  const System system = compiled(row);
  for (const Precision precision :
       {Precision::standard, Precision::refined, Precision::twofold, Precision::digits50})
    for (const Double s : {Double(0, 15.93), Double(0, 8), Double(2.19, 2.23)})
      count.ask(system, row, s, precision);
  CHECK(count.wrong == 0);
  CHECK(count.refused == 0);
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
