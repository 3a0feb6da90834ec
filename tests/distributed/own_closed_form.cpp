// An own block in closed form: transfers take it, and what needs matrices refuses it.
#include <doctest/doctest.h>

#include <cmath>
#include <titop/compiler/definition/exact_order.hpp>
#include <titop/graph/closed_form.hpp>
#include <titop/titop.hpp>

#include "support/mistakes.hpp"

using namespace titop;
using Eigen::MatrixXcd;
using Eigen::MatrixXd;
using titop_test::error_of;
using titop_test::says;
using Complex = std::complex<double>;

namespace {

/// out = in, `delay` seconds before.
struct Delay {
  Value delay = 1;
  using Handle = Lti::Handle;
};

class DelayBlock : public Block, public ClosedForm {
 public:
  explicit DelayBlock(Value delay) : delay_(delay) {
    face_.inputs = {{"in", 1}};
    face_.outputs = {{"out", 1}};
  }
  std::string_view type() const override { return "Delay"; }
  const Interface& interface() const override { return face_; }
  std::shared_ptr<const Dynamics> dynamics(ParameterValues values) const override {
    return std::make_shared<Dynamics>(Dynamics{MatrixXd(0, 0), MatrixXd(0, 1), MatrixXd(1, 0),
                                               closed_form(1, values, 1).front().real()});
  }
  Response response(Complex s, ParameterValues values) const override {
    return {MatrixXcd(0, 1), closed_form(s, values, 1).front()};
  }
  std::vector<MatrixXcd> closed_form(Complex s, ParameterValues values,
                                     int doubles) const override {
    std::vector<MatrixXcd> parts(static_cast<std::size_t>(doubles), MatrixXcd::Zero(1, 1));
    parts.front()(0, 0) = std::exp(-s * delay_.at(values));
    return parts;
  }
  Kinematics undeformed() const override { return {}; }
  Cause no_state_space() const override { return {"is a delay", "put a pade() in its place"}; }
  std::vector<Value> values() const override { return {delay_}; }
  bool has_frame() const override { return false; }

 private:
  Interface face_;
  Value delay_;
};

BlockPtr as_block(const Delay& spec) { return std::make_shared<DelayBlock>(spec.delay); }

Diagram loop_of_delay() {
  Diagram d{"delayed"};
  const Param tau = d.param("tau", 0.2);
  auto delay = d.add("delay", Delay{tau});
  delay.in = d.input("u") - 0.5 * delay.out;
  d.output("y") = delay.out;
  return d;
}

}  // namespace

TEST_CASE("an own block in closed form: the transfer of a delay in a loop") {
  const System system = compile(loop_of_delay());
  for (const Complex s : {Complex(0.1, 3), Complex(0, 40), Complex(2, 0)}) {
    const Complex e = std::exp(-0.2 * s), want = e / (1.0 + 0.5 * e);
    CHECK(std::abs(system.transfer(s)(0, 0) - want) <= 1e-14 * std::abs(want));
  }
}

TEST_CASE("matrices of a block in closed form are never taken for its transfer: refused by name") {
  const Diagram d = loop_of_delay();
  CHECK(says(error_of([&] { derivatives(compile(d), {"tau"}); }), Code::not_rational, {"delay"}));
  CHECK(says(error_of([&] { exact_order(d.graph()); }), Code::not_rational, {"delay", "pade"}));
  CHECK(says(error_of([&] { compile(d).state_space(); }), Code::not_rational, {"delay"}));
}
