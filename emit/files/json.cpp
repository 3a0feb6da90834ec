#include <nlohmann/json.hpp>
#include <titop/emit/files/files.hpp>
#include <titop/emit/files/lft_files.hpp>
#include <titop/emit/text/write_file.hpp>

namespace titop {

namespace {

using Json = nlohmann::ordered_json;

/// Numbers that are negative if nothing was found.
Json found(double x) { return x < 0 ? Json() : Json(x); }

Json rows(const Eigen::MatrixXd& M) {
  Json list = Json::array();
  for (Eigen::Index i = 0; i < M.rows(); ++i) {
    Json row = Json::array();
    for (Eigen::Index j = 0; j < M.cols(); ++j) row.push_back(M(i, j));
    list.push_back(std::move(row));
  }
  return list;
}

Json complex(std::complex<double> s) { return Json::array({s.real(), s.imag()}); }

Json poles(const std::vector<Pole>& list) {
  Json result = Json::array();
  for (const Pole& p : list) {
    Json blocks = Json::array();
    for (const auto& [name, share] : p.blocks)
      blocks.push_back({{"block", name}, {"share", share}});
    result.push_back({{"s", complex(p.s)},
                      {"pair", p.pair},
                      {"rad_per_s", p.omega},
                      {"hertz", p.hertz},
                      {"damping", p.damping},
                      {"blocks", std::move(blocks)}});
  }
  return result;
}

Json certificate(const Certificate& c) {
  return {{"residual", found(c.residual)},
          {"residual_where", c.residual_where},
          {"s", c.s},
          {"at_instant", c.at_instant},
          {"apply_against_transfer", found(c.apply_against_transfer)},
          {"dense_against_factors", found(c.dense_against_factors)},
          {"dense_error", found(c.dense_error)},
          {"dense_error_s", complex(c.dense_error_s)},
          {"dense_error_where_small", found(c.dense_error_where_small)},
          {"dense_error_where_small_s", complex(c.dense_error_where_small_s)},
          {"weakest_pivot", c.weakest_pivot},
          {"weakest_where", c.weakest_where},
          {"pivot_growth", c.pivot_growth},
          {"margin", c.margin},
          {"margin_is_exact", c.margin_is_exact},
          {"margin_where", c.margin_where},
          {"by_differences", c.by_differences},
          {"fronts", c.fronts},
          {"fronts_made", c.fronts_made},
          {"plans_renewed", c.plans_renewed}};
}

/// As the log has them.
Json notes(const System& system) {
  Json result = Json::array();
  for (const auto& list : {system.notes(), system.dense_notes()})
    for (const Note& n : list)
      result.push_back(
          {{"pass", n.pass}, {"kind", std::string(to_string(n.kind))}, {"text", n.text}});
  return result;
}

/// Null if it was not checked or not found.
template <class T>
Json where(bool known, T&& value) {
  return known ? Json(std::forward<T>(value)) : Json();
}

Json item(const Checked& c) { return {{"done", c.done}, {"why_not", where(!c.done, c.why_not)}}; }

Json with(Json first, const Json& more) {
  first.update(more);
  return first;
}

Json grid(const FullCertificate::Grid& g) {
  const bool points = g.points > 0, written = g.written >= 0;
  return with(item(g), {{"points", g.points},
                        {"lowest", where(points, g.lowest)},
                        {"highest", where(points, g.highest)},
                        {"dense", where(g.done, g.dense)},
                        {"dense_s", where(g.done, complex(g.dense_s))},
                        {"written", where(written, g.written)},
                        {"written_s", where(written, complex(g.written_s))}});
}

Json poles(const FullCertificate::Poles& p) {
  const bool measured = p.done && p.measured > 0;
  return with(item(p), {{"count", where(p.done, p.count)},
                        {"measured", where(p.done, p.measured)},
                        {"error", where(measured, p.error)},
                        {"where", where(measured, complex(p.where))},
                        {"right", where(p.done, p.right)},
                        {"hidden", where(p.done, p.hidden)},
                        {"rightmost", where(p.done && p.count > 0, complex(p.rightmost))}});
}

Json passivity(const FullCertificate::Passivity& p) {
  return with(item(p), {{"pairs", p.pairs},
                        {"least", where(p.done, p.least)},
                        {"where", where(p.done, complex(p.where))},
                        {"structure", where(p.done, p.structure)}});
}

Json momenta(const std::vector<std::pair<std::string, double>>& list) {
  Json result = Json::array();
  for (const auto& [port, h] : list)
    result.push_back({{"port", port}, {"N_m_s", h != 0 ? Json(h) : Json()}});
  return result;
}

Json reciprocity(const FullCertificate::Reciprocity& r) {
  const bool off = r.done && !r.first.empty();
  return with(item(r), {{"forces", r.forces},
                        {"asymmetry", where(r.done, r.asymmetry)},
                        {"where", where(off, complex(r.where))},
                        {"first", where(off, r.first)},
                        {"second", where(off, r.second)},
                        {"structure", where(r.done, r.structure)},
                        {"reversed", where(r.done, r.reversed)},
                        {"momenta", momenta(r.momenta)},
                        {"why_no_structure", where(r.done && !r.structure, r.why_no_structure)}});
}

Json modes(const std::vector<JudgedMode>& list) {
  Json result = Json::array();
  for (const JudgedMode& m : list)
    result.push_back({{"rad_per_s", m.omega},
                      {"states", m.states},
                      {"visibility", m.visibility},
                      {"bound", m.bound},
                      {"why", m.why}});
  return result;
}

Json order(const OrderVerdict& v) {
  return {{"judged", v.judged},
          {"decided", v.decided()},
          {"order", v.order},
          {"lowest", where(v.judged, v.lowest)},
          {"highest", where(v.judged, v.highest)},
          {"exact", where(v.judged, v.exact)},
          {"to_fewer", where(v.judged, v.to_fewer)},
          {"to_more", where(v.judged, v.to_more)},
          {"change", found(v.change)},
          {"removed", modes(v.removed)},
          {"undecided", modes(v.undecided)}};
}

Json exact(const ExactOrder& e) {
  return {{"done", e.decided},
          {"why_not", where(!e.decided, e.why_not)},
          {"order", where(e.decided, e.order)},
          {"reachable", where(e.decided, e.reachable)},
          {"observable", where(e.decided, e.observable)},
          {"states", where(e.decided, e.states)}};
}

Json parameters(const std::vector<Delta>& list) {
  Json result = Json::array();
  for (const Delta& d : list)
    result.push_back({{"name", d.parameter},
                      {"first", d.first},
                      {"size", d.size},
                      {"at_least", d.at_least},
                      {"minimal", d.minimal()},
                      {"nominal", d.map.nominal},
                      {"from", d.map.from},
                      {"to", d.map.to},
                      {"gain", d.map.gain},
                      {"shape", d.map.shape},
                      {"divisor", d.map.divisor()},
                      {"where", d.where}});
  return result;
}

/// Names that are no UTF-8 are written with replacement characters.
std::string text_of(const Json& json) {
  return json.dump(1, ' ', false, Json::error_handler_t::replace) + "\n";
}

}  // namespace

std::string model_json(const System& system) {
  const StateSpace& m = system.state_space();
  const Json json = {{"format", "titop model 1"},
                     {"name", system.stage().graph.name},
                     {"states", m.states},
                     {"inputs", m.inputs},
                     {"outputs", m.outputs},
                     {"A", rows(m.A)},
                     {"B", rows(m.B)},
                     {"C", rows(m.C)},
                     {"D", rows(m.D)},
                     {"poles", poles(system.poles())},
                     {"certificate", certificate(system.dense_certificate())},
                     {"notes", notes(system)}};
  return text_of(json);
}

std::string certificate_json(const FullCertificate& c) {
  const Json json = {{"format", "titop certificate 1"},
                     {"holds", c.holds()},
                     {"faults", c.faults},
                     {"basic", certificate(c.basic)},
                     {"grid", grid(c.grid)},
                     {"poles", poles(c.poles)},
                     {"passivity", passivity(c.passivity)},
                     {"reciprocity", reciprocity(c.reciprocity)},
                     {"order", order(c.order)},
                     {"exact", exact(c.exact)}};
  return text_of(json);
}

void write_json(const System& system, const std::filesystem::path& file) {
  emit::write_file(file, model_json(system));
}

void write_json(const FullCertificate& c, const std::filesystem::path& file) {
  emit::write_file(file, certificate_json(c));
}

std::string lft_json(const Lft& f) {
  const StateSpace& m = f.m();
  const Json json = {{"format", "titop lft 1"},
                     {"states", m.states},
                     {"inputs", m.inputs},
                     {"outputs", m.outputs},
                     {"A", rows(m.A)},
                     {"B", rows(m.B)},
                     {"C", rows(m.C)},
                     {"D", rows(m.D)},
                     {"states_at_least", f.states_at_least()},
                     {"not_decided", where(!f.not_decided().empty(), f.not_decided())},
                     {"parameters", parameters(f.deltas())}};
  return text_of(json);
}

void write_json(const Lft& f, const std::filesystem::path& file) {
  emit::write_file(file, lft_json(f));
}

}  // namespace titop
