#include <fmt/format.h>

#include <cmath>
#include <limits>
#include <titop/blocks/fe/calculix.hpp>
#include <titop/blocks/fe/text_file.hpp>
#include <titop/graph/support/some_names.hpp>
#include <utility>

namespace titop::fe {

using Eigen::Index;
using Eigen::MatrixXd;

namespace {

constexpr double kNotYet = std::numeric_limits<double>::quiet_NaN();

/// A line of the .dof file.
struct Label {
  int node = 0;
  int dof = 0;  ///< 1..3
};

/// Every line has content: an empty one is a mistake, and a last line without line end may be a
/// truncated number.
std::vector<TextLine> data_lines(const TextFile& file, FileMistakes& mistakes) {
  require_text(file);
  require_line_end(file, mistakes);
  return lines_of(file);
}

bool parse_label(std::string_view text, Label& label) {
  const auto point = text.find('.');
  return point != std::string_view::npos && parse(text.substr(0, point), label.node) &&
         parse(text.substr(point + 1), label.dof) && label.node > 0 && label.dof >= 1 &&
         label.dof <= 3;
}

std::vector<Label> read_labels(const TextFile& file) {
  FileMistakes mistakes;
  std::vector<Label> labels;
  std::map<std::pair<int, int>, int> seen;
  for (const TextLine& line : data_lines(file, mistakes)) {
    Label label;
    if (!parse_label(trim(line.text), label)) {
      mistakes.add(bad_line(file, line.number, fmt::format("'{}'", line.text),
                            "node.dof with dof 1, 2 or 3"));
      continue;
    }
    const auto [at, is_new] = seen.insert({{label.node, label.dof}, line.number});
    if (!is_new)
      mistakes.add(bad_line(file, line.number, fmt::format("{} again", trim(line.text)),
                            fmt::format("a label once: line {} has it", at->second)));
    labels.push_back(label);
  }
  mistakes.finish();
  return labels;
}

/// One entry into both triangles.
void put_entry(const TextFile& file, const TextLine& line, MatrixXd& S, FileMistakes& mistakes) {
  const auto fields = words(line.text);
  int row = 0, column = 0;
  double value = 0;
  const std::string found = fmt::format("'{}'", line.text);
  if (fields.size() != 3 || !parse(fields[0], row) || !parse(fields[1], column) ||
      !parse(fields[2], value)) {
    mistakes.add(bad_line(file, line.number, found, "row, column and a finite value"));
    return;
  }
  if (row < 1 || row > S.rows() || column < 1 || column > S.rows()) {
    mistakes.add(
        bad_line(file, line.number, found,
                 fmt::format("row and column from 1 to {}, the lines of the .dof file", S.rows())));
    return;
  }
  const double before = S(row - 1, column - 1);
  if (!std::isnan(before) && before != value)
    mistakes.add(
        bad_line(file, line.number, found,
                 fmt::format("the value {} that ({}, {}) already has", before, row, column)));
  S(row - 1, column - 1) = value;
  S(column - 1, row - 1) = value;
}

MatrixXd read_matrix(const TextFile& file, const std::vector<Label>& labels) {
  const auto n = static_cast<Index>(labels.size());
  FileMistakes mistakes;
  MatrixXd S = MatrixXd::Constant(n, n, kNotYet);
  const std::vector<TextLine> lines = data_lines(file, mistakes);
  for (const TextLine& line : lines) put_entry(file, line, S, mistakes);
  mistakes.finish();  // a row in a line that was not read is not also reported as missing
  // CalculiX writes every diagonal entry, zero or not, and each column's last: a missing one means
  // a missing column.
  for (Index i = 0; i < n; ++i) {
    if (!std::isnan(S(i, i))) continue;
    const Label& label = labels[static_cast<std::size_t>(i)];
    mistakes.add(bad_line(file, lines.back().number,
                          fmt::format("the end of the file and no entry ({0}, {0}) (dof {1}.{2})",
                                      i + 1, label.node, label.dof),
                          fmt::format("a diagonal entry for each of the {} rows", n)));
  }
  mistakes.finish();
  return S.unaryExpr([](double entry) { return std::isnan(entry) ? 0.0 : entry; });
}

/// Points and rows of the mesh from the labels. A rotation node belongs to its reference node.
void place_labels(const TextFile& file, const std::vector<Label>& labels, const CalculixDeck& deck,
                  const std::string& deck_name, Mesh& mesh) {
  FileMistakes mistakes;
  std::map<int, int> ref_of;
  for (const auto& body : deck.rigid_bodies) ref_of[body.rot_node] = body.ref_node;
  std::map<int, std::size_t> point_of;
  for (std::size_t i = 0; i < labels.size(); ++i) {
    const auto rotation = ref_of.find(labels[i].node);
    const bool rotates = rotation != ref_of.end();
    const int node = rotates ? rotation->second : labels[i].node;
    const auto position = deck.nodes.find(node);
    if (position == deck.nodes.end()) {
      Mistake mistake = bad_line(
          file, static_cast<int>(i) + 1, fmt::format("{}.{}", labels[i].node, labels[i].dof),
          fmt::format("a node of {}, which has no position of node {}", deck_name, node));
      if (!deck.makes_nodes.empty() && mistakes.empty())
        mistake.hint = fmt::format(
            "CalculiX makes nodes of its own for {}: write *RIGID BODY with REF NODE and ROT NODE "
            "in place of couplings, solid elements (C3D20) in place of beams and shells",
            titop::detail::some_names(deck.makes_nodes));
      mistakes.add(std::move(mistake));
      continue;
    }
    const auto [at, is_new] = point_of.insert({node, mesh.points.size()});
    if (is_new) mesh.points.push_back({std::to_string(node), position->second});
    mesh.dofs.push_back({at->second, labels[i].dof - 1 + (rotates ? 3 : 0)});
  }
  mistakes.finish();
}

void name_interfaces(const std::vector<CalculixInterface>& interfaces, const CalculixDeck& deck,
                     Mesh& mesh) {
  std::string reference_nodes;
  for (const auto& body : deck.rigid_bodies)
    reference_nodes += fmt::format("{}{}", reference_nodes.empty() ? "" : ", ", body.ref_node);
  for (const CalculixInterface& interface : interfaces) {
    std::size_t point = 0;
    while (point < mesh.points.size() && mesh.points[point].name != std::to_string(interface.node))
      ++point;
    if (point == mesh.points.size())
      throw Error(Code::unknown_name,
                  fmt::format("interface {} of mesh {}: node {} has no row in the matrices",
                              interface.name, mesh.name, interface.node),
                  reference_nodes.empty()
                      ? "the deck has no *RIGID BODY, whose reference nodes could be interfaces"
                      : "the reference nodes of the deck's rigid bodies are " + reference_nodes);
    mesh.interfaces.push_back({interface.name, point});
  }
}

}  // namespace

CalculixFiles calculix_files(const std::filesystem::path& stem) {
  const std::string s = stem.string();
  return {s + ".sti", s + ".mas", s + ".dof", s + ".inp"};
}

Mesh read_calculix(const CalculixFiles& files, const std::vector<CalculixInterface>& interfaces) {
  const TextFile label_file = read_text(files.dofs);
  const std::vector<Label> labels = read_labels(label_file);
  const CalculixDeck deck = read_calculix_deck(files.deck);
  Mesh mesh;
  mesh.name = files.stiffness.stem().string();
  mesh.digits = 14;
  place_labels(label_file, labels, deck, files.deck.filename().string(), mesh);
  name_interfaces(interfaces, deck, mesh);
  mesh.K = read_matrix(read_text(files.stiffness), labels);
  mesh.M = read_matrix(read_text(files.mass), labels);
  check(mesh);
  return mesh;
}

}  // namespace titop::fe
