#include <fmt/format.h>

#include <cstdio>
#include <exception>
#include <functional>
#include <string_view>

#include "methods/dense_lu.hpp"
#include "methods/oracle.hpp"
#include "methods/sparse_lu.hpp"
#include "support/agreement.hpp"
#include "support/cases.hpp"

/// Digits left where neighbouring bodies differ by the square of a ratio: ten bodies scaled by it
/// and by 1/it in turn, the transfer by each method against 150 digits, at s = (0.05 + j) omega.
namespace titop_bench {
namespace {

using Eigen::MatrixXcd;
using titop::Precision;
using titop::StateSpace;
using titop::System;

using Transfer = std::function<MatrixXcd(std::complex<double>)>;

struct Entry {
  const char* name;
  Transfer transfer;
};

std::vector<Entry> methods(const System& system, const Network& network) {
  StateSpace written, by_dense;
  system.write(written);
  dense_lu(network, by_dense);
  SparseLu lu(network);
  lu.factorize();
  StateSpace by_sparse;
  lu.write(by_sparse);
  const auto at = [&](Precision p) {
    return [&system, p](std::complex<double> s) { return system.transfer(s, p); };
  };
  const auto of = [](const StateSpace& m) {
    return [m](std::complex<double> s) { return m.transfer(s); };
  };
  return {{"titop factors", at(Precision::standard)},
          {"titop as needed", at(Precision::as_needed)},
          {"titop float", at(Precision::single)},
          {"titop refined", at(Precision::refined)},
          {"titop long double", at(Precision::extended)},
          {"titop dense A", of(written)},
          {"dense LU", of(by_dense)},
          {"sparse LU", of(by_sparse)},
          {"sparse LU at s",
           [&network](std::complex<double> s) { return SparsePencil(network).transfer(s); }}};
}

/// What fails (a singular matrix) has no digits left: 1.
double error(const Entry& method, const std::vector<std::complex<double>>& points,
             const std::vector<MatrixXcd>& exact) {
  try {
    std::vector<MatrixXcd> found;
    for (const auto& s : points) found.push_back(method.transfer(s));
    return std::min(1.0, difference(found, exact));
  } catch (const std::exception&) {
    return 1;
  }
}

void compare(Case c, int exponent, bool quick) {
  const System system =
      compile(scene(c, 10, {.ratio = std::pow(10.0, exponent)}), {.minimize_up_to = 0});
  const Network network = network_of(system);
  std::vector<std::complex<double>> points;
  std::vector<MatrixXcd> exact;
  for (double omega = 0.1; omega < 2e3; omega *= quick ? 100 : 2) {
    points.push_back(omega * std::complex<double>(0.05, 1));
    exact.push_back(oracle_transfer(system, points.back()));
  }
  for (const Entry& m : methods(system, network))
    fmt::print("{},10,{},{},{:.2g}\n", name_of(c), exponent, m.name, error(m, points, exact));
  std::fflush(stdout);
}

}  // namespace
}  // namespace titop_bench

int main(int argc, char** argv) {
  const bool quick = argc > 1 && std::string_view(argv[1]) == "quick";
  using titop_bench::Case;
  fmt::print("scene,n,exponent,method,error\n");
  for (const Case c : {Case::A, Case::BL, Case::D})
    for (const int exponent : quick ? std::vector{0, 6} : std::vector{0, 3, 6, 9, 12})
      titop_bench::compare(c, exponent, quick);
}
