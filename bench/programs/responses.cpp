#include <memory>

#include "methods/sparse_lu.hpp"
#include "support/agreement.hpp"
#include "support/cases.hpp"
#include "support/timing.hpp"

/// Typical uses of a compiled system: its transfer at one s, a sweep over 100 frequencies, and one
/// product (xdot and y of x and u).
namespace titop_bench {
namespace {

using Eigen::MatrixXcd;
using Eigen::VectorXd;
using titop::StateSpace;
using titop::System;

/// One scene for all three tasks; the last result of the method that is timed.
struct Setup {
  System system;
  Network network;
  StateSpace model = {};
  std::vector<double> omega;
  std::vector<MatrixXcd> response = {};
  VectorXd x, u, product = {};

  Setup(Case c, int n, int points)
      : system(compile(case_diagram(c, n), {.minimize_up_to = 0})),
        network(network_of(system)),
        omega(frequencies(points)),
        x(VectorXd::LinSpaced(system.order(), -1, 1)),
        u(VectorXd::Ones(static_cast<Eigen::Index>(system.inputs().size()))) {}
  double from_titop() const { return difference(response, system.frequency_response(omega)); }
  double product_from_titop() const {
    const System::Rates r = system.apply(x, u);
    VectorXd v(r.xdot.size() + r.y.size());
    v << r.xdot, r.y;
    return difference(product, v);
  }
};

/// `answer(scene, s)` at each frequency.
template <class Answer>
Prepared sweep(const std::shared_ptr<Setup>& scene, Answer answer) {
  return {[=] {
            scene->response.clear();
            for (const double w : scene->omega) scene->response.push_back(answer({0, w}));
          },
          [=] { return scene->from_titop(); }};
}

Prepared titop_sweep(Case c, int n, int points, int threads) {
  const auto scene = std::make_shared<Setup>(c, n, points);
  return {[=] { scene->response = scene->system.frequency_response(scene->omega, threads); }, {}};
}

Prepared sparse_sweep(Case c, int n, int points) {
  const auto scene = std::make_shared<Setup>(c, n, points);
  const auto pencil = std::make_shared<SparsePencil<>>(scene->network);
  return sweep(scene, [=](std::complex<double> s) { return pencil->transfer(s); });
}

Prepared dense_sweep(Case c, int n, int points) {
  const auto scene = std::make_shared<Setup>(c, n, points);
  scene->system.write(scene->model);
  return sweep(scene, [=](std::complex<double> s) { return scene->model.transfer(s); });
}

Prepared titop_apply(Case c, int n) {
  const auto scene = std::make_shared<Setup>(c, n, 0);
  return {[=] { scene->product = scene->system.apply(scene->x, scene->u).xdot; }, {}};
}

Prepared sparse_apply(Case c, int n) {
  const auto scene = std::make_shared<Setup>(c, n, 0);
  const auto lu = std::make_shared<SparseLu>(scene->network);
  lu->factorize();
  return {[=] { scene->product = lu->apply(scene->x, scene->u); },
          [=] { return scene->product_from_titop(); }};
}

Prepared dense_apply(Case c, int n) {
  const auto scene = std::make_shared<Setup>(c, n, 0);
  StateSpace& m = scene->model;
  scene->system.write(m);
  return {[=, &m] {
            scene->product.resize(m.A.rows() + m.C.rows());
            scene->product << m.A * scene->x + m.B * scene->u, m.C * scene->x + m.D * scene->u;
          },
          [=] { return scene->product_from_titop(); }};
}

std::vector<Method> methods() {
  std::vector<Method> list;
  const auto add = [&](const char* task, Case c, const char* name, const std::vector<int>& sizes,
                       const std::function<Prepared(int)>& make) {
    list.push_back({task, name_of(c), name, sizes, make});
  };
  for (const Case c : {Case::D, Case::K, Case::A, Case::BL}) {
    const bool scalar = c == Case::A || c == Case::BL;
    const std::vector<int> few =
        scalar ? std::vector<int>{1, 10, 100, 1000} : std::vector<int>{1, 10, 50, 200};
    std::vector<int> many = few;
    many.push_back(scalar ? 10000 : 1000);
    for (const auto& [task, points] : {std::pair{"transfer", 1}, std::pair{"sweep", 100}}) {
      const int m = points;
      add(task, c, "titop", many, [=](int n) { return titop_sweep(c, n, m, 1); });
      if (m > 1)
        add(task, c, "titop all cores", many, [=](int n) { return titop_sweep(c, n, m, 0); });
      add(task, c, "sparse LU", many, [=](int n) { return sparse_sweep(c, n, m); });
      add(task, c, "dense model", few, [=](int n) { return dense_sweep(c, n, m); });
    }
    add("apply", c, "titop", many, [=](int n) { return titop_apply(c, n); });
    add("apply", c, "sparse LU", many, [=](int n) { return sparse_apply(c, n); });
    add("apply", c, "dense model", few, [=](int n) { return dense_apply(c, n); });
  }
  return list;
}

}  // namespace
}  // namespace titop_bench

int main(int argc, char** argv) { return titop_bench::run(argc, argv, titop_bench::methods()); }
