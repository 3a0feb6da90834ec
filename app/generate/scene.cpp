#include <fmt/format.h>

#include "generate/generate.hpp"

/// The plan as a diagram file (docs/diagram.schema.json).
namespace titop::generate {
namespace {

Json number(const Ratio& r) {
  if (r.den == 1) return r.num;
  return r.value();
}
Json list(const std::vector<Ratio>& v) {
  Json j = Json::array();
  for (const Ratio& x : v) j.push_back(number(x));
  return j;
}
Json list(const Vec3& v) { return {number(v[0]), number(v[1]), number(v[2])}; }
Json rows(const RatioMatrix& M) {
  Json j = Json::array();
  for (const auto& row : M) j.push_back(list(row));
  return j;
}
Json rows(const Mat3& M) { return {list(M[0]), list(M[1]), list(M[2])}; }

class PlanWriter {
 public:
  explicit PlanWriter(const ScenePlan& plan) : plan_(plan) {}

  Json scene() {
    for (std::size_t i = 0; i < plan_.blocks.size(); ++i) add(static_cast<int>(i));
    for (const Control& c : plan_.controls) add(c);
    for (const Closure& c : plan_.closures) add(c);
    for (const Load& l : plan_.loads)
      equation(signal(l.point, "force"), Json::array({term({l.input}, l.gain)}), l.part, true);
    for (const Named& n : plan_.inputs) inputs_.push_back({{"name", n.name}, {"size", n.size}});
    for (std::size_t i = 0; i < plan_.readings.size(); ++i)
      add(plan_.readings[i], plan_.outputs[i]);
    return {{"format", "titop scene 1"}, {"name", plan_.name}, {"parameters", parameters_},
            {"bodies", bodies_},         {"blocks", blocks_},  {"inputs", inputs_},
            {"equations", equations_},   {"outputs", outputs_}};
  }

 private:
  const PlannedBlock& block(int i) const { return plan_.blocks[static_cast<std::size_t>(i)]; }
  Json signal(const PlannedPoint& p, const char* which) const {
    return {block(p.block).name, p.channel, which};
  }
  /// Stretch, angle or travel.
  Json position(int i) const {
    const PlannedBlock& b = block(i);
    return {b.name, !b.joint ? "stretch" : b.joint->turns ? "angle" : "travel"};
  }
  static Json term(Json of, const Ratio& gain = 1) {
    Json t = {{"signal", std::move(of)}};
    if (gain == Ratio(-1))
      t["sign"] = -1;
    else if (!(gain == Ratio(1)))
      t["factors"] = Json::array({number(gain)});
    return t;
  }
  Json rotated(Json of, const Mat3& T, int to, int from) const {
    Json t = {{"signal", std::move(of)}};
    t["factors"] = Json::array({Json{
        {"rotation", Json::array({rows(T)})}, {"to", block(to).name}, {"from", block(from).name}}});
    return t;
  }
  static Json part(const PlannedPart& p) {
    RatioMatrix r;
    if (p.kind == PlannedPart::Kind::linear)
      r = {{1, 0, 0, 0, 0, 0}, {0, 1, 0, 0, 0, 0}, {0, 0, 1, 0, 0, 0}};
    else
      r = {{p.direction[0], p.direction[1], p.direction[2], 0, 0, 0}};
    return {{"part", p.kind == PlannedPart::Kind::linear ? ".linear" : ".along"},
            {"rows", rows(r)}};
  }
  static Json angular() {
    return {
        {"part", ".angular"},
        {"rows", rows(RatioMatrix{{0, 0, 0, 1, 0, 0}, {0, 0, 0, 0, 1, 0}, {0, 0, 0, 0, 0, 1}})}};
  }
  void equation(Json of, Json terms, const PlannedPart& p = {}, bool add = false) {
    Json e = {{"of", std::move(of)}};
    if (p.kind != PlannedPart::Kind::all) e["part"] = part(p);
    if (add) e["add"] = true;
    e["terms"] = std::move(terms);
    equations_.push_back(std::move(e));
  }

  void add(int i) {
    const PlannedBlock& b = block(i);
    Json j = {{"name", b.name}};
    if (b.spring) write(j, b, *b.spring);
    if (b.body) write(j, b, *b.body);
    if (b.joint) {
      j["type"] = b.joint->turns ? "Hinge" : "Slide";
      j["axes"] = Json::array({Json{{"kind", b.joint->turns ? "about" : "along"},
                                    {"direction", list(b.joint->axis)},
                                    {"name", ""}}});
    }
    blocks_.push_back(std::move(j));
    hang(i);
    if (b.joint) mechanism(i);
  }

  void write(Json& j, const PlannedBlock& b, const Spring& z) {
    j["type"] = "SpringMass";
    j["mass"] = number(z.mass);
    j["stiffness"] = number(z.stiffness);
    if (!b.stiffness_parameter.empty()) {
      parameters_.push_back({{"name", b.stiffness_parameter}, {"value", number(z.stiffness)}});
      j["stiffness"] = {{"parameter", b.stiffness_parameter}};
    }
    j["damping"] = number(z.damping);
    j["parent_mass"] = number(z.parent_mass);
  }

  void write(Json& j, const PlannedBlock& b, const Body& body) {
    Json points = Json::array();
    for (const BodyPoint& p : body.points) {
      points.push_back({{"name", p.name}, {"PC", list(p.PC)}});
      if (!body.omega.empty()) points.back()["Phi_C"] = rows(p.Phi);
    }
    if (body.omega.empty()) {
      j["type"] = "RigidBody";
      j["mass"] = number(body.mass);
      const Vec3& J = body.inertia;
      j["inertia"] = rows(RatioMatrix{{J[0], 0, 0}, {0, J[1], 0}, {0, 0, J[2]}});
      j["PA"] = list(body.PA);
      j["children"] = points;
      return;
    }
    j["type"] = "FlexibleBody";
    j["body"] = "modes of " + b.name;
    bodies_["modes of " + b.name] = {
        {"omega", list(body.omega)},     {"xi", list(body.xi)}, {"L_P", rows(body.L)},
        {"D_P", rows(rigid_mass(body))}, {"digits", 15},        {"children", points}};
  }

  /// The equations of a block's parent point.
  void hang(int i) {
    const PlannedBlock& b = block(i);
    const PlannedPoint parent{i, "parent"};
    const Json accel = signal(parent, "accel"), force = signal(parent, "force");
    switch (b.base.kind) {
      case Attachment::Kind::ground: return equation(accel, Json::array());
      case Attachment::Kind::imposed: return equation(accel, Json::array({term({b.base.input})}));
      case Attachment::Kind::pinned:
        equation(accel, Json::array(), {PlannedPart::Kind::linear, {}});
        equations_.push_back({{"of", force}, {"part", angular()}, {"terms", acting(b)}});
        return;
      case Attachment::Kind::free:
        equations_.push_back({{"of", force}, {"terms", acting(b)}});
        return;
      case Attachment::Kind::mounted: return mount(i);
    }
  }
  static Json acting(const PlannedBlock& b) {
    if (b.base.input.empty()) return Json::array();
    return Json::array({term({b.base.input}, -1)});
  }

  void mount(int i) {
    const Attachment& base = block(i).base;
    const PlannedPoint parent{i, "parent"};
    const Json accel = signal(base.on, "accel"), force = signal(parent, "force");
    if (base.along) {
      const PlannedPart direction{PlannedPart::Kind::along, *base.along};
      equation(signal(parent, "accel"),
               Json::array({Json{{"signal", accel}, {"factors", Json::array({part(direction)})}}}));
      equation(signal(base.on, "force"), Json::array({term(force)}), direction, true);
    } else if (block(i).spring) {
      equation(signal(parent, "accel"), Json::array({term(accel)}));
      equation(signal(base.on, "force"), Json::array({term(force)}), {}, true);
    } else {
      const int on = base.on.block;
      equation(signal(parent, "accel"), Json::array({rotated(accel, transposed(base.T), i, on)}));
      equation(signal(base.on, "force"), Json::array({rotated(force, base.T, on, i)}), {}, true);
    }
  }

  void mechanism(int i) {
    const PlannedJoint& h = *block(i).joint;
    for (const Control& c : plan_.controls)
      if (c.block == i && c.law == Control::Law::position) return;  // it drives the axis
    Json terms = Json::array();
    if (!(h.stiffness == Ratio(0))) terms.push_back(term(position(i), h.stiffness));
    if (!(h.damping == Ratio(0))) terms.push_back(term({block(i).name, "rate"}, h.damping));
    if (!h.input.empty()) terms.push_back(term({h.input}, -1));
    equation({block(i).name, "", "force"}, std::move(terms));
  }

  void add(const Control& c) {
    blocks_.push_back({{"name", c.name},
                       {"type", "Lti"},
                       {"A", rows(c.A)},
                       {"B", rows(c.B)},
                       {"C", rows(c.C)},
                       {"D", rows(c.D)}});
    const Json out = {c.name, "out"};
    if (c.law != Control::Law::position) return around(c);
    const PlannedBlock& b = block(c.block);
    equation({c.name, "in"}, Json::array({term(position(c.block))}));
    if (b.joint)
      equation({b.name, "", "force"}, Json::array({term(out)}));
    else
      equation(signal(c.at.front().point, "force"), Json::array({term(out, -1)}), {}, true);
  }

  /// The equations of a controller that measures accelerations.
  void around(const Control& c) {
    Json in = Json::array();
    for (std::size_t j = 0; j < c.size(); ++j) {
      Json e = term(signal(c.at[j].point, "accel")), factors = Json::array();
      RatioMatrix column(c.size(), {Ratio(0)});
      column[j][0] = 1;
      if (c.size() > 1) factors.push_back(Json{{"matrix", rows(column)}});
      if (c.at[j].along) factors.push_back(part({PlannedPart::Kind::along, *c.at[j].along}));
      if (!factors.empty()) e["factors"] = factors;
      in.push_back(e);
    }
    equation({c.name, "in"}, in);
    if (c.law == Control::Law::filter) return;
    for (std::size_t j = 0; j < c.size(); ++j) {
      Json v = term({c.name, "out"}, -1);
      RatioMatrix row(1, std::vector<Ratio>(c.size()));
      row[0][j] = 1;
      if (c.size() > 1) v["factors"] = Json::array({Json{{"matrix", rows(row)}}});
      PlannedPart direction;
      if (c.at[j].along) direction = {PlannedPart::Kind::along, *c.at[j].along};
      equation(signal(c.at[j].point, "force"), Json::array({v}), direction, true);
    }
  }

  /// A closure at `point`: its acceleration is given, and the reaction acts on the other side.
  void add(const Closure& c) {
    const Json accel = signal(c.point, "accel"), force = signal(c.point, "force");
    if (!c.with) return equation(accel, Json::array());
    const bool scalar = block(c.point.block).spring.has_value();
    const int a = c.point.block, b = c.with->block;
    const Json site = signal(*c.with, "accel");
    Json back = scalar ? term(force) : rotated(force, c.T, b, a);
    back["read"] = "reaction";
    back["sign"] = -1;
    equation(accel, Json::array({scalar ? term(site) : rotated(site, transposed(c.T), a, b)}));
    equation(signal(*c.with, "force"), Json::array({back}), {}, true);
  }

  void add(const PlannedReading& r, const Named& name) {
    Json t;
    const PlannedPoint& p = r.point;
    switch (r.of) {
      case PlannedReading::Of::acceleration: t = term(signal(p, "accel")); break;
      case PlannedReading::Of::position:
        t = term(signal(p, "accel"));
        t["read"] = "position";
        break;
      case PlannedReading::Of::relative: t = term(position(p.block)); break;
      case PlannedReading::Of::control:
        t = term({plan_.controls[static_cast<std::size_t>(p.block)].name, "out"});
        break;
      case PlannedReading::Of::support: t = term(signal(p, "force")); break;
      case PlannedReading::Of::reaction:
        t = term(signal(p, "force"));
        t["read"] = "reaction";
        break;
    }
    if (r.part.kind != PlannedPart::Kind::all) t["factors"] = Json::array({part(r.part)});
    outputs_.push_back({{"name", name.name}, {"size", name.size}, {"terms", Json::array({t})}});
  }

  const ScenePlan& plan_;
  Json parameters_ = Json::array(), bodies_ = Json::object(), blocks_ = Json::array(),
       inputs_ = Json::array(), equations_ = Json::array(), outputs_ = Json::array();
};

}  // namespace

Json scene(const ScenePlan& plan) { return PlanWriter(plan).scene(); }

std::string text(const Json& json) {
  std::string all = "{";
  for (const auto& [key, value] : json.items()) {
    all += fmt::format("{}\n {}: ", all.size() > 1 ? "," : "", Json(key).dump());
    if (!value.is_structured() || value.empty()) {
      all += value.dump();
      continue;
    }
    std::string lines;
    for (const auto& [name, item] : value.items()) {
      lines += lines.empty() ? "\n  " : ",\n  ";
      if (value.is_object()) lines += Json(name).dump() + ": ";
      lines += item.dump();
    }
    all += (value.is_object() ? "{" : "[") + lines + (value.is_object() ? "}" : "]");
  }
  return all + "\n}\n";
}

}  // namespace titop::generate
