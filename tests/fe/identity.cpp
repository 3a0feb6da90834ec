#include <doctest/doctest.h>

#include <titop/blocks/fe/beam.hpp>
#include <titop/blocks/fe/calculix.hpp>

#include "../../examples/by_hand/by_hand.hpp"
#include "dynamics.hpp"

/// (14) with all modes is the structure itself: compared with M and K solved directly.

using namespace titop;
using fe_test::Complex;

namespace {

/// Scale of frequencies: on the imaginary axis between the poles and off it.
std::vector<Complex> points(double omega) {
  return {{0, 0.37 * omega}, {0, 2.9 * omega},          {0.3 * omega, 1.0 * omega},
          {omega, 0.0},      {5.0 * omega, 40 * omega}, {100 * omega, 300 * omega}};
}

double worst(const ModalData& data, const fe::Mesh& mesh, const std::vector<std::string>& children,
             double beta) {
  std::vector<Eigen::MatrixXcd> modal, direct;
  for (const Complex s : points(data.omega(0))) {
    modal.push_back(fe_test::modal_transfer(data, s));
    direct.push_back(fe_test::direct_transfer<long double>(mesh, "P", children, s, beta));
  }
  return by_hand::transfer_error(modal, direct, 3, 3);
}

std::vector<double> proportional(const ModalData& data, double beta) {
  std::vector<double> xi;
  for (const double omega : data.omega) xi.push_back(beta * omega / 2);
  return xi;
}

}  // namespace

TEST_CASE("modal form of a beam is its M and K, undamped and with damping proportional to K") {
  const Beam beam{.length = 2.0,
                  .section = rectangle(0.06, 0.04),
                  .material = {.E = 70e9, .nu = 0.33, .rho = 2700},
                  .elements = 3};
  const fe::Mesh mesh = beam_mesh(beam);
  const std::vector<std::string> children = {"C", "1"};
  const ModalData data = fe::modal_data(mesh, "P", children);
  REQUIRE(data.omega.size() == 18);
  for (const double beta : {0.0, 1e-4}) {
    const ModalData damped = fe::modal_data(mesh, "P", children, {.xi = proportional(data, beta)});
    INFO("beta ", beta);
    CHECK(worst(damped, mesh, children, beta) <= 1e-12);
  }
}

TEST_CASE("modal form of the CalculiX beam is its M and K") {
  const fe::Mesh mesh =
      fe::read_calculix(fe::calculix_files(TITOP_DATA_DIR "/calculix_beam/beam_free_mat"),
                        {{"P", 900001}, {"C", 900003}});
  const ModalData data = fe::modal_data(mesh, "P", {"C"});
  REQUIRE(data.omega.size() == 342);
  // Rounding the entries of K to double moves the first omega by some 3e-11: 14-digit text moved it
  // by 3.5e-9.
  CHECK(worst(data, mesh, {"C"}, 0) <= 1e-9);
}

TEST_CASE("a dropped mode is seen") {
  const Beam beam{.length = 2.0,
                  .section = rectangle(0.06, 0.04),
                  .material = {.E = 70e9, .nu = 0.33, .rho = 2700},
                  .elements = 3,
                  .modes = {.kept = 17}};
  CHECK(worst(modal_data(beam), beam_mesh(beam), {"C"}, 0) > 1e-6);
}
