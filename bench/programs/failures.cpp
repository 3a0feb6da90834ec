#include <fmt/format.h>

#include <boost/multiprecision/cpp_bin_float.hpp>
#include <boost/multiprecision/cpp_complex.hpp>
#include <cmath>
#include <cstdio>
#include <functional>
#include <optional>
#include <string_view>

#include "methods/dense_lu.hpp"
#include "methods/oracle.hpp"
#include "methods/sparse_lu.hpp"
#include "support/agreement.hpp"
#include "support/cases.hpp"

/// Every method until it breaks: the error of the transfer against 150 digits while one quantity of
/// a scene goes to an extreme. What the library says of itself stands beside its error: "warned"
/// where the log warns, the error's code where it refuses.
namespace titop_bench {
namespace {

using Eigen::MatrixXcd;
using titop::Diagram;
using titop::Precision;
using titop::SpringMass;
using titop::StateSpace;
using titop::System;
using Complex = std::complex<double>;
using Digits = boost::multiprecision::cpp_bin_float<150>;
using Number = boost::multiprecision::number<boost::multiprecision::complex_adaptor<Digits>>;

MatrixXcd one_by_one(const Number& x) {
  return MatrixXcd::Constant(1, 1, {static_cast<double>(x.real()), static_cast<double>(x.imag())});
}

/// One point of a sweep: a scene, where it is looked at, and what is right there.
struct Point {
  double value = 0;
  Diagram diagram;
  std::vector<Complex> s;
  std::vector<MatrixXcd> exact = {};  ///< none: by the general oracle
  /// A method of the past that suits this scene alone.
  std::optional<std::vector<MatrixXcd>> chain_matrices = {};
};

struct Sweep {
  const char* name;
  std::vector<double> values;
  std::function<Point(double)> at;
  int dense_up_to = 400;  ///< states
};

// --- methods ------------------------------------------------------------------------------------

void row(const Sweep& sweep, double value, const char* method, double error, const char* mark) {
  fmt::print("{},{:.3g},{},{:.3g},{}\n", sweep.name, value, method,
             std::isfinite(error) ? std::min(error, 1e3) : 1e3, mark);
}

template <class Transfer>
double error_of(const Point& p, Transfer transfer) {
  std::vector<MatrixXcd> found;
  for (const Complex s : p.s) found.push_back(transfer(s));
  for (const MatrixXcd& m : found)
    if (!m.allFinite()) return HUGE_VAL;
  return difference(found, p.exact);
}

/// A method that throws has no digits left; what it says is its mark.
template <class Transfer>
void compare(const Sweep& sweep, const Point& p, const char* method, Transfer transfer,
             const char* mark = "") {
  try {
    row(sweep, p.value, method, error_of(p, transfer), mark);
  } catch (const titop::Error& error) {
    row(sweep, p.value, method, 1, std::string(to_string(error.mistakes().front().code)).c_str());
  } catch (const std::exception&) {
    row(sweep, p.value, method, 1, "");
  }
}

bool warns(const System& system) {
  for (const titop::Note& note : system.notes())
    if (note.kind == titop::Note::Kind::warning) return true;
  return false;
}

void others(const Sweep& sweep, const Point& p, const System& system) {
  const Network network = network_of(system);
  SparsePencil pencil(network);
  compare(sweep, p, "sparse LU at s", [&](Complex s) { return pencil.transfer(s); });
  if (p.chain_matrices) {
    std::size_t i = 0;
    compare(sweep, p, "chain matrices", [&](Complex) { return (*p.chain_matrices)[i++]; });
  }
  if (system.order() > sweep.dense_up_to || system.order() == 0) return;
  StateSpace by_lu;
  compare(sweep, p, "dense LU", [&](Complex s) {
    if (by_lu.A.size() == 0) dense_lu(network, by_lu);
    return by_lu.transfer(s);
  });
}

void library(const Sweep& sweep, const Point& p, const System& system) {
  const char* mark = warns(system) ? "warned" : "";
  compare(
      sweep, p, "titop factors", [&](Complex s) { return system.transfer(s, Precision::standard); },
      mark);
  compare(
      sweep, p, "titop as needed", [&](Complex s) { return system.transfer(s); }, mark);
  if (system.order() > sweep.dense_up_to || system.order() == 0) return;
  system.state_space();  // its warnings are in the log now
  compare(
      sweep, p, "titop dense A", [&](Complex s) { return system.state_space().transfer(s); },
      warns(system) ? "warned" : "");
}

void run(const Sweep& sweep, bool quick) {
  for (std::size_t i = 0; i < sweep.values.size(); i += quick ? 4 : 1) {
    Point p = sweep.at(sweep.values[i]);
    try {
      const System system = compile(p.diagram, {.minimize_up_to = 0});
      if (p.exact.empty())
        for (const Complex s : p.s) p.exact.push_back(oracle_transfer(system, s));
      library(sweep, p, system);
      others(sweep, p, system);
    } catch (const titop::Error& error) {
      row(sweep, p.value, "titop factors", 1,
          std::string(to_string(error.mistakes().front().code)).c_str());
    }
    std::fflush(stdout);
  }
}

// --- scenes -------------------------------------------------------------------------------------

std::vector<double> powers(double from, double to, double factor) {
  std::vector<double> list;
  for (double x = from; factor > 1 ? x <= to * 1.0001 : x >= to * 0.9999; x *= factor)
    list.push_back(x);
  return list;
}

struct Chain {
  std::vector<double> m, k;
  double c = 0;
};

Diagram diagram_of(const Chain& chain) {
  Diagram d{"chain"};
  auto u = d.input("u");
  std::vector<SpringMass::Handle> z;
  for (std::size_t i = 0; i < chain.m.size(); ++i) {
    z.push_back(d.add(fmt::format("z{}", i + 1),
                      SpringMass{.mass = chain.m[i], .stiffness = chain.k[i], .damping = chain.c}));
    if (i == 0)
      ground(z[0]);
    else
      mount(z[i], z[i - 1].child);
  }
  z.back().child.force = u;
  d.output("a") = z.back().child.accel;
  return d;
}

/// From the wall, where the spring's force is 1: position and force, body after body.
template <class T>
T by_chain_matrices(const Chain& chain, const T& s) {
  T x = T(0), force = T(1);
  for (std::size_t i = 0; i < chain.m.size(); ++i) {
    x += force / (T(chain.k[i]) + T(chain.c) * s);
    force += T(chain.m[i]) * s * s * x;
  }
  return s * s * x / force;
}

Point chain_point(double value, const Chain& chain, std::vector<Complex> at) {
  Point p{value, diagram_of(chain), std::move(at)};
  p.chain_matrices.emplace();
  for (const Complex s : p.s) {
    p.exact.push_back(one_by_one(by_chain_matrices(chain, Number(s.real(), s.imag()))));
    p.chain_matrices->push_back(MatrixXcd::Constant(1, 1, by_chain_matrices(chain, s)));
  }
  return p;
}

Chain uniform(std::size_t n, double c) {
  Chain chain{std::vector<double>(n), std::vector<double>(n), c};
  for (std::size_t i = 0; i < n; ++i) {
    chain.m[i] = 1 + 0.3 * static_cast<double>(i % 3);
    chain.k[i] = 100 + 7 * static_cast<double>(i % 5);
  }
  return chain;
}

const std::vector<Complex> kPoints{{0.05, 1}, {0.5, 10}, {1, 30}};

std::vector<Sweep> sweeps() {
  std::vector<Sweep> list;
  list.push_back({"mass ratio (scalar)", powers(1, 1e24, 100), [](double r) {
                    Chain chain = uniform(10, 0.1);
                    for (std::size_t i = 1; i < 10; i += 2) chain.m[i] *= r;
                    return chain_point(r, chain, kPoints);
                  }});
  list.push_back({"mass ratio (6 dof)", powers(1, 1e24, 1e3), [](double r) {
                    return Point{r, scene(Case::D, 6, {.ratio = std::sqrt(r)}), kPoints};
                  }});
  list.push_back({"stiffness ratio", powers(1, 1e24, 100), [](double r) {
                    Chain chain = uniform(10, 0.1);
                    for (std::size_t i = 1; i < 10; i += 2) chain.k[i] *= r;
                    return chain_point(r, chain, kPoints);
                  }});
  list.push_back({"chain length",
                  {3, 10, 30, 100, 300, 1000, 3000, 10000, 30000, 100000},
                  [](double n) {
                    return chain_point(n, uniform(static_cast<std::size_t>(n), 0.1),
                                       {{0.05, 1}, {0.5, 10}, {3, 30}});
                  },
                  600});
  // x = (1 - delta) x + u, the gain spread over three blocks.
  list.push_back({"distance of a loop from singular", powers(1, 1e-17, 0.1), [](double delta) {
                    const double g[] = {3.0, 0.7, (1 - delta) / 2.1};
                    Diagram d{"loop"};
                    auto u = d.input("u");
                    auto a = d.add("a", titop::Gain{.gain = g[0]});
                    auto b = d.add("b", titop::Gain{.gain = g[1]});
                    auto c = d.add("c", titop::Gain{.gain = g[2]});
                    a.in = c.out + u;
                    b.in = a.out;
                    c.in = b.out;
                    d.output("y") = c.out;
                    const Number loop = Number(g[0]) * Number(g[1]) * Number(g[2]);
                    return Point{delta, std::move(d), {{0, 1}}, {one_by_one(loop / (1 - loop))}};
                  }});
  list.push_back(
      {"parent mass towards 0, force imposed", powers(1, 1e-300, 1e-20), [](double m0) {
         Diagram d{"light parent"};
         auto u = d.input("u");
         auto z =
             d.add("z", SpringMass{.mass = 2, .stiffness = 50, .damping = 0.1, .parent_mass = m0});
         z.parent.force = -u;
         d.output("a") = z.child.accel;
         Point p{m0, std::move(d), kPoints};
         for (const Complex point : p.s) {
           const Number s(point.real(), point.imag());
           const Number spring = Number(50) + Number(0.1) * s;
           // m xdd = spring (x0 - x), m0 x0dd = u - spring (x0 - x)
           p.exact.push_back(one_by_one(
               spring / (Number(2) * Number(m0) * s * s + (Number(2) + Number(m0)) * spring)));
         }
         return p;
       }});
  list.push_back({"damping towards 0, at resonance", powers(1, 1e-16, 0.1), [](double c) {
                    const Chain chain = uniform(10, c);
                    double omega = 0;
                    for (const titop::Pole& pole : compile(diagram_of(uniform(10, 0))).poles())
                      omega = std::max(omega, pole.omega);
                    return chain_point(c, chain, {{0, omega}});
                  }});
  return list;
}

}  // namespace
}  // namespace titop_bench

int main(int argc, char** argv) {
  const bool quick = argc > 1 && std::string_view(argv[1]) == "quick";
  fmt::print("sweep,value,method,error,mark\n");
  for (const auto& sweep : titop_bench::sweeps()) titop_bench::run(sweep, quick);
}
