// The full certificate as JSON: every number is the struct's, values that were not checked are
// null.
#include <doctest/doctest.h>

#include <cmath>
#include <nlohmann/json.hpp>
#include <titop/titop.hpp>

#include "support/five_masses.hpp"
#include "support/folder.hpp"
#include "support/names.hpp"

using namespace titop;
using Json = nlohmann::json;

namespace {

Json parsed(const FullCertificate& c) { return Json::parse(certificate_json(c)); }

void check_number(const Json& item, bool known, double value) {
  CHECK(item.is_null() == !(known && std::isfinite(value)));
  if (!item.is_null()) CHECK(item.get<double>() == value);
}

void check_complex(const Json& item, bool known, std::complex<double> value) {
  CHECK(item.is_null() == !known);
  if (item.is_null()) return;
  REQUIRE(item.size() == 2);
  CHECK(item[0].get<double>() == value.real());
  CHECK(item[1].get<double>() == value.imag());
}

void check_item(const Json& item, const Checked& c) {
  CHECK(item.at("done").get<bool>() == c.done);
  CHECK(item.at("why_not").is_null() == c.done);
  if (!c.done) CHECK(item.at("why_not").get<std::string>() == c.why_not);
}

void check_grid(const Json& item, const FullCertificate::Grid& g) {
  check_item(item, g);
  CHECK(item.at("points") == g.points);
  check_number(item.at("lowest"), g.points > 0, g.lowest);
  check_number(item.at("highest"), g.points > 0, g.highest);
  check_number(item.at("dense"), g.done, g.dense);
  check_complex(item.at("dense_s"), g.done, g.dense_s);
  check_number(item.at("written"), g.written >= 0, g.written);
  check_complex(item.at("written_s"), g.written >= 0, g.written_s);
}

void check_poles(const Json& item, const FullCertificate::Poles& p) {
  check_item(item, p);
  check_number(item.at("count"), p.done, p.count);
  check_number(item.at("measured"), p.done, p.measured);
  check_number(item.at("error"), p.done && p.measured > 0, p.error);
  check_complex(item.at("where"), p.done && p.measured > 0, p.where);
  check_number(item.at("right"), p.done, p.right);
  check_number(item.at("hidden"), p.done, p.hidden);
  check_complex(item.at("rightmost"), p.done && p.count > 0, p.rightmost);
}

void check_pairs(const Json& all, const FullCertificate& c) {
  const Json &p = all.at("passivity"), &r = all.at("reciprocity");
  check_item(p, c.passivity);
  check_item(r, c.reciprocity);
  CHECK(p.at("pairs") == c.passivity.pairs);
  check_number(p.at("least"), c.passivity.done, c.passivity.least);
  check_complex(p.at("where"), c.passivity.done, c.passivity.where);
  CHECK(p.at("structure").is_null() == !c.passivity.done);
  const bool off = c.reciprocity.asymmetry > 0;
  CHECK(r.at("forces") == c.reciprocity.forces);
  check_number(r.at("asymmetry"), c.reciprocity.done, c.reciprocity.asymmetry);
  check_complex(r.at("where"), off, c.reciprocity.where);
  for (const auto& [key, name] :
       {std::pair("first", c.reciprocity.first), std::pair("second", c.reciprocity.second)}) {
    CHECK(r.at(key).is_null() == !off);
    if (off) CHECK(r.at(key).get<std::string>() == name);
  }
  CHECK(r.at("structure").is_null() == !c.reciprocity.done);
  if (!c.reciprocity.done) return;
  CHECK(p.at("structure") == c.passivity.structure);
  CHECK(r.at("structure") == c.reciprocity.structure);
  CHECK(r.at("why_no_structure").is_null() == c.reciprocity.structure);
  if (!c.reciprocity.structure)
    CHECK(r.at("why_no_structure").get<std::string>() == c.reciprocity.why_no_structure);
}

void check_modes(const Json& list, const std::vector<JudgedMode>& modes) {
  REQUIRE(list.size() == modes.size());
  for (std::size_t k = 0; k < modes.size(); ++k) {
    CHECK(list[k].at("rad_per_s") == modes[k].omega);
    CHECK(list[k].at("states") == modes[k].states);
    CHECK(list[k].at("visibility") == modes[k].visibility);
    CHECK(list[k].at("bound") == modes[k].bound);
    CHECK(list[k].at("why") == modes[k].why);
  }
}

void check_order(const Json& all, const FullCertificate& c) {
  const Json &o = all.at("order"), &e = all.at("exact");
  CHECK(o.at("judged") == c.order.judged);
  CHECK(o.at("decided") == c.order.decided());
  CHECK(o.at("order") == c.order.order);
  check_number(o.at("lowest"), c.order.judged, c.order.lowest);
  check_number(o.at("highest"), c.order.judged, c.order.highest);
  check_number(o.at("to_fewer"), c.order.judged, c.order.to_fewer);
  check_number(o.at("to_more"), c.order.judged, c.order.to_more);
  check_number(o.at("change"), c.order.change >= 0, c.order.change);
  CHECK(o.at("exact").is_null() == !c.order.judged);
  check_modes(o.at("removed"), c.order.removed);
  check_modes(o.at("undecided"), c.order.undecided);
  check_item(e, {c.exact.decided, c.exact.why_not});
  check_number(e.at("order"), c.exact.decided, c.exact.order);
  check_number(e.at("reachable"), c.exact.decided, c.exact.reachable);
  check_number(e.at("observable"), c.exact.decided, c.exact.observable);
  check_number(e.at("states"), c.exact.decided, c.exact.states);
}

void check_same(const FullCertificate& c) {
  const Json all = parsed(c);
  CHECK(all.at("format") == "titop certificate 1");
  CHECK(all.at("holds") == c.holds());
  CHECK(all.at("faults").get<std::vector<std::string>>() == c.faults);
  check_number(all.at("basic").at("residual"), c.basic.residual >= 0, c.basic.residual);
  check_number(all.at("basic").at("dense_error"), c.basic.dense_error >= 0, c.basic.dense_error);
  CHECK(all.at("basic").at("weakest_where") == c.basic.weakest_where);
  check_grid(all.at("grid"), c.grid);
  check_poles(all.at("poles"), c.poles);
  check_pairs(all, c);
  check_order(all, c);
}

/// A mass on another, both pushed; on request by a filter as well.
Diagram two(bool filter) {
  Diagram d{"two"};
  auto a = d.add("a", SpringMass{.mass = 1, .stiffness = 4, .damping = 0.1});
  auto b = d.add("b", SpringMass{.mass = 2, .stiffness = 18});
  ground(a);
  mount(b, a.child);
  a.child.force += d.input("\"f\", N");
  b.child.force += d.input("g");
  if (filter) {
    auto g = d.add("filter", Gain{.gain = 3});
    g.in = a.stretch;
    b.child.force += g.out;
  }
  d.output("a") = a.child.accel;
  d.output("b") = b.child.accel;
  return d;
}

}  // namespace

TEST_CASE("all checked: every number of the struct, and no null but where nothing is to be said") {
  const FullCertificate c = certify(compile(two(false)));
  REQUIRE(c.holds());
  check_same(c);
  const Json all = parsed(c);
  for (const char* item : {"grid", "poles", "passivity", "reciprocity", "exact"}) {
    INFO(item);
    CHECK(all.at(item).at("done") == true);
  }
  CHECK(all.at("reciprocity").at("structure") == true);
  CHECK(all.at("order").at("order") == 4);
  CHECK(all.at("exact").at("order") == 4);
}

TEST_CASE("no structure, and why; names with quotes; modes that left") {
  FullCertificate c = certify(compile(two(true)));
  check_same(c);
  CHECK(titop_test::has_names(parsed(c).at("reciprocity").at("why_no_structure").get<std::string>(),
                              {"b.child.force", "filter.out"}));
  const auto [f, g] =
      std::pair(parsed(c).at("reciprocity").at("first"), parsed(c).at("reciprocity").at("second"));
  CHECK((f == "\"f\", N" || g == "\"f\", N"));
  auto k = titop_test::kStiffnesses;
  k[4] = k[3] / titop_test::kMasses[3] * titop_test::kMasses[4];
  c = certify(compile(titop_test::third_of_five(titop_test::kMasses, k)));
  REQUIRE(c.order.removed.size() == 1);
  check_same(c);
}

TEST_CASE("values that were not checked are null, with the reason") {
  FullCertificate c = certify(compile(two(false)), {.dense_up_to = 1, .written_up_to = 1});
  check_same(c);
  CHECK(parsed(c).at("poles").at("why_not") == c.poles.why_not);
  CHECK(parsed(c).at("poles").at("count").is_null());
  CHECK(parsed(c).at("grid").at("dense").is_null());
  CHECK(parsed(c).at("order").at("lowest").is_null());
  Diagram d{"modes only"};
  ground(d.add("z", SpringMass{}));
  c = certify(compile(d));
  check_same(c);
  CHECK(parsed(c).at("reciprocity").at("asymmetry").is_null());
  CHECK(parsed(c).at("exact").at("order").is_null());
}

TEST_CASE("faults and numbers that are not finite; a file") {
  FullCertificate c = certify(compile(two(false)));
  c.faults = {"first", "zwei µ"};
  c.grid.dense = HUGE_VAL;
  check_same(c);
  CHECK(parsed(c).at("holds") == false);
  const titop_test::Folder folder;
  write_json(c, folder.path / "c.json");
  CHECK(folder.read("c.json") == certificate_json(c));
  CHECK_THROWS_AS(write_json(c, folder.path / "none" / "c.json"), Error);
}
