// Broken diagram files: each is refused with its place in the text, the text found and the text
// expected.
#include <doctest/doctest.h>

#include <titop/blocks/diagram_file/diagram_file.hpp>
#include <titop/titop.hpp>

#include "support/refused.hpp"

using namespace titop;
using titop_test::replaced;

namespace {

const std::string kGood = R"({"format": "titop scene 1", "name": "cart",
"parameters": [{"name": "k", "value": 10}], "bodies": {},
"blocks": [{"name": "z", "type": "SpringMass", "mass": 1, "stiffness": {"parameter": "k", "scale": 2},
            "damping": 0, "parent_mass": 0.5},
           {"name": "K", "type": "Lti", "A": [[-1]], "B": [[1]], "C": [[1]], "D": [[0]]}],
"inputs": [{"name": "u", "size": 1}],
"equations": [{"of": ["z", "parent", "force"], "terms": [{"signal": ["u"], "sign": -1}]},
              {"of": ["z", "child", "force"], "add": true,
               "terms": [{"signal": ["K", "out"], "factors": [0.25]}]},
              {"of": ["K", "in"], "terms": [{"signal": ["z", "stretch"]}]}],
"outputs": [{"name": "a", "size": 1, "terms": [{"signal": ["z", "parent", "accel"]}]}]})";

void refused(const std::string& subject, const std::string& with, const std::string& words) {
  titop_test::check_refused([&] { parse_diagram(replaced(kGood, subject, with), "cart.json"); },
                            words);
}

}  // namespace

TEST_CASE("a scene typed by hand") {
  const System system = compile(parse_diagram(kGood));
  CHECK(system.order() == 3);
  // Two masses, 1 and 0.5, on a spring of 20; the filter pushes by a quarter of the stretch.
  const std::complex<double> s{0.3, 2};
  const auto K = 0.25 / (s + 1.0);
  // m s^2 x = K d - 20 d, m0 s^2 p = u + 20 d, d = x - p
  const auto d = -2.0 / (s * s - K + 20.0 + 40.0);
  const auto expected = 2.0 * (1.0 + 20.0 * d);
  CHECK(std::abs(system.transfer(s)(0, 0) - expected) <= 1e-14 * std::abs(expected));
}

TEST_CASE("broken scenes are refused with their place") {
  refused("\"format\"", "format", "cart.json: no JSON text at byte");
  refused("titop scene 1", "titop scene 9", "cart.json: format: found \"titop scene 9\", expected");
  refused("\"mass\": 1", "\"mass\": \"1\"",
          "cart.json: blocks[0].mass: found \"1\", expected a number");
  refused("\"mass\": 1,", "", "blocks[0]: found {\"name\":\"z\"");
  refused("\"damping\"", "\"dampening\"", "expected no \"dampening\" among");
  refused("\"parent_mass\": 0.5", "\"parent_mass\": 0.5, \"x\": 1",
          "expected no \"x\" among name, type");
  refused("SpringMass", "SpringMess",
          "blocks[0].type: found \"SpringMess\", expected one of SpringMass");
  refused("\"parameter\": \"k\"", "\"parameter\": \"q\"",
          "blocks[0].stiffness.parameter: found \"q\"");
  refused("\"name\": \"K\"", "\"name\": \"z\"",
          "blocks[1].name: found \"z\", expected a name that no");
  refused("[[-1]]", "[[-1, 2]]", "blocks[1].A[0]: found [-1,2], expected a list of 1 numbers");
  refused("[\"u\"]", "[\"w\"]",
          "equations[0].terms[0].signal[0]: found \"w\", expected the name of an");
  refused("[\"z\", \"parent\", \"force\"]", "[\"z\", \"parent\", \"speed\"]",
          "equations[0].of[2]: found \"speed\", expected accel or force");
  refused("[\"z\", \"parent\", \"force\"]", "[\"z\", \"uncle\", \"force\"]",
          "equations[0].of[1]: found \"uncle\", expected a channel of z");
  refused("[\"K\", \"in\"]", "[\"K\", \"inn\"]", "equations[2].of[1]: found \"inn\"");
  refused("[\"K\", \"in\"]", "[\"K\", \"out\"]", "expected a signal that can be driven");
  refused("[\"K\", \"in\"]", "[]", "equations[2].of: found []");
  refused("\"size\": 1}]", "\"size\": 1.5}]", "inputs[0].size: found 1.5, expected an integer");
  refused("\"sign\": -1", "\"read\": \"rate\"", "only channels have reactions");
  refused("[0.25]", "[[1]]", "equations[1].terms[0].factors[0]: found [1], expected a number or");
}

TEST_CASE("data that a reader would ignore silently are refused with their place") {
  for (const char* sign : {"0", "-3", "0.5"})
    refused("\"sign\": -1", std::string("\"sign\": ") + sign, "equations[0].terms[0].sign: found ");
  refused("\"mass\": 1", "\"mass\": 800, \"mass\": 9",
          "error[bad-file]: cart.json: blocks[0].mass: the key is given twice");
  refused("{\"of\": [\"K\"", "{\"terms\": [], \"of\": [\"K\"",
          "cart.json: equations[2].terms: the key is given twice");
  refused("\"bodies\": {}", "\"bodies\": {\"a\": [[], [0, {\"b\": 1, \"b\": 2}]]}",
          "cart.json: bodies.a[1][1].b: the key is given twice");
  refused("\"size\": 1}]", "\"size\": 0}]", "inputs[0].size: found 0, expected a size of 1");
  const auto child = [](const std::string& more) {
    return R"("blocks": [{"name": "A", "type": "RigidBody", "mass": 1, "PA": [0, 0, 0],
      "inertia": [[1, 0, 0], [0, 1, 0], [0, 0, 1]],
      "children": [{"name": "C", "PC": [1, 0, 0])" +
           more + "}]}, ";
  };
  parse_diagram(replaced(kGood, "\"blocks\": [", child("")));
  refused("\"blocks\": [", child(", \"CP\": [0, 0, 0]"), "blocks[0].children[0]: found");
  refused("\"blocks\": [", R"("blocks": [{"name": "J", "type": "Joint", "axes":
      [{"kind": "about", "direction": [0, 0, 1], "name": "", "angle": 1}]}, )",
          "expected no \"angle\" among kind, direction, name");
}

TEST_CASE("mistakes of a scene's equations are told with their place in the file") {
  const auto said = [](const std::string& subject, const std::string& with) {
    return titop_test::message_of([&] { compile(parse_diagram(replaced(kGood, subject, with))); });
  };
  const std::string text = said("[\"K\", \"in\"]", "[\"z\", \"child\", \"accel\"]");
  INFO(text);
  CHECK(text.find("equations[2] of the diagram file") != std::string::npos);
  CHECK(text.find("K was added at blocks[1] of the diagram file") != std::string::npos);
  CHECK(text.find(".cpp") == std::string::npos);
  CHECK(said(", \"terms\": [{\"signal\": [\"z\", \"parent\", \"accel\"]}]}", "}")
            .find("outputs[0] of the diagram file") != std::string::npos);
}

TEST_CASE("parts of a signal are orthonormal rows") {
  const std::string guide = R"({"format": "titop scene 1", "name": "guide", "parameters": [],
"bodies": {}, "blocks": [{"name": "g", "type": "Gain", "gain": 1, "size": 1}],
"inputs": [{"name": "u", "size": 2}],
"equations": [{"of": ["g", "in"], "terms": [{"signal": ["u"], "factors": [
  {"part": "along", "rows": [[0.6, 0.8]]}]}]}],
"outputs": [{"name": "a", "size": 1, "terms": [{"signal": ["g", "out"]}]}]})";
  const Eigen::MatrixXcd one = compile(parse_diagram(guide)).transfer(1.0);
  CHECK(std::abs(one(0, 0) - 0.6) + std::abs(one(0, 1) - 0.8) <= 1e-15);
  for (const char* rows : {"[[3, 4]]", "[]", "[[0.6, 0.8], [0.6, 0.8]]", "[[1e-3, 0]]"})
    titop_test::check_refused(
        [&] { parse_diagram(replaced(guide, "[[0.6, 0.8]]", rows), "guide.json"); },
        "expected orthonormal rows, at least one");
}

TEST_CASE("plausible mistakes of a program that writes diagram files") {
  refused("\"damping\": 0", "\"damping\": 1e999", "cart.json: a number is too large for a double");
  refused("{\"name\": \"u\", \"size\": 1}", "{\"name\": \"u\", \"size\": 5000}",
          "inputs[0].size: found 5000, expected a size up to 4096");
  const std::string deep = std::string(5000, '[') + std::string(5000, ']');
  refused("\"damping\": 0", "\"damping\": " + deep,
          "blocks[0].damping: found lists too deep to print, expected a number or");
}

TEST_CASE("values of modes and entries of an inertia are refused with their place") {
  const std::string body =
      R"("bodies": {"wing": {"omega": [2], "xi": [0], "L_P": [[1, 0, 0, 0, 0, 0]], "digits": 15,
      "D_P": [[2, 0, 0, 0, 0, 0], [0, 2, 0, 0, 0, 0], [0, 0, 2, 0, 0, 0], [0, 0, 0, 1, 0, 0],
              [0, 0, 0, 0, 1, 0], [0, 0, 0, 0, 0, 1]], "children": []}})";
  const auto with = [&](const std::string& block, const std::string& words) {
    const std::string file = replaced(replaced(kGood, "\"bodies\": {}", body), "\"blocks\": [",
                                      "\"blocks\": [{\"name\": \"A\", " + block + "}, ");
    if (words.empty())
      CHECK_NOTHROW(parse_diagram(file, "cart.json"));
    else
      titop_test::check_refused([&] { parse_diagram(file, "cart.json"); }, words);
  };
  const auto wing = [&](const std::string& values, const std::string& words) {
    with(R"("type": "FlexibleBody", "body": "wing", )" + values, words);
  };
  wing(R"("omega": [{"mode": 1, "value": {"parameter": "k"}}])", "");
  wing(R"("omega": [{"mode": 1, "value": -2}])", "blocks[0], A: mode 1 has omega -2");
  wing(R"("xi": [{"mode": 2, "value": 0}])", "blocks[0], A: a value is given for mode 2 of 1");
  wing(R"("xi": [{"mode": 1, "value": {"parameter": "q"}}])",
       "blocks[0].xi[0].value.parameter: found \"q\"");
  wing(R"("xi": [{"mode": 1, "value": 0}, {"mode": 1, "value": 0}])",
       "blocks[0].xi[1].mode: found 1, expected a mode that no value before");
  wing(R"("xi": [0.1])", "blocks[0].xi[0]: found 0.1, expected an object");
  const auto rigid = [&](const std::string& inertia, const std::string& words) {
    with(
        R"("type": "RigidBody", "mass": 1, "PA": [0, 0, 0], "children": [], "inertia": )" + inertia,
        words);
  };
  rigid(R"([1, 1, {"parameter": "k", "scale": 0.1}, 0, 0, 0])", "");
  rigid(R"([1, 1, {"parameter": "k"}, 0, 0, 0])", "A: principal moments 1, 1 and 10");
  rigid("[1, 2]", "blocks[0].inertia: found [1,2], expected three rows, or the six");
  rigid("[1, 1, 1]", "blocks[0].inertia[0]: found 1, expected a list of 3 numbers");
}

TEST_CASE("numbers that make no block are refused with the block's name") {
  refused("\"mass\": 1", "\"mass\": -1", "cart.json: blocks[0], z: SpringMass has mass -1");
  const std::string body =
      R"("bodies": {"wing": {"omega": [2], "xi": [0], "L_P": [[9, 0, 0, 0, 0, 0]], "digits": 15,
      "D_P": [[1, 0, 0, 0, 0, 0], [0, 1, 0, 0, 0, 0], [0, 0, 1, 0, 0, 0], [0, 0, 0, 1, 0, 0],
              [0, 0, 0, 0, 1, 0], [0, 0, 0, 0, 0, 1]], "children": []}})";
  refused("\"bodies\": {}", body, "cart.json: bodies.wing, wing: the modes carry more mass");
  refused("\"bodies\": {}", replaced(body, "\"digits\": 15", "\"digits\": 0"),
          "error[bad-value]: cart.json: bodies.wing, wing: the modal data have 0 digits");
  try {
    parse_diagram(replaced(kGood, "\"mass\": 1", "\"mass\": -1"));
    FAIL("not refused");
  } catch (const Error& error) {
    CHECK(error.has(Code::bad_inertia));
  }
  // Mistakes of the equations come out in compile, as for a diagram in C++.
  const Diagram d =
      parse_diagram(replaced(kGood, "[\"K\", \"in\"]", "[\"z\", \"child\", \"accel\"]"));
  CHECK_THROWS_AS(compile(d), Error);
}
