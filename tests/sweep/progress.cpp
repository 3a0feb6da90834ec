#include <doctest/doctest.h>

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <thread>
#include <titop/titop.hpp>

#include "support/names.hpp"

/// The line that `progress_line` draws, in a file. Seconds are not asserted.

using namespace titop;

namespace {

struct File {
  std::FILE* file = std::tmpfile();
  File() { REQUIRE(file); }
  ~File() { std::fclose(file); }
  File(const File&) = delete;
  File& operator=(const File&) = delete;

  std::string text() const {
    std::string all;
    std::rewind(file);
    for (int c = std::fgetc(file); c != EOF; c = std::fgetc(file)) all += static_cast<char>(c);
    return all;
  }
};

auto count(const std::string& text, char c) { return std::count(text.begin(), text.end(), c); }

}  // namespace

TEST_CASE("progress_line: the last state stands there, with its newline") {
  const File to;
  const auto show = progress_line(to.file, DrawLine::always);
  for (std::size_t done = 1; done <= 1000; ++done) show(done, 1000);
  const std::string text = to.text();
  CHECK(titop_test::has_names(text.substr(text.rfind('\r')), {"1000", "100 %"}));
  CHECK(text.back() == '\n');
  CHECK(count(text, '\n') == 1);
  CHECK(count(text, '\r') <= 100);  // most came too soon after the one before
}

TEST_CASE("progress_line: states between are drawn over each other, not too often") {
  const File to;
  const auto show = progress_line(to.file, DrawLine::always);
  show(1, 4);  // too soon
  std::this_thread::sleep_for(std::chrono::milliseconds(250));
  show(2, 4);
  show(3, 4);  // too soon, unless the machine sleeps
  show(4, 4);
  const std::string text = to.text();
  CHECK(titop_test::has_names(text.substr(0, text.find('\r', 1)), {"2", "4", "50 %"}));
  CHECK(titop_test::has_names(text.substr(text.rfind('\r')), {"4", "100 %"}));
  CHECK(count(text, '\r') >= 2);
  CHECK(count(text, '\n') == 1);
  // The last line hides all of the one before.
  const std::size_t last = text.rfind('\r'), before = text.rfind('\r', last - 1);
  CHECK(text.size() - 1 - last >= last - before);
}

TEST_CASE("progress_line: a file is no terminal, and stays empty") {
  const File to;
  const auto show = progress_line(to.file);
  show(1, 1);
  CHECK(to.text().empty());
}

TEST_CASE("progress_line: a sweep calls it on its threads") {
  Diagram d{"one"};
  auto u = d.input("u");
  auto z = d.add("z", SpringMass{.mass = d.param("m", 1.0), .stiffness = 100.0});
  ground(z);
  z.child.force = u;
  d.output("x") = z.stretch;
  const System system = compile(d);
  const std::vector<ParameterList> points(64, {{"m", 2.0}});
  const File to;
  sweep(system, points, [](std::size_t, const System&) {},
        {.threads = 4, .progress = progress_line(to.file, DrawLine::always)});
  const std::string text = to.text();
  CHECK(titop_test::has_names(text.substr(text.rfind('\r')), {"64", "100 %"}));
}

TEST_CASE("progress_line: a simulation calls it after each step") {
  Diagram d{"mass"};
  auto u = d.input("u");
  auto z = d.add("z", SpringMass{.mass = 1, .stiffness = 4});
  ground(z);
  z.child.force = u;
  d.output("x") = z.stretch;
  std::vector<std::size_t> seen;
  const File to;
  const auto line = progress_line(to.file, DrawLine::always, "steps");
  const auto show = [&](std::size_t done, std::size_t all) {
    CHECK(all == 50);
    seen.push_back(done), line(done, all);
  };
  simulate(compile(d), Excitation::none(), {.step = 0.1, .until = 5, .progress = show});
  REQUIRE(seen.size() == 50);
  CHECK((seen.front() == 1 && seen.back() == 50));
  CHECK(to.text().find("50 of 50 steps, 100 %") != std::string::npos);
}
