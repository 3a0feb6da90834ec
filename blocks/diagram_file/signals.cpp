#include <algorithm>
#include <titop/blocks/diagram_file/block_types.hpp>
#include <titop/graph/linalg/index.hpp>
#include <titop/graph/nodes/gain.hpp>
#include <titop/graph/nodes/lti.hpp>

namespace titop::diagram_file {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;

void write_gain(const Block& b, const WriteValue& value, const NameBody&, Json& j) {
  j["gain"] = value(b.values().at(0));
  j["size"] = b.interface().input_size();
}

BlockPtr read_gain(const JsonPlace& p, const ReadValue& value, const FindBody&) {
  p.only({"name", "type", "gain", "size"});
  return as_block(Gain{.gain = value(p.at("gain")), .size = p.at("size").signal_size()});
}

void write_loop_point(const Block& b, const WriteValue&, const NameBody&, Json& j) {
  j["size"] = b.interface().input_size();
}

BlockPtr read_loop_point(const JsonPlace& p, const ReadValue&, const FindBody&) {
  p.only({"name", "type", "size"});
  return as_block(LoopPoint{p.at("size").signal_size()});
}

void write_matrix_gain(const Block& b, const WriteValue&, const NameBody&, Json& j) {
  j["matrix"] = rows(b.dynamics({})->D);
}

BlockPtr read_matrix_gain(const JsonPlace& p, const ReadValue&, const FindBody&) {
  p.only({"name", "type", "matrix"});
  return as_block(MatrixGain{p.at("matrix").matrix(-1, -1)});
}

void write_sum(const Block& b, const WriteValue&, const NameBody&, Json& j) {
  const Index size = b.interface().output_size();
  const auto dynamics = b.dynamics({});
  std::string signs;
  for (Index i = 0; i < dynamics->D.cols(); i += size) signs += dynamics->D(0, i) > 0 ? '+' : '-';
  j["signs"] = signs;
  j["size"] = size;
}

BlockPtr read_sum(const JsonPlace& p, const ReadValue&, const FindBody&) {
  p.only({"name", "type", "signs", "size"});
  return as_block(Sum{.signs = p.at("signs").text(), .size = p.at("size").signal_size()});
}

void write_lti(const Block& b, const WriteValue& value, const NameBody&, Json& j) {
  const std::vector<Lti::Entry> values = lti_values(b);
  std::vector<double> nominal;
  for (const Lti::Entry& e : values) {
    nominal.resize(std::max(nominal.size(), linalg::at(e.value.index()) + 1));
    nominal[linalg::at(e.value.index())] = e.value.parameter();
  }
  const auto d = b.dynamics(nominal);
  j["A"] = rows(d->A);
  j["B"] = rows(d->B);
  j["C"] = rows(d->C);
  j["D"] = rows(d->D);
  for (const Lti::Entry& e : values)
    j["values"].push_back({{"matrix", std::string(1, e.matrix)},
                           {"row", e.row},
                           {"column", e.column},
                           {"value", value(e.value)}});
}

std::vector<Lti::Entry> read_lti_entries(const JsonPlace& p, const ReadValue& value) {
  std::vector<Lti::Entry> entries;
  for (std::size_t i = 0; p.has("values") && i < p.at("values").size(); ++i) {
    const JsonPlace e = p.at("values").item(i);
    e.only({"matrix", "row", "column", "value"});
    const std::string matrix = e.at("matrix").text();
    if (matrix.size() != 1) e.at("matrix").refuse("A, B, C or D");
    entries.push_back(
        {matrix[0], e.at("row").integer(), e.at("column").integer(), value(e.at("value"))});
  }
  return entries;
}

BlockPtr read_lti(const JsonPlace& p, const ReadValue& value, const FindBody&) {
  p.only({"name", "type", "A", "B", "C", "D", "values"});
  const MatrixXd D = p.at("D").matrix(-1, -1);
  const auto n = static_cast<Index>(p.at("A").size());
  return as_block(Lti{.A = p.at("A").matrix(n, n),
                      .B = p.at("B").matrix(n, D.cols()),
                      .C = p.at("C").matrix(D.rows(), n),
                      .D = D,
                      .values = read_lti_entries(p, value)});
}

void write_integrator(const Block& b, const WriteValue&, const NameBody&, Json& j) {
  j["size"] = b.interface().output_size();
}

BlockPtr read_integrator(const JsonPlace& p, const ReadValue&, const FindBody&) {
  p.only({"name", "type", "size"});
  return as_block(Integrator{p.at("size").signal_size()});
}

constexpr BlockType kSignal[] = {
    {"Gain", write_gain, read_gain}, {"MatrixGain", write_matrix_gain, read_matrix_gain},
    {"Sum", write_sum, read_sum},    {"LoopPoint", write_loop_point, read_loop_point},
    {"Lti", write_lti, read_lti},    {"Integrator", write_integrator, read_integrator}};

}  // namespace

std::span<const BlockType> signal_types() { return kSignal; }

}  // namespace titop::diagram_file
