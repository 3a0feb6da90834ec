#include <doctest/doctest.h>
#include <fmt/format.h>

#include <set>
#include <titop/graph/linalg/eigen.hpp>
#include <titop/graph/linalg/index.hpp>
#include <titop/titop.hpp>

#include "support/close.hpp"
#include "support/mistakes.hpp"
#include "support/notes.hpp"
#include "support/rng.hpp"

/// Loops of gains: near-singular ones keep the reported digits, singular ones are refused by a
/// minimal set of ports, all others are never called singular.

using namespace titop;
using namespace titop_test;
using Eigen::MatrixXd;

namespace {

using titop::linalg::at;

/// out_i = gain_i in_i, in_i = sum of weight_ij out_j + u_i: L = I - diag(gain) W.
struct GainNetwork {
  std::vector<double> gain;
  MatrixXd W;
  std::set<std::string> planted = {};
  std::vector<int> number = {};  ///< in the names of the gains

  Diagram diagram() const {
    Diagram d{"gains"};
    auto u = d.input("u", static_cast<int>(gain.size()));
    std::vector<Gain::Handle> g;
    for (std::size_t i = 0; i < gain.size(); ++i)
      g.push_back(d.add(fmt::format("g{}", number[i]), Gain{.gain = gain[i]}));
    for (int i = 0; i < static_cast<int>(g.size()); ++i) {
      Expr sum = MatrixXd(MatrixXd::Identity(W.rows(), W.rows()).row(i)) * u;
      for (int j = 0; j < static_cast<int>(g.size()); ++j)
        if (W(i, j) != 0) sum = sum + W(i, j) * g[at(j)].out;
      g[at(i)].in = sum;
    }
    for (std::size_t i = 0; i < g.size(); ++i) d.output(fmt::format("y{}", i)) = g[i].out;
    return d;
  }
  /// Rows: g0.in, g0.out, g1.in, ...
  MatrixXd loop_matrix() const {
    const auto n = W.rows();
    MatrixXd L = MatrixXd::Identity(2 * n, 2 * n);
    for (Eigen::Index i = 0; i < n; ++i) {
      L(2 * i + 1, 2 * i) = -gain[static_cast<std::size_t>(i)];
      for (Eigen::Index j = 0; j < n; ++j) L(2 * i, 2 * j + 1) -= W(i, j);
    }
    return L;
  }
};

/// In a ring that feeds the others without feedback: the product of its gains.
enum class Plant { nothing, one, one_but_for_rounding };

/// Every loop but the planted one has a gain below 1.
GainNetwork random_gains(std::uint64_t seed, Plant plant) {
  Rng rng(seed);
  const int n = 3 + rng.below(12);
  GainNetwork net{{}, MatrixXd::Zero(n, n)};
  for (int i = 0; i < n; ++i) net.number.push_back(i);
  for (int i = 0; i < n; ++i) net.gain.push_back(rng.chance(0.5) ? rng.octaves(-6, 6) : -1);
  for (int i = 0; i < n; ++i)
    for (int j = 0; j < n; ++j)
      if (rng.chance(2.0 / n))
        net.W(i, j) = rng.between(-0.9, 0.9) / (3 * std::abs(net.gain[at(i)]));
  for (int i = 0; i < n; ++i)  // rows below 1: no loop can reach it
    if (const double sum = net.W.row(i).cwiseAbs().sum() * std::abs(net.gain[at(i)]); sum > 0.9)
      net.W.row(i) *= 0.9 / sum;
  if (plant == Plant::nothing) return net;
  const int length = 1 + rng.below(std::min(n, 5));
  std::vector<int> ring;
  for (int i = 0; i < n; ++i) ring.push_back(i);
  rng.shuffle(ring);
  ring.resize(at(length));
  for (const int i : ring) net.W.row(i).setZero();
  if (plant == Plant::one_but_for_rounding) rng.shuffle(net.number);
  double product = 1;
  for (int k = 0; k < length; ++k) {
    const double sign = rng.chance(0.5) ? 1 : -1;
    const double size =
        plant == Plant::one ? std::ldexp(1.0, rng.below(7) - 3) : rng.octaves(-3, 3);
    product *= net.gain[at(ring[at(k)])] = sign * size;
    net.W(ring[at(k)], ring[at((k + 1) % length)]) = 1;
    net.planted.insert(fmt::format("g{}.in", net.number[at(ring[at(k)])]));
    net.planted.insert(fmt::format("g{}.out", net.number[at(ring[at(k)])]));
  }
  net.W(ring.back(), ring.front()) = 1 / product;
  return net;
}

/// The ports of the network in the message.
std::set<std::string> named(const GainNetwork& net, const Error& e) {
  std::set<std::string> names;
  for (const int i : net.number)
    for (const char* port : {"in", "out"})
      if (const std::string name = fmt::format("g{}.{}", i, port);
          has_name(e.mistakes().front().message, name))
        names.insert(name);
  return names;
}

}  // namespace

TEST_CASE(
    "1000 random graphs with a planted singularity: the ports named lie in it, and none is too "
    "many") {
  for (std::uint64_t seed = 1; seed <= 1000; ++seed) {
    CAPTURE(seed);
    const GainNetwork net = random_gains(seed, Plant::one);
    const Error e = compile_error(net.diagram());
    REQUIRE(e.has(Code::ill_posed));
    REQUIRE(e.mistakes().size() == 1);
    const std::set<std::string> names = named(net, e);
    CHECK(!names.empty());
    for (const std::string& name : names) CHECK(net.planted.contains(name));
    // Rows of these ports: dependent, and without any one of them independent.
    const MatrixXd L = net.loop_matrix();
    std::vector<Eigen::Index> rows;
    for (const std::string& name : names)
      rows.push_back(2 * std::stoi(name.substr(1)) + (name.find(".out") != std::string::npos));
    const auto rank = [&](const std::vector<Eigen::Index>& list) {
      const MatrixXd part = L(list, Eigen::all);
      return Eigen::FullPivLU<MatrixXd>(part).rank();
    };
    CHECK(rank(rows) == static_cast<Eigen::Index>(rows.size()) - 1);
    for (std::size_t i = 0; i < rows.size() && rows.size() > 1; ++i) {
      std::vector<Eigen::Index> fewer = rows;
      fewer.erase(fewer.begin() + static_cast<std::ptrdiff_t>(i));
      CHECK(rank(fewer) == static_cast<Eigen::Index>(fewer.size()));
    }
  }
}

TEST_CASE(
    "1000 rings that are singular but for rounding, under any names: refused by their ports") {
  for (std::uint64_t seed = 1; seed <= 1000; ++seed) {
    CAPTURE(seed);
    const GainNetwork net = random_gains(seed, Plant::one_but_for_rounding);
    const Error e = compile_error(net.diagram());
    REQUIRE(e.has(Code::ill_posed));
    const std::set<std::string> names = named(net, e);
    CHECK(!names.empty());
    for (const std::string& name : names) CHECK(net.planted.contains(name));
  }
}

TEST_CASE("loops that no input reaches are judged where an output sees them") {
  const auto resting = [](double gain, bool apart) {
    Diagram d{"resting"};
    auto u = d.input("u");
    auto g = d.add("g", Gain{.gain = gain}), h = d.add("h", Gain{.gain = 0.5});
    g.in = h.out;
    h.in = g.out;
    if (apart) {
      d.output("y") = g.out + u;
      return d;
    }
    auto z = d.add("z", SpringMass{.mass = 2, .stiffness = 8});
    ground(z);
    z.child.force = u + g.out;
    d.output("y") = z.child.accel;
    return d;
  };
  for (const bool apart : {false, true}) {
    CAPTURE(apart);
    const Error e = compile_error(resting(2, apart));
    REQUIRE(e.has(Code::ill_posed));
    CHECK(says(e, Code::ill_posed, {"g.in", "g.out", "h.in", "h.out"}));
    CHECK(!has_name(e.mistakes().front().message, "z"));
    const System rests = compile(resting(1, apart));
    const std::complex<double> s{0.5, 3}, y = apart ? 1.0 : s * s / (2.0 * s * s + 8.0);
    CHECK(rests.order() == (apart ? 0 : 2));
    CHECK(std::abs(rests.transfer(s)(0, 0) - y) <= 1e-15);
  }
}

TEST_CASE("1000 random graphs without: none is refused, and the answer is that of L") {
  double worst = 0;
  for (std::uint64_t seed = 1; seed <= 1000; ++seed) {
    CAPTURE(seed);
    const GainNetwork net = random_gains(seed, Plant::nothing);
    Eigen::MatrixXcd G;
    REQUIRE_NOTHROW(G = compile(net.diagram()).transfer({0.1, 1}));
    const auto n = static_cast<Eigen::Index>(net.gain.size());
    const Eigen::VectorXd gain = Eigen::Map<const Eigen::VectorXd>(net.gain.data(), n);
    const MatrixXd L = MatrixXd::Identity(n, n) - gain.asDiagonal() * net.W;
    const MatrixXd exact = L.partialPivLu().solve(MatrixXd(gain.asDiagonal()));
    worst = std::max(worst, matrix_error(G, exact));
  }
  CHECK(worst <= 1e-12);
}

TEST_CASE("1 + d k = delta: solved with the digits of its estimate, down to one; refused at 0") {
  const auto ring = [](double delta) {
    Diagram d{"ring"};
    auto u = d.input("u");
    auto K = d.add("K", Gain{.gain = 1 - delta}), D = d.add("D", Gain{.gain = 1});
    K.in = D.out;
    D.in = K.out + u;
    d.output("y") = D.out;
    return d;
  };
  for (const double asked : {1e-10, 1e-12, 1e-13, 1e-14}) {
    CAPTURE(asked);
    const System system = compile(ring(asked));
    const double delta = 1 - (1 - asked);  // exact: the value of the gain
    const double error = relative(system.transfer(0)(0, 0).real(), 1 / delta);
    const int digits = static_cast<int>(std::round(-std::log10(asked)));
    CHECK(error <= 2.3e-16 / asked);
    CHECK(noted(system, Note::Kind::warning, "certify",
                {fmt::format("{:.2g}", system.certificate().margin),
                 fmt::format("{} digits", 16 - digits)}));
    // Four unknowns in a ring: |L^-1| |L| has the spectral radius 2 * 4 / delta.
    CHECK(relative(system.certificate().margin, 8 / delta) <= 0.01);
  }
  CHECK(!noted(compile(ring(1e-5)), Note::Kind::warning, "certify"));
  CHECK(
      says(compile_error(ring(0)), Code::ill_posed, {"D.in", "D.out", "K.in", "K.out", "u", "0"}));
}

TEST_CASE("a chain with one gain from 1 to 1e300: never singular, margin 1") {
  for (const double g : {1.0, 1e8, 1e16, 1e100, 1e200, 1e300}) {
    CAPTURE(g);
    for (int place = 0; place < 8; ++place) {
      Diagram d{"chain"};
      auto u = d.input("u");
      std::vector<Gain::Handle> k;
      for (int i = 0; i < 8; ++i)
        k.push_back(d.add(fmt::format("k{}", i), Gain{.gain = i == place ? g : 0.5}));
      k[0].in = u;
      for (std::size_t i = 1; i < k.size(); ++i) k[i].in = k[i - 1].out;
      d.output("y") = k.back().out;
      const System system = compile(d);
      CHECK(system.certificate().margin == 1);
      CHECK(system.certificate().weakest_pivot == 1);
      CHECK(relative(system.transfer({0, 1})(0, 0).real(), g / 128) <= 1e-15);
    }
  }
}

TEST_CASE("products that overflow are refused as not finite, not as singular") {
  const auto chain = [](double back) {
    Diagram d{"overflow"};
    auto u = d.input("u");
    auto a = d.add("a", Gain{.gain = 1e200}), b = d.add("b", Gain{.gain = 1e200});
    a.in = u + back * b.out;
    b.in = a.out;
    d.output("y") = b.out;
    return d;
  };
  const System open = compile(chain(0));
  CHECK(says(error_of([&] { open.transfer(1); }), Code::not_finite, {"overflow", "s = 1"}));
  CHECK(says(error_of([&] { open.state_space(); }), Code::not_finite, {"overflow", "1e308"}));
  CHECK(relative(compile(chain(-1e200)).transfer(1)(0, 0).real(), 1e-200) <= 1e-15);

  Diagram d{"direct terms"};
  auto z = d.add("z", SpringMass{.mass = 1e-200}), w = d.add("w", SpringMass{.mass = 1});
  ground(z), ground(w);
  z.child.force = 1e200 * w.child.accel + d.input("u");
  w.child.force = 1.0 * z.child.accel;
  d.output("a") = w.child.accel;
  CHECK(says(compile_error(d), Code::not_finite, {"child", "1e308"}));
}

TEST_CASE("tridiag(-1, 3, -1) as a graph of 10 to 1000 nodes") {
  for (const int n : {10, 30, 100, 300, 1000}) {
    CAPTURE(n);
    Diagram d{"tridiagonal"};
    auto u = d.input("u");
    std::vector<Gain::Handle> x;
    for (int i = 0; i < n; ++i) x.push_back(d.add(fmt::format("x{}", i), Gain{.gain = 1}));
    for (int i = 0; i < n; ++i) {
      Expr sum = u.expr() - 2.0 * x[at(i)].out;
      if (i > 0) sum = sum + x[at(i - 1)].out;
      if (i + 1 < n) sum = sum + x[at(i + 1)].out;
      x[at(i)].in = sum;
      d.output(fmt::format("y{}", i)) = x[at(i)].out;
    }
    const System system = compile(d);
    const Eigen::MatrixXcd y = system.transfer(0);
    const double r = (3 - std::sqrt(5.0)) / 2;  // x_i = 1 - (r^i + r^(n+1-i)) / (1 + r^(n+1))
    double worst = 0;
    for (int i = 1; i <= n; ++i)
      worst = std::max(worst,
                       relative(y(i - 1, 0).real(), 1 - (std::pow(r, i) + std::pow(r, n + 1 - i)) /
                                                            (1 + std::pow(r, n + 1))));
    CHECK(worst <= 1e-14);
    CHECK(system.certificate().weakest_pivot >= 0.1);
  }
}
