#include <complex>
#include <cstring>
#include <memory>
#include <utility>

#include "generate/draws.hpp"
#include "methods/dense_lu.hpp"
#include "methods/sparse_lu.hpp"
#include "support/agreement.hpp"
#include "support/cases.hpp"
#include "support/timing.hpp"

/// From a built Diagram, or new values, to the model: dense into a warm buffer (compile,
/// recompile), or in factors with one product by it (factor, refactor).
namespace titop_bench {
namespace {

using Eigen::VectorXd;
using titop::Diagram;
using titop::StateSpace;
using titop::System;

System compiled(const Diagram& diagram) { return compile(diagram, {.minimize_up_to = 0}); }

VectorXd random(Eigen::Index size) { return titop::generate::Mersenne(7).matrix(size, 1); }

/// [xdot; y] for random x and u.
struct Probe {
  VectorXd x, u;
  explicit Probe(const System& s)
      : x(random(s.order())), u(random(static_cast<Eigen::Index>(s.inputs().size()))) {}
  VectorXd operator()(const System& s) const {
    const System::Rates r = s.apply(x, u);
    VectorXd v(r.xdot.size() + r.y.size());
    v << r.xdot, r.y;
    return v;
  }
  VectorXd operator()(const StateSpace& m) const {
    VectorXd v(m.A.rows() + m.C.rows());
    v << m.A * x + m.B * u, m.C * x + m.D * u;
    return v;
  }
};

/// The scene as the other methods get it, and the model that they must find.
struct Reference {
  System system;
  Network network;
  Probe probe;
  explicit Reference(Case c, int n)
      : system(compiled(case_diagram(c, n))), network(network_of(system)), probe(system) {}
  double from(const StateSpace& model) const {
    StateSpace mine;
    system.write(mine);
    return difference(model, mine);
  }
};

// --- titop ------------------------------------------------------------------------------------

/// `threads`: 0 for all cores.
template <int threads>
Prepared titop_compile(Case c, int n) {
  struct Data {
    Diagram diagram;
    StateSpace model;
  };
  const auto data = std::make_shared<Data>(Data{case_diagram(c, n), {}});
  return {[=] { compiled(data->diagram).write(data->model, threads); },
          [=] {  // the dense model against the factors
            const System system = compiled(data->diagram);
            const Probe probe(system);
            return difference(probe(data->model), probe(system));
          }};
}

Prepared titop_factor(Case c, int n) {
  struct Data {
    Diagram diagram;
    Probe probe;
    VectorXd product = {};
  };
  Diagram diagram = case_diagram(c, n);
  const Probe probe(compiled(diagram));
  const auto data = std::make_shared<Data>(Data{std::move(diagram), probe});
  return {[=] { data->product = data->probe(compiled(data->diagram)); }, {}};
}

/// Every body's parameter gets another value each time, never that of the system that is updated,
/// whose parts would be reused. Compared with a compile at the same value.
struct Sweep {
  Case c;
  int n;
  System system;
  Probe probe;
  double p = 1;
  StateSpace model = {};
  VectorXd product = {};

  Sweep(Case scene_case, int size)
      : c(scene_case), n(size), system(compiled(at(1))), probe(system) {}
  Diagram at(double value) const { return case_diagram(c, n, {.varies = Varies::all, .p = value}); }
  System next() {
    p = p == 1.0625 ? 1.125 : 1.0625;
    return system.update({{"p", p}});
  }
};

template <int threads>
Prepared titop_recompile(Case c, int n) {
  const auto sweep = std::make_shared<Sweep>(c, n);
  return {[=] { sweep->next().write(sweep->model, threads); },
          [=] {
            StateSpace fresh;
            compiled(sweep->at(sweep->p)).write(fresh);
            return difference(sweep->model, fresh);
          }};
}

Prepared titop_refactor(Case c, int n) {
  const auto sweep = std::make_shared<Sweep>(c, n);
  return {[=] { sweep->product = sweep->probe(sweep->next()); },
          [=] { return difference(sweep->product, sweep->probe(compiled(sweep->at(sweep->p)))); }};
}

/// Sparse E, A, B, C, D instead of factors.
Prepared titop_descriptor(Case c, int n) {
  struct Data {
    Diagram diagram;
    titop::Descriptor model = {};
  };
  const auto data = std::make_shared<Data>(Data{case_diagram(c, n)});
  return {[=] { data->model = compiled(data->diagram).descriptor(); }, {}};
}

Prepared titop_redescriptor(Case c, int n) {
  const auto sweep = std::make_shared<Sweep>(c, n);
  const auto model = std::make_shared<titop::Descriptor>();
  return {[=] { sweep->next().write(*model); }, {}};
}

/// The step by effect, which the compile timing leaves out: the dense model without states of
/// negligible effect.
Prepared by_effect(Case c, int n) {
  struct Data {
    StateSpace model;
    titop::Minimized result = {};
  };
  const auto data = std::make_shared<Data>();
  compiled(case_diagram(c, n)).write(data->model);
  return {[=] { data->result = titop::minimize(data->model); },
          [=] {
            const std::complex<double> s(0.2, 3);
            const std::vector<Eigen::MatrixXcd> found{data->result.model.transfer(s)};
            return difference(found, {data->model.transfer(s)});
          }};
}

// --- alternatives of a user --------------------------------------------------------------------

struct Other : Reference {
  StateSpace model = {};
  std::unique_ptr<SparseLu> lu = {};
  VectorXd product = {};
  using Reference::Reference;
};

Prepared dense_compile(Case c, int n) {
  const auto other = std::make_shared<Other>(c, n);
  return {[=] { dense_lu(other->network, other->model); },
          [=] { return other->from(other->model); }};
}

enum class Order { anew, kept };  ///< of elimination: found each time, or once

SparseLu& factorized(Other& other, Order order) {
  if (order == Order::anew || !other.lu) other.lu = std::make_unique<SparseLu>(other.network);
  other.lu->factorize();
  return *other.lu;
}

Prepared sparse_model(Case c, int n, Order order) {
  const auto other = std::make_shared<Other>(c, n);
  return {[=] { factorized(*other, order).write(other->model); },
          [=] { return other->from(other->model); }};
}

Prepared sparse_product(Case c, int n, Order order) {
  const auto other = std::make_shared<Other>(c, n);
  return {[=] { other->product = factorized(*other, order).apply(other->probe.x, other->probe.u); },
          [=] { return difference(other->product, other->probe(other->system)); }};
}

Prepared sparse_compile(Case c, int n) { return sparse_model(c, n, Order::anew); }
Prepared sparse_recompile(Case c, int n) { return sparse_model(c, n, Order::kept); }
Prepared sparse_factor(Case c, int n) { return sparse_product(c, n, Order::anew); }
Prepared sparse_refactor(Case c, int n) { return sparse_product(c, n, Order::kept); }

// --- floors -----------------------------------------------------------------------------------

Prepared memset_of_A(Case c, int n) {
  const auto order = static_cast<std::size_t>(compiled(case_diagram(c, n)).order());
  const auto A = std::make_shared<std::vector<double>>(order * order, 1.0);
  return {[=] {
            std::memset(A->data(), 0, A->size() * sizeof(double));
            asm volatile("" : : "r"(A->data()) : "memory");  // it must happen
          },
          {}};
}

Prepared sparse_factorization(Case c, int n) {
  const auto other = std::make_shared<Other>(c, n);
  return {[=] {
            SparseLu lu(other->network);
            lu.factorize();
          },
          {}};
}

// --- which, and how large ---------------------------------------------------------------------

using Make = Prepared (*)(Case, int);

Method method(const char* task, Case c, const char* name, const std::vector<int>& sizes,
              Make make) {
  return {task, name_of(c), name, sizes, [=](int n) { return make(c, n); }};
}

std::vector<Method> methods() {
  const std::vector<int> bodies{1, 2, 5, 10, 20, 50, 100, 200, 500};
  const std::vector<int> masses{1, 3, 10, 30, 100, 300, 1000};
  const std::vector<int> many{1, 3, 10, 30, 100, 300, 1000, 10000, 100000};
  std::vector<Method> list;
  for (const Case c : {Case::D, Case::F, Case::K, Case::A, Case::BL, Case::C}) {
    const bool scalar = c == Case::A || c == Case::BL || c == Case::C;
    const auto& sizes = scalar ? masses : bodies;
    list.push_back(method("compile", c, "titop", sizes, titop_compile<0>));
    list.push_back(method("compile", c, "titop on one core", sizes, titop_compile<1>));
    list.push_back(method("compile", c, "dense LU", sizes, dense_compile));
    list.push_back(method("compile", c, "sparse LU", sizes, sparse_compile));
    list.push_back(method("compile", c, "memset of A", sizes, memset_of_A));
    list.push_back(method("recompile", c, "titop", sizes, titop_recompile<0>));
    list.push_back(method("recompile", c, "titop on one core", sizes, titop_recompile<1>));
    list.push_back(method("recompile", c, "sparse LU", sizes, sparse_recompile));
    list.push_back(method("minimize", c, "titop", sizes, by_effect));
    const auto& long_sizes = scalar ? many : bodies;
    list.push_back(method("factor", c, "titop", long_sizes, titop_factor));
    list.push_back(method("factor", c, "titop descriptor", long_sizes, titop_descriptor));
    list.push_back(method("factor", c, "sparse LU", long_sizes, sparse_factor));
    list.push_back(method("factor", c, "factorization alone", long_sizes, sparse_factorization));
    list.push_back(method("refactor", c, "titop", long_sizes, titop_refactor));
    list.push_back(method("refactor", c, "titop descriptor", long_sizes, titop_redescriptor));
    list.push_back(method("refactor", c, "sparse LU", long_sizes, sparse_refactor));
  }
  return list;
}

}  // namespace
}  // namespace titop_bench

int main(int argc, char** argv) { return titop_bench::run(argc, argv, titop_bench::methods()); }
