#include "support/lossy_row.hpp"

#include <fmt/format.h>

#include <boost/multiprecision/cpp_complex.hpp>
#include <vector>

using namespace titop;

namespace titop_test {
namespace {

using Big = boost::multiprecision::cpp_complex_50;
using Double = std::complex<double>;

Big big(Double z) { return {z.real(), z.imag()}; }
double size(const Big& z) { return static_cast<double>(abs(z)); }

constexpr double kMass = 1, kStiffness = 10, kBaseMass = 2;

/// An output, and the largest term that it is the sum of.
struct Exact {
  Big value;
  double term;
};
struct Answer {
  Exact tip, base;
};

/// Z: force over displacement of all up to a mass, which the next spring adds to.
Answer exact(const LossyRow& row, Double at) {
  const Big s = big(at), inertia = Big(kMass) * s * s, base = Big(kBaseMass) * s * s,
            k = Big(kStiffness) + Big(row.damping) * s;
  // Displacement of the mass (or base) before each mass over its own.
  std::vector<Big> ratio{row.base == LossyRow::Base::held ? Big(0) : Big(k / (base + k))};
  Big spring = k * (Big(1) - ratio[0]), Z = inertia + spring;
  for (int i = 1; i < row.n; ++i) {
    ratio.push_back(k / (Z + k));
    spring = k * (Big(1) - ratio.back());
    Z = inertia + spring;
  }
  const double term = size(inertia) + size(spring);
  const bool forced = row.tip == LossyRow::Tip::force;
  const Big x = forced ? Big(Big(1) / Z) : Big(Big(1) / (s * s));
  Big first = x;
  for (std::size_t i = ratio.size(); i-- > 1;) first *= ratio[i];
  const Exact tip =
      forced ? Exact{Big(s * s * x), size(s * s * x)} : Exact{Big(Z * x), term * size(x)};
  const Big end = row.base == LossyRow::Base::held ? Big(k * first) : Big(s * s * ratio[0] * first);
  return {tip, {end, size(end)}};
}

bool right(Double found, const Exact& exact) {
  const double off = size(big(found) - exact.value);
  return off <= 1e-8 * size(exact.value) || off <= 1e-12 * exact.term ||
         (size(exact.value) < 1e-290 && std::abs(found) < 1e-289);
}

}  // namespace

Diagram LossyRow::diagram() const { return diagram(""); }

Diagram LossyRow::diagram(const std::string& damping_name) const {
  Diagram d{"row"};
  auto u = d.input("u");
  const Value c = damping_name.empty() ? Value(damping) : Value(d.param(damping_name, damping));
  auto z = d.add("z000", SpringMass{.mass = kMass,
                                    .stiffness = kStiffness,
                                    .damping = c,
                                    .parent_mass = base == Base::free ? kBaseMass : 0});
  if (base == Base::held)
    z.parent.accel = 0, d.output("base") = z.parent.reaction;
  else
    z.parent.force = 0, d.output("base") = z.parent.accel;
  for (int i = 1; i < n; ++i) {
    auto next = d.add(fmt::format("z{:03}", i),
                      SpringMass{.mass = kMass, .stiffness = kStiffness, .damping = c});
    mount(next, z.child);
    z = next;
  }
  if (tip == Tip::force)
    z.child.force = u, d.output("tip") = z.child.accel;
  else
    z.child.accel = u, d.output("tip") = z.child.force;
  return d;
}

std::array<LossyRow, 4> lossy_rows(int n, double damping) {
  using enum LossyRow::Base;
  return {{{n, damping, held, LossyRow::Tip::force},
           {n, damping, held, LossyRow::Tip::motion},
           {n, damping, free, LossyRow::Tip::force},
           {n, damping, free, LossyRow::Tip::motion}}};
}

void LossyRowCount::ask(const System& system, const LossyRow& row, Double s, Precision precision) {
  ++tried;
  try {
    const Eigen::MatrixXcd G = system.transfer(s, precision);
    --tried;
    judge(G, row, s);
  } catch (const Error& error) {
    if (!error.has(Code::singular)) throw;
    ++refused;
  }
}

void LossyRowCount::judge(const Eigen::MatrixXcd& found, const LossyRow& row, Double s) {
  ++tried;
  const Answer answer = exact(row, s);
  wrong += !right(found(0, 0), answer.base) || !right(found(1, 0), answer.tip);
}

}  // namespace titop_test
