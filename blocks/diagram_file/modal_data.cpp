#include <titop/blocks/diagram_file/blocks.hpp>

namespace titop::diagram_file {

Json body_json(const ModalData& data) {
  Json json = {{"omega", list(data.omega)}, {"xi", list(data.xi)},   {"L_P", rows(data.L_P)},
               {"D_P", rows(data.D_P)},     {"digits", data.digits}, {"children", Json::array()}};
  for (const ModalChild& c : data.children)
    json["children"].push_back({{"name", c.name}, {"PC", list(c.PC)}, {"Phi_C", rows(c.Phi_C)}});
  if (!data.warnings.empty()) json["warnings"] = data.warnings;
  for (const ModalLine& line : data.lines) {
    Json shapes = Json::array();
    for (const LineShape& s : line.shapes)
      shapes.push_back({{"component", s.component + 1}, {"degree", s.degree}});
    json["lines"].push_back({{"name", line.name},
                             {"axis", line.axis + 1},
                             {"length", line.length},
                             {"shapes", shapes},
                             {"Phi", rows(line.Phi)}});
  }
  return json;
}

namespace {

ModalLine read_line(const JsonPlace& p, Eigen::Index modes) {
  p.only({"name", "axis", "length", "shapes", "Phi"});
  ModalLine line{p.at("name").text(), p.at("axis").integer() - 1, p.at("length").number(), {}, {}};
  const JsonPlace shapes = p.at("shapes");
  for (std::size_t i = 0; i < shapes.size(); ++i) {
    const JsonPlace s = shapes.item(i);
    s.only({"component", "degree"});
    line.shapes.push_back({s.at("component").integer() - 1, s.at("degree").integer()});
  }
  line.Phi = p.at("Phi").matrix(static_cast<Eigen::Index>(line.shapes.size()), modes);
  return line;
}

}  // namespace

FlexibleBody read_body(const JsonPlace& p) {
  p.only({"omega", "xi", "L_P", "D_P", "digits", "children", "lines", "warnings"});
  ModalData data;
  data.omega = p.at("omega").vector();
  const Eigen::Index n = data.omega.size();
  data.xi = p.at("xi").vector(n);
  data.L_P = p.at("L_P").matrix(n, 6);
  data.D_P = p.at("D_P").matrix(6, 6);
  data.digits = p.at("digits").number();
  const JsonPlace children = p.at("children");
  for (std::size_t i = 0; i < children.size(); ++i) {
    const JsonPlace c = children.item(i);
    c.only({"name", "PC", "Phi_C"});
    data.children.push_back(
        {c.at("name").text(), c.at("PC").vector(3), c.at("Phi_C").matrix(6, n)});
  }
  for (std::size_t i = 0; p.has("warnings") && i < p.at("warnings").size(); ++i)
    data.warnings.push_back(p.at("warnings").item(i).text());
  if (p.has("lines"))
    for (std::size_t i = 0; i < p.at("lines").size(); ++i)
      data.lines.push_back(read_line(p.at("lines").item(i), n));
  return {data, SourceLine{}};
}

}  // namespace titop::diagram_file
