// Bushings whose axes are coupled have M, D, K.
#include "scenes.hpp"
#include "scenes/isolated_wheel.hpp"

using namespace titop;
using namespace titop_test;
using namespace scenes_test;

TEST_CASE("a wheel on coupled bushings: M, D, K, against those by hand") {
  for (const bool two : {false, true})
    for (const bool damped : {false, true}) {
      CAPTURE(two);
      CAPTURE(damped);
      const IsolatedWheel scene{.two = two, .damped = damped};
      Diagram d{"isolated"};
      const auto b = scene.add(d);
      b.hub.parent.force = -d.input("F", 6);
      b.wheel.child("rim").force = d.input("R", 6);
      d.output("a", 6) = b.hub.parent.accel;
      d.output("r", 6) = b.wheel.child("rim").accel;
      const ReducedSystem r = compile(d, titop::Scene{.band_hz = {0.1, 200}, .accuracy = 1e-6});
      const SecondOrderModel m = r.second_order();
      CHECK(m.M.rows() == 6);
      std::vector<MatrixXcd> exact;
      const std::vector<Complex> s = points({3, 40, 100, 200, 400, 1000});
      for (const Complex z : s) exact.push_back(by_hand::accel_transfer(scene.by_hand(), z));
      CHECK(error_3(responses(m, s), exact) <= 1e-6);
    }
}
