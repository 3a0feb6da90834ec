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

void refused(const std::string& subject, const std::string& with,
             std::initializer_list<std::string_view> names, Code code = Code::bad_file) {
  titop_test::check_refused([&] { parse_diagram(replaced(kGood, subject, with), "cart.json"); },
                            code, names);
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
  refused("\"format\"", "format", {"cart.json", "byte"});
  refused("titop scene 1", "titop scene 9",
          {"cart.json", "format", "\"titop scene 9\"", "\"titop scene 1\""});
  refused("\"mass\": 1", "\"mass\": \"1\"", {"cart.json", "blocks[0].mass", "\"1\""});
  refused("\"mass\": 1,", "", {"blocks[0]", "\"mass\""});
  refused("\"damping\"", "\"dampening\"", {"blocks[0]", "\"dampening\"", "name, type"});
  refused("\"parent_mass\": 0.5", "\"parent_mass\": 0.5, \"x\": 1",
          {"blocks[0]", "\"x\"", "name, type"});
  refused("SpringMass", "SpringMess", {"blocks[0].type", "\"SpringMess\"", "SpringMass"});
  refused("\"parameter\": \"k\"", "\"parameter\": \"q\"",
          {"blocks[0].stiffness.parameter", "\"q\""});
  refused("\"name\": \"K\"", "\"name\": \"z\"", {"blocks[1].name", "\"z\""});
  refused("[[-1]]", "[[-1, 2]]", {"blocks[1].A[0]", "[-1,2]", "1"});
  refused("[\"u\"]", "[\"w\"]", {"equations[0].terms[0].signal[0]", "\"w\""});
  refused("[\"z\", \"parent\", \"force\"]", "[\"z\", \"parent\", \"speed\"]",
          {"equations[0].of[2]", "\"speed\"", "accel", "force"});
  refused("[\"z\", \"parent\", \"force\"]", "[\"z\", \"uncle\", \"force\"]",
          {"equations[0].of[1]", "\"uncle\"", "z"});
  refused("[\"K\", \"in\"]", "[\"K\", \"inn\"]", {"equations[2].of[1]", "\"inn\""});
  refused("[\"K\", \"in\"]", "[\"K\", \"out\"]", {"equations[2].of", "[\"K\",\"out\"]"});
  refused("[\"K\", \"in\"]", "[]", {"equations[2].of", "[]"});
  refused("\"size\": 1}]", "\"size\": 1.5}]", {"inputs[0].size", "1.5"});
  refused("\"sign\": -1", "\"read\": \"rate\"", {"equations[0].terms[0].read", "\"rate\""});
  refused("[0.25]", "[[1]]", {"equations[1].terms[0].factors[0]", "[1]"});
}

TEST_CASE("data that a reader would ignore silently are refused with their place") {
  for (const char* sign : {"0", "-3", "0.5"})
    refused("\"sign\": -1", std::string("\"sign\": ") + sign, {"equations[0].terms[0].sign", sign});
  refused("\"mass\": 1", "\"mass\": 800, \"mass\": 9", {"cart.json", "blocks[0].mass"});
  refused("{\"of\": [\"K\"", "{\"terms\": [], \"of\": [\"K\"", {"cart.json", "equations[2].terms"});
  refused("\"bodies\": {}", "\"bodies\": {\"a\": [[], [0, {\"b\": 1, \"b\": 2}]]}",
          {"cart.json", "bodies.a[1][1].b"});
  refused("\"size\": 1}]", "\"size\": 0}]", {"inputs[0].size", "0", "1"});
  const auto child = [](const std::string& more) {
    return R"("blocks": [{"name": "A", "type": "RigidBody", "mass": 1, "PA": [0, 0, 0],
      "inertia": [[1, 0, 0], [0, 1, 0], [0, 0, 1]],
      "children": [{"name": "C", "PC": [1, 0, 0])" +
           more + "}]}, ";
  };
  parse_diagram(replaced(kGood, "\"blocks\": [", child("")));
  refused("\"blocks\": [", child(", \"CP\": [0, 0, 0]"),
          {"blocks[0].children[0]", "\"CP\"", "name"});
  refused("\"blocks\": [", R"("blocks": [{"name": "J", "type": "Joint", "axes":
      [{"kind": "about", "direction": [0, 0, 1], "name": "", "angle": 1}]}, )",
          {"blocks[0].axes[0]", "\"angle\"", "kind, direction, name"});
  const auto joint = [](const std::string& type, const std::string& kind, const std::string& name) {
    return R"("blocks": [{"name": "J", "type": ")" + type + R"(", "axes": [{"kind": ")" + kind +
           R"(", "direction": [0, 0, 1], "name": ")" + name + R"("}]}, )";
  };
  refused("\"blocks\": [", joint("Hinge", "along", ""), {"blocks[0].axes[0].kind", "about"});
  refused("\"blocks\": [", joint("Slide", "about", ""), {"blocks[0].axes[0].kind", "along"});
  refused("\"blocks\": [", joint("Hinge", "about", "x"), {"blocks[0].axes[0].name", "\"x\""});
  parse_diagram(replaced(kGood, "\"blocks\": [", joint("Slide", "along", "")));
  const std::string accel = R"({"signal": ["z", "parent", "accel"])";
  refused(accel, accel + R"(, "read": "reaction")", {"outputs[0].terms[0].read", "force"});
  refused("{\"signal\": [\"z\", \"stretch\"]",
          R"({"signal": ["z", "parent", "force"], "read": "rate")",
          {"equations[2].terms[0].read", "acceleration"});
}

TEST_CASE("mistakes of a scene's equations are told with their place in the file") {
  const auto said = [](const std::string& subject, const std::string& with) {
    return titop_test::message_of([&] { compile(parse_diagram(replaced(kGood, subject, with))); });
  };
  const std::string text = said("[\"K\", \"in\"]", "[\"z\", \"child\", \"accel\"]");
  INFO(text);
  CHECK(text.find("equations[2]") != std::string::npos);
  CHECK(text.find("blocks[1]") != std::string::npos);
  CHECK(text.find(".cpp") == std::string::npos);
  CHECK(said(", \"terms\": [{\"signal\": [\"z\", \"parent\", \"accel\"]}]}", "}")
            .find("outputs[0]") != std::string::npos);
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
        [&] { parse_diagram(replaced(guide, "[[0.6, 0.8]]", rows), "guide.json"); }, Code::bad_file,
        {"guide.json", "equations[0].terms[0].factors[0].rows"});
}

TEST_CASE("plausible mistakes of a program that writes diagram files") {
  refused("\"damping\": 0", "\"damping\": 1e999", {"cart.json", "308"});
  refused("{\"name\": \"u\", \"size\": 1}", "{\"name\": \"u\", \"size\": 5000}",
          {"inputs[0].size", "5000", "4096"});
  const std::string deep = std::string(5000, '[') + std::string(5000, ']');
  refused("\"damping\": 0", "\"damping\": " + deep, {"blocks[0].damping"});
}

TEST_CASE("values of modes and entries of an inertia are refused with their place") {
  const std::string body =
      R"("bodies": {"wing": {"omega": [2], "xi": [0], "L_P": [[1, 0, 0, 0, 0, 0]], "digits": 15,
      "D_P": [[2, 0, 0, 0, 0, 0], [0, 2, 0, 0, 0, 0], [0, 0, 2, 0, 0, 0], [0, 0, 0, 1, 0, 0],
              [0, 0, 0, 0, 1, 0], [0, 0, 0, 0, 0, 1]], "children": []}})";
  using Names = std::initializer_list<std::string_view>;
  const auto with = [&](const std::string& block, Names names, Code code) {
    const std::string file = replaced(replaced(kGood, "\"bodies\": {}", body), "\"blocks\": [",
                                      "\"blocks\": [{\"name\": \"A\", " + block + "}, ");
    if (names.size() == 0)
      CHECK_NOTHROW(parse_diagram(file, "cart.json"));
    else
      titop_test::check_refused([&] { parse_diagram(file, "cart.json"); }, code, names);
  };
  const auto wing = [&](const std::string& values, Names names, Code code = Code::bad_file) {
    with(R"("type": "FlexibleBody", "body": "wing", )" + values, names, code);
  };
  wing(R"("omega": [{"mode": 1, "value": {"parameter": "k"}}])", {});
  wing(R"("omega": [{"mode": 1, "value": -2}])", {"blocks[0]", "A", "mode 1", "omega -2"},
       Code::bad_modes);
  wing(R"("xi": [{"mode": 2, "value": 0}])", {"blocks[0]", "A", "mode 2", "1"}, Code::bad_modes);
  wing(R"("xi": [{"mode": 1, "value": {"parameter": "q"}}])",
       {"blocks[0].xi[0].value.parameter", "\"q\""});
  wing(R"("xi": [{"mode": 1, "value": 0}, {"mode": 1, "value": 0}])",
       {"blocks[0].xi[1].mode", "1"});
  wing(R"("xi": [0.1])", {"blocks[0].xi[0]", "0.1"});
  const auto rigid = [&](const std::string& inertia, Names names, Code code = Code::bad_file) {
    with(
        R"("type": "RigidBody", "mass": 1, "PA": [0, 0, 0], "children": [], "inertia": )" + inertia,
        names, code);
  };
  rigid(R"([1, 1, {"parameter": "k", "scale": 0.1}, 0, 0, 0])", {});
  rigid(R"([1, 1, {"parameter": "k"}, 0, 0, 0])", {"blocks[0]", "A", "1", "10"}, Code::bad_inertia);
  rigid("[1, 2]", {"blocks[0].inertia", "[1,2]", "xx, yy, zz, xy, xz, yz"});
  rigid("[1, 1, 1]", {"blocks[0].inertia[0]", "1", "3"});
}

TEST_CASE("parameters of a matrix of six axes are the same on both sides of its diagonal") {
  // The stiffness with these values at (1, 2) and (2, 1), counted from 1.
  const auto with = [](const std::string& upper, const std::string& lower) {
    return replaced(kGood, "\"blocks\": [",
                    R"("blocks": [{"name": "b", "type": "Bushing", "damping": [0, 0, 0, 0, 0, 0],
      "stiffness": [[50, )" +
                        upper + ", 0, 0, 0, 0], [" + lower + R"(, 50, 0, 0, 0, 0],
      [0, 0, 1, 0, 0, 0], [0, 0, 0, 1, 0, 0], [0, 0, 0, 0, 1, 0], [0, 0, 0, 0, 0, 1]]}, )");
  };
  const std::string k = R"({"parameter": "k"})", twice = R"({"parameter": "k", "scale": 2})";
  CHECK_NOTHROW(parse_diagram(with(k, k)));
  CHECK_NOTHROW(parse_diagram(with(twice, twice)));
  for (const auto& [upper, lower] :
       {std::pair<std::string, std::string>{"10", k}, {k, "10"}, {k, twice}, {"0", k}, {k, "0"}})
    titop_test::check_refused([&] { parse_diagram(with(upper, lower), "cart.json"); },
                              Code::bad_file,
                              {"cart.json", "blocks[0].stiffness[1][0]", "row 1, column 2"});
}

TEST_CASE("numbers that make no block are refused with the block's name") {
  refused("\"mass\": 1", "\"mass\": -1", {"cart.json", "blocks[0]", "z", "SpringMass", "mass -1"},
          Code::bad_inertia);
  const std::string body =
      R"("bodies": {"wing": {"omega": [2], "xi": [0], "L_P": [[9, 0, 0, 0, 0, 0]], "digits": 15,
      "D_P": [[1, 0, 0, 0, 0, 0], [0, 1, 0, 0, 0, 0], [0, 0, 1, 0, 0, 0], [0, 0, 0, 1, 0, 0],
              [0, 0, 0, 0, 1, 0], [0, 0, 0, 0, 0, 1]], "children": []}})";
  refused("\"bodies\": {}", body, {"cart.json", "bodies.wing", "wing", "D_P - L_P' L_P"},
          Code::bad_modes);
  refused("\"bodies\": {}", replaced(body, "\"digits\": 15", "\"digits\": 0"),
          {"cart.json", "bodies.wing", "wing", "0", "digits"}, Code::bad_value);
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

TEST_CASE("a momentum or a spin of a body in a file is refused, and its equations are named") {
  const std::string rigid = R"("mass": 1, "inertia": [1, 1, 1, 0, 0, 0], "PA": [0, 0, 0])",
                    rotor = R"("mass": 1, "axial": 1, "transverse": 1, "axis": [0, 0, 1],
                               "PA": [0, 0, 0])",
                    wing = R"("body": "wing")";
  const std::vector<std::pair<std::string, std::string>> blocks = {
      {"RigidBody", rigid + R"(, "children": [])"}, {"Rotor", rotor}, {"FlexibleBody", wing}};
  for (const auto& [type, members] : blocks) {
    CAPTURE(type);
    const std::string block = R"("blocks": [{"name": "b", "type": ")" + type + "\", " + members;
    refused("\"blocks\": [", block + ", \"momentum\": 40}, ",
            {"cart.json", "blocks[0].momentum", "40", "momentum(port, h, a)"});
    const std::string why = type == "Rotor" ? "spin" : "periodic in time";
    refused("\"blocks\": [", block + ", \"spin\": 40}, ", {"cart.json", "blocks[0]", why});
  }
}
