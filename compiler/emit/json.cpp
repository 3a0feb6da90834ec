#include <nlohmann/json.hpp>
#include <titop/compiler/emit/files.hpp>
#include <titop/compiler/emit/write_file.hpp>

namespace titop {

namespace {

using Json = nlohmann::ordered_json;

/// Numbers that are negative where nothing was found.
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
  return {{"residual", c.residual},
          {"residual_where", c.residual_where},
          {"s", c.s},
          {"at_instant", c.at_instant},
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
          {"fronts", c.fronts},
          {"fronts_made", c.fronts_made},
          {"plans_renewed", c.plans_renewed}};
}

Json notes(const std::vector<Note>& list) {
  Json result = Json::array();
  for (const Note& n : list)
    result.push_back(
        {{"pass", n.pass}, {"kind", std::string(to_string(n.kind))}, {"text", n.text}});
  return result;
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
                     {"certificate", certificate(system.certificate())},
                     {"notes", notes(system.notes())}};
  // Names that are no UTF-8 are written with replacement characters.
  return json.dump(1, ' ', false, Json::error_handler_t::replace) + "\n";
}

void write_json(const System& system, const std::filesystem::path& file) {
  emit::write_file(file, model_json(system));
}

}  // namespace titop
