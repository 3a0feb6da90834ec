// The block ExactBeam: its response against the boundary value problem in 100 digits, in every
// precision, at rest, and refused data.
#include <doctest/doctest.h>

#include <titop/graph/closed_form.hpp>

#include "blocks/exact_beams.hpp"
#include "support/beam_by_hand.hpp"
#include "support/mistakes.hpp"

using namespace exact_beams;
using namespace titop;
using Eigen::Index;
using Eigen::MatrixXcd;
using titop_test::beam_by_hand;
using titop_test::error_of;
using titop_test::says;

namespace {

/// Largest difference of an entry over its own size in `exact`.
double entry_error(const MatrixXcd& Y, const MatrixXcd& exact) {
  double worst = 0;
  for (Index i = 0; i < Y.size(); ++i) {
    const double off = std::abs(Y(i) - exact(i));
    if (off > 0) worst = std::max(worst, off / std::abs(exact(i)));
  }
  return worst;
}

MatrixXcd block_at(const ExactBeam& b, Complex s) { return as_block(b)->response(s, {}).Y; }

}  // namespace

TEST_CASE("every entry against the boundary value problem in 100 digits, at any s") {
  const std::array<fe::Rayleigh, 4> laws = {fe::Rayleigh{}, fe::Rayleigh{.mass = 0.7},
                                            fe::Rayleigh{.stiffness = 3e-4},
                                            fe::Rayleigh{.mass = 2, .stiffness = 1e-3}};
  for (const fe::Rayleigh& law : laws)
    for (const double beta_L : {1e-3, 0.05, 0.6, 0.99, 1.01, 1.9, 3.3, 8.1, 21.0, 60.0})
      for (const double angle : {0.0, 0.3, 0.8, 1.3, 1.55, 1.8}) {
        const ExactBeam b = boom(law);
        const double w = omega_at(b, beta_L);
        const Complex s = std::polar(w, angle);
        INFO(law.mass << ' ' << law.stiffness << ' ' << beta_L << ' ' << angle);
        // The phases of circular functions have the rounding of beta L.
        CHECK(entry_error(block_at(b, s), beam_by_hand(b, s)) <= 1e-14 * (20 + 5 * beta_L));
      }
}

TEST_CASE("at s = 0 the beam is rigid; at -mass, beside it and far up it is finite") {
  const ExactBeam b = boom({.mass = 0.5, .stiffness = 1e-4});
  const MatrixXcd rest = block_at(b, 0);
  const ModalData beam = modal_data(with_elements(b, 4));
  CHECK(rest.topLeftCorner(6, 6).cwiseAbs().maxCoeff() == 0);
  CHECK((rest.topRightCorner(6, 6) - tau(Vector3d(-b.length, 0, 0))).cwiseAbs().maxCoeff() <=
        1e-15 * b.length);
  CHECK((rest.bottomRightCorner(6, 6) + beam.D_P).cwiseAbs().maxCoeff() <=
        1e-13 * beam.D_P.cwiseAbs().maxCoeff());
  const MatrixXcd removable = block_at(b, -0.5);
  CHECK((removable - block_at(b, Complex(-0.5, 1e-9))).cwiseAbs().maxCoeff() <=
        1e-8 * removable.cwiseAbs().maxCoeff());
  for (const double w : {1e6, 1e9, 1e12, 1e30})
    CHECK(block_at(boom(), Complex(0.01 * w, w)).allFinite());
  CHECK(says(error_of([&] { block_at(b, -1e4); }), Code::singular, {"ExactBeam"}));
  CHECK(says(error_of([&] { block_at(b, 1e200); }), Code::not_finite, {"1e+200"}));
}

TEST_CASE("16, 32 and 50 digits are one number") {
  const ExactBeam b = boom({.mass = 0.2, .stiffness = 2e-5});
  const BlockPtr block = as_block(b);
  const ClosedForm* closed = closed_form_of(*block);
  REQUIRE(closed != nullptr);
  for (const double beta_L : {0.3, 4.0, 30.0}) {
    const Complex s = std::polar(omega_at(b, beta_L), 1.5);
    const auto fine = closed->closed_form(s, {}, 4);
    REQUIRE(fine.size() == 4);
    CHECK(entry_error(closed->closed_form(s, {}, 1)[0], fine[0]) <= 1e-14 * (20 + 5 * beta_L));
    CHECK(closed->closed_form(s, {}, 2)[1] == fine[1]);
    CHECK(entry_error(fine[0], beam_by_hand(b, s)) <= 3e-16);
    for (std::size_t k = 1; k < fine.size(); ++k)
      CHECK((fine[k].cwiseAbs().array() <= 1e-15 * fine[k - 1].cwiseAbs().array()).all());
  }
}

TEST_CASE("data that make no beam are refused") {
  const auto refused = [](const ExactBeam& b, std::string_view name) {
    return says(error_of([&] { as_block(b); }), Code::bad_value, {name});
  };
  ExactBeam b = boom();
  b.length = -1;
  CHECK(refused(b, "length"));
  CHECK(refused(boom({.mass = -1}), "damping.mass"));
  CHECK(refused(boom({.stiffness = NAN}), "damping.stiffness"));
}
