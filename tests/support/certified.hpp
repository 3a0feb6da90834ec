#pragma once

#include <doctest/doctest.h>

#include <titop/compiler/system/compile_graph.hpp>
#include <titop/compiler/system/system_data.hpp>
#include <titop/titop.hpp>

#include "support/faulty_models.hpp"

/// Certificates of right models, and of the same models with planted faults.
namespace titop_test {

/// 30 times the error that a certificate allows: its own points show less than these 200.
inline constexpr double kClearChange = 1e-5;

struct FaultCount {
  int right = 0;    ///< models, all of them certified without a fault
  int minimal = 0;  ///< faulty minimal models, by `certify`
  int written = 0;  ///< faulty models as written, by System::certificate(model)
  int missed = 0;   ///< of these: at the few s that it tries they change less than it allows
};

/// The diagram's system with this minimal model in place of its own.
inline titop::System with_minimal_model(const titop::Diagram& d, titop::detail::DenseModel dense,
                                        const titop::StateSpace& minimal) {
  const auto data = titop::detail::compile_graph(d.graph(), {});
  dense.minimal.model = std::make_shared<const titop::StateSpace>(minimal);
  data->dense.get([&] { return dense; });
  return titop::System(data);
}

/// Certifies the diagram; then `tries` faults each in its minimal model, which takes its place in
/// the system, and in the model as written. Those that change the transfer must be found.
inline void check_faults(const titop::Diagram& d, std::uint64_t seed, int tries,
                         FaultCount& count) {
  const auto data = titop::detail::compile_graph(d.graph(), {});
  const titop::System system(data);
  const titop::FullCertificate right = certify(system);
  CAPTURE(to_string(right));
  CHECK(right.holds());
  ++count.right;
  const titop::StateSpace minimal = system.state_space();
  const titop::detail::DenseModel dense =
      data->dense.get([] { return titop::detail::DenseModel{}; });
  titop::StateSpace written;
  system.write(written);
  if (minimal.order() == 0 || minimal.D.size() == 0) return;
  Rng rng(seed);
  const auto changed = [&](const titop::StateSpace& model, const auto& faulty) {
    return faulty && change_of_transfer(model, faulty->model, right.grid.lowest,
                                        right.grid.highest) > kClearChange;
  };
  for (int k = 0; k < tries; ++k) {
    if (const auto faulty = with_fault(minimal, rng, /*dropping=*/true); changed(minimal, faulty)) {
      CAPTURE(faulty->fault);
      CHECK(!certify(with_minimal_model(d, dense, faulty->model)).holds());
      ++count.minimal;
    }
    if (const auto faulty = with_fault(written, rng, false); changed(written, faulty)) {
      CAPTURE(faulty->fault);
      const titop::Certificate c = system.certificate(faulty->model);
      count.missed += !(c.dense_against_factors > 1e-8 || c.dense_error > 3e-7);
      ++count.written;
    }
  }
}

}  // namespace titop_test
