#include <fmt/format.h>

#include <chrono>
#include <cmath>
#include <cstdio>
#include <exception>
#include <functional>
#include <memory>
#include <string_view>

#include "methods/assembled.hpp"
#include "methods/at_s.hpp"
#include "methods/dense_lu.hpp"
#include "methods/hessenberg.hpp"
#include "methods/oracle.hpp"
#include "methods/sparse_lu.hpp"
#include "support/agreement.hpp"
#include "support/cases.hpp"
#include "support/quick.hpp"

/// Error against time: one transfer by every method in every precision against 150 digits, without
/// the time of steps common to all s (compiling, writing, ordering); and 100 frequencies from the
/// compiled system on, all time counted, against 50 digits. Returns 1 if a transfer of the library
/// is off.
namespace titop_bench {
namespace {

using Eigen::MatrixXcd;
using titop::Diagram;
using titop::Precision;
using titop::StateSpace;
using titop::System;
using Complex = std::complex<double>;
using Responses = std::vector<MatrixXcd>;

/// Best of some runs, of at least a hundredth of a second in all.
double seconds_of(const std::function<void()>& f) {
  using Clock = std::chrono::steady_clock;
  double best = HUGE_VAL, all = 0;
  for (int i = 0; i < 100 && all < 0.01; ++i) {
    const auto start = Clock::now();
    f();
    const double seconds = std::chrono::duration<double>(Clock::now() - start).count();
    best = std::min(best, seconds);
    all += seconds;
  }
  return best;
}

/// Largest error of a transfer by the library in double or finer.
constexpr double kPromised = 1e-11;

struct Entry {
  const char* method;
  const char* precision;
  std::function<MatrixXcd(Complex)> transfer;
};

/// The library's line, and the same elimination in all precisions.
void add_library(std::vector<Entry>& list, const System& system) {
  const auto add = [&](const char* name, Precision p) {
    list.push_back({"titop", name, [&system, p](Complex s) { return system.transfer(s, p); }});
  };
  add("double", Precision::standard);
  add("refined", Precision::refined);
  add("twofold", Precision::twofold);
  add("50 digits", Precision::digits50);
  add("as needed", Precision::as_needed);
}

/// A model as one has it, by a dense LU at each s.
void add_model(std::vector<Entry>& list, const char* method, const StateSpace& model) {
  list.push_back({method, "double", [model](Complex s) { return model.transfer(s); }});
}

template <class Scene>
void add_at_s(std::vector<Entry>& list, const char* method, const Scene& scene,
              MatrixXcd (*transfer)(const Scene&, Complex, Digits)) {
  const auto add = [&](const char* name, Digits digits) {
    list.push_back({method, name,
                    [&scene, transfer, digits](Complex s) { return transfer(scene, s, digits); }});
  };
  add("float", Digits::single);
  add("double", Digits::standard);
  add("long double", Digits::extended);
  add("50 digits", Digits::fifty);
}

/// refined: one step of iterative refinement with the same factors.
template <class SparseLuAtS, class Scene>
void add_sparse(std::vector<Entry>& list, const char* precision, const Scene& scene,
                bool refine = false) {
  const auto lu = std::make_shared<SparseLuAtS>(scene);
  list.push_back(
      {"sparse LU at s", precision, [lu, refine](Complex s) { return lu->transfer(s, refine); }});
}

/// The other methods, on a network of blocks or on a structure with constraints.
template <template <class> class SparseLuAtS, class Scene>
void add_others(std::vector<Entry>& list, const Scene& scene, bool can_be_torn) {
  StateSpace model;
  dense_lu(scene, model);
  add_model(list, "dense LU model", model);
  add_sparse<SparseLuAtS<float>>(list, "float", scene);
  add_sparse<SparseLuAtS<double>>(list, "double", scene);
  add_sparse<SparseLuAtS<double>>(list, "refined", scene, true);
  add_sparse<SparseLuAtS<long double>>(list, "long double", scene);
  add_at_s<Scene>(list, "dense LU at s", scene, dense_at_s);
  list.insert(list.end() - 2,  // after double
              {"dense LU at s", "refined", [&scene](Complex s) { return refined_at_s(scene, s); }});
  add_at_s<Scene>(list, "block by block", scene, block_by_block_at_s);
  if (can_be_torn) add_at_s<Scene>(list, "tearing", scene, tearing_at_s);
}

bool is_closed(Case c) { return c == Case::R || c == Case::G; }

void row(const char* task, Case c, int n, const char* method, const char* precision, double seconds,
         double error) {
  fmt::print("{},{},{},{},{},{:.4g},{:.3g}\n", task, name_of(c), n, method, precision, seconds,
             std::isfinite(error) ? std::min(error, 1e3) : 1e3);
  std::fflush(stdout);
}

/// True if the library's own lines are as exact as promised.
bool transfers(Case c, int n, bool quick) {
  const Diagram diagram = case_diagram(c, n);
  const System system = compile(diagram, {.minimize_up_to = 0});
  std::vector<Entry> methods;
  add_library(methods, system);
  StateSpace model;
  system.write(model);
  add_model(methods, "titop dense model", model);
  const Assembly assembly = is_closed(c) ? assemble(diagram) : Assembly{};
  const Network network = is_closed(c) ? Network{} : network_of(system);
  if (is_closed(c))
    add_others<SparseAssembly>(methods, assembly, is_ring(assembly));
  else
    add_others<SparsePencil>(methods, network, is_chain(network));

  std::vector<Complex> points;
  Responses exact;
  for (double omega = 0.3; omega < 1e4; omega *= quick ? 100 : 10) {
    points.push_back(omega * Complex(0.05, 1));
    exact.push_back(oracle_transfer(system, points.back()));
  }
  bool kept = true;
  for (const Entry& m : methods) {
    double seconds = 0, error = 1;
    try {
      Responses found;
      for (const Complex s : points) found.push_back(m.transfer(s));
      error = difference(found, exact);
      seconds = seconds_of([&] { m.transfer(points[1]); });
    } catch (const std::exception&) {  // singular: no digits left
    }
    row("transfer", c, n, m.method, m.precision, seconds, error);
    const bool promised = std::string_view(m.method) == "titop" && m.precision[0] != 'f';
    kept = kept && (!promised || error <= kPromised);
  }
  return kept;
}

/// f(omega) -> responses, prepared anew each time.
void response(Case c, int n, const char* method, const char* precision, const Responses& exact,
              const std::function<Responses()>& f) {
  Responses found;
  const double seconds = seconds_of([&] { found = f(); });
  Responses some;
  for (std::size_t k = 0; k < exact.size(); ++k) some.push_back(found[5 * k]);
  row("response", c, n, method, precision, seconds, difference(some, exact));
}

void responses(Case c, int n) {
  const System system = compile(case_diagram(c, n), {.minimize_up_to = 0});
  std::vector<double> omega;
  for (int k = 0; k < 100; ++k) omega.push_back(0.11 * std::pow(1e4, k / 99.0));
  Responses exact;
  for (std::size_t k = 0; k < omega.size(); k += 5)
    exact.push_back(system.transfer({0, omega[k]}, Precision::digits50));
  const auto all = [&](const auto& transfer) {
    Responses r;
    for (const double w : omega) r.push_back(transfer(Complex(0, w)));
    return r;
  };
  const auto factored = [&](const char* name, Precision p) {
    response(c, n, "titop", name, exact,
             [&, p] { return all([&](Complex s) { return system.transfer(s, p); }); });
  };
  factored("double", Precision::standard);
  factored("refined", Precision::refined);
  factored("twofold", Precision::twofold);
  factored("as needed", Precision::as_needed);
  response(c, n, "dense model and LU", "double", exact, [&] {
    StateSpace m;
    system.write(m);
    return all([&](Complex s) { return m.transfer(s); });
  });
  response(c, n, "dense model and Hessenberg", "double", exact, [&] {
    StateSpace m;
    system.write(m);
    const Hessenberg reduced(m);
    return all([&](Complex s) { return reduced.transfer(s); });
  });
}

}  // namespace
}  // namespace titop_bench

int main(int argc, char** argv) {
  const bool quick = titop_bench::is_quick(argc, argv);
  using titop_bench::Case;
  fmt::print("task,scene,n,method,precision,seconds,error\n");
  bool kept = true;
  for (const Case c : {Case::A, Case::BL, Case::C, Case::D, Case::F, Case::K})
    kept = titop_bench::transfers(c, quick ? 4 : 10, quick) && kept;
  kept = titop_bench::transfers(Case::R, quick ? 3 : 8, quick) && kept;
  kept = titop_bench::transfers(Case::G, quick ? 4 : 9, quick) && kept;
  for (const int n : quick ? std::vector{2} : std::vector{2, 10, 50})
    titop_bench::responses(Case::D, n);
  return kept ? 0 : 1;
}
