#include <fmt/format.h>

#include <cmath>
#include <cstdio>
#include <functional>

#include "methods/at_s.hpp"
#include "methods/dense_lu.hpp"
#include "methods/oracle.hpp"
#include "methods/sparse_lu.hpp"
#include "support/agreement.hpp"
#include "support/quick.hpp"
#include "support/sweeps.hpp"

/// Every method up to its failure: the error of the transfer against 150 digits while one quantity
/// of a scene becomes extreme. The library's error is listed with its diagnosis: "warned" if the
/// log warns, "noted" if the log lists a redundant closure, the error's code if it refuses. Returns
/// 1 if an error of the library is above its promise without a diagnosis.
namespace titop_bench {
namespace {

using Eigen::MatrixXcd;
using titop::Note;
using titop::Precision;
using titop::StateSpace;
using titop::System;
using Complex = std::complex<double>;
using Transfer = std::function<MatrixXcd(Complex)>;

constexpr double kPromise = 1e-11;        ///< of System::transfer
constexpr double kDensePromise = 1e-8;    ///< of state_space(), which warns beyond 1e-9 of its own
constexpr Eigen::Index kDenseUpTo = 400;  ///< states

/// Prints the rows of one sweep.
class Rows {
 public:
  explicit Rows(const Sweep& sweep) : sweep_(sweep) {}

  /// A method that throws has error 1; a refusal of the library is its mark.
  double add(double value, const char* method, const Extreme& e, const Transfer& transfer,
             const std::string& mark = "") const {
    try {
      std::vector<MatrixXcd> found;
      for (const Complex s : e.s) found.push_back(transfer(s));
      const double error = error_of(found, e.exact);
      print(value, method, error, mark);
      return mark.empty() ? error : 0;
    } catch (const titop::Error& error) {
      refused(value, method, error);
    } catch (const std::exception&) {
      print(value, method, 1, "");
    }
    return 0;
  }

  void refused(double value, const char* method, const titop::Error& error) const {
    print(value, method, 1, std::string(to_string(error.mistakes().front().code)));
  }

  void print(double value, const char* method, double error, const std::string& mark) const {
    fmt::print("{},{},{},{:.3g},{},{:.3g},{}\n", sweep_.name, sweep_.title, sweep_.quantity, value,
               method, error < 1e3 ? error : 1e3, mark);
  }

 private:
  static double error_of(const std::vector<MatrixXcd>& found, const std::vector<MatrixXcd>& exact) {
    for (const MatrixXcd& m : found)
      if (!m.allFinite()) return HUGE_VAL;
    return difference(found, exact);
  }
  const Sweep& sweep_;
};

std::string said(const System& system) {
  std::string mark;
  for (const Note& note : system.notes()) {
    if (note.kind == Note::Kind::warning) return "warned";
    if (note.text.find("closing equations are redundant") != std::string::npos) mark = "noted";
  }
  return mark;
}

/// For the log of a run.
void tell(const Sweep& sweep, double value, const System& system) {
  for (const Note& note : system.notes())
    if (note.kind == Note::Kind::warning)
      fmt::print(stderr, "{} {:.3g}: {}\n", sweep.name, value, note.text);
}

std::string said_of_dense(const System& system) {
  return system.dense_log().find(" warning ") != std::string::npos ? "warned" : said(system);
}

/// True if the library meets its promise.
bool library(const Rows& rows, double value, const Extreme& e, const System& system,
             double inherent) {
  const std::string mark = said(system);
  const double error = rows.add(
      value, "titop", e, [&](Complex s) { return system.transfer(s); }, mark);
  rows.add(
      value, "titop in double", e,
      [&](Complex s) { return system.transfer(s, Precision::standard); }, mark);
  if (system.order() > kDenseUpTo || system.order() == 0)
    return error <= std::max(kPromise, inherent);
  system.state_space();
  const double dense = rows.add(
      value, "titop dense model", e, [&](Complex s) { return system.state_space().transfer(s); },
      said_of_dense(system));
  return error <= std::max(kPromise, inherent) && dense <= std::max(kDensePromise, inherent);
}

void others(const Rows& rows, double value, const Extreme& e, const Network& network) {
  SparsePencil<> pencil(network);
  rows.add(value, "sparse LU at s", e, [&](Complex s) { return pencil.transfer(s); });
  if (is_chain(network))
    rows.add(value, "tearing", e, [&](Complex s) { return tearing_at_s(network, s); });
  if (network.states() > kDenseUpTo) return;
  rows.add(value, "block by block", e, [&](Complex s) { return block_by_block_at_s(network, s); });
  StateSpace model;
  rows.add(value, "dense LU", e, [&](Complex s) {
    if (model.D.size() == 0) dense_lu(network, model);
    return model.transfer(s);
  });
}

bool run(const Sweep& sweep, bool quick) {
  bool kept = true;
  const Rows rows(sweep);
  for (std::size_t i = 0; i < sweep.values.size(); i += quick ? 4 : 1) {
    const double value = sweep.values[i];
    try {
      Extreme e = sweep.at(value);
      const System system = compile(e.diagram, {.minimize_up_to = e.minimize_up_to});
      if (e.exact.empty())
        for (const Complex s : e.s) e.exact.push_back(oracle_transfer(system, s));
      tell(sweep, value, system);
      const double inherent = sweep.inherent(value);
      if (inherent > 0) rows.print(value, "last place of the data", inherent, "");
      if (!library(rows, value, e, system, inherent)) {
        fmt::print(stderr, "{} {:.3g}: an error of the library that it does not tell\n", sweep.name,
                   value);
        kept = false;
      }
      if (const auto network = network_if_any(system)) others(rows, value, e, *network);
    } catch (const titop::Error& error) {
      rows.refused(value, "titop", error);
    }
    std::fflush(stdout);
  }
  return kept;
}

}  // namespace
}  // namespace titop_bench

int main(int argc, char** argv) {
  const bool quick = titop_bench::is_quick(argc, argv);
  fmt::print("sweep,title,quantity,value,method,error,mark\n");
  bool kept = true;
  for (const auto& sweep : titop_bench::sweeps())
    if (quick || argc < 2 || sweep.name == argv[1]) kept = titop_bench::run(sweep, quick) && kept;
  return kept ? 0 : 1;
}
