// corpus_wiring FOLDER SCENE.json...: each scene in the form that a block-diagram program needs:
// FOLDER/SCENE.m with every block as A, B, C, D, the list of its channels that must be inverted
// first, and the wiring between the resulting inputs and outputs. No pass of the compiler has a
// part in it; a scene that has no such form is left out, and the reason is printed.
#include <fmt/format.h>

#include <filesystem>
#include <fstream>
#include <map>
#include <stdexcept>
#include <titop/graph/linalg/index.hpp>
#include <titop/titop.hpp>

using namespace titop;
using Eigen::Index;
using Eigen::MatrixXd;

namespace {

using titop::linalg::at;

std::string octave(const MatrixXd& M) {
  if (M.size() == 0) return fmt::format("zeros({},{})", M.rows(), M.cols());
  std::string text;
  for (Index i = 0; i < M.rows(); ++i)
    for (Index j = 0; j < M.cols(); ++j)
      text += fmt::format("{}{:.17g}", j > 0 ? "," : i > 0 ? ";" : "", M(i, j));
  return "[" + text + "]";
}

/// Rows of all that can be read: outputs of the blocks after inversion, inputs of the diagram, and
/// after them two integrals of each acceleration whose position is read.
class Wiring {
 public:
  explicit Wiring(const Graph& graph) : g_(graph), values_(nominal_values(graph)) {
    place();
    for (const Equation& e : g_.equations) drive(e);
  }

  std::string text() {
    std::vector<MatrixXd> rows;
    for (const Output& o : g_.outputs) rows.push_back(sum(o.terms, o.size));
    MatrixXd z = MatrixXd::Zero(0, reads_);
    for (const MatrixXd& row : rows) {
      const Index first = z.rows();
      z.conservativeResize(first + row.rows(), Eigen::NoChange);
      z.bottomRows(row.rows()).setZero();
      z.block(first, 0, row.rows(), row.cols()) = row;
    }
    std::string all = "s = struct (); s.parts = {};\n";
    for (const Node& n : g_.nodes) {
      const auto d = n.block->dynamics(values_);
      all += fmt::format(
          "s.parts{{end+1}} = struct (\"A\", {}, \"B\", {}, \"C\", {}, \"D\", {}, "
          "\"swap\", {});\n",
          octave(d->A), octave(d->B), octave(d->C), octave(d->D), octave(swapped_[&n]));
    }
    return all + fmt::format("s.wires = {}; s.outputs = {}; s.externals = {}; s.integrals = {};\n",
                             octave(wires_), octave(z), externals_, octave(integrals_));
  }

 private:
  /// Rows of inputs and outputs node by node. The two signals of a channel are at the same row of u
  /// and y: if the output is driven, the row is swapped.
  void place() {
    for (const Node& n : g_.nodes) {
      const Interface& face = n.block->interface();
      first_in_.push_back(inputs_), first_out_.push_back(outputs_);
      inputs_ += face.input_size(), outputs_ += face.output_size();
    }
    for (const Input& i : g_.inputs)
      external_.push_back(outputs_ + externals_), externals_ += i.size;
    reads_ = outputs_ + externals_;
    wires_ = MatrixXd::Zero(inputs_, reads_);
    for (std::size_t i = 0; i < g_.nodes.size(); ++i) {
      std::vector<int> rows;
      for (const Equation& e : g_.equations) {
        const Signal& s = g_.signals[at(e.target)];
        if (s.role != Signal::Role::output || s.node != int(i)) continue;
        const auto part = unit_rows(e);
        for (const Index r : part) rows.push_back(s.first + int(r));
      }
      MatrixXd list(1, static_cast<Index>(rows.size()));
      for (std::size_t k = 0; k < rows.size(); ++k) list(0, static_cast<Index>(k)) = rows[k] + 1;
      swapped_[&g_.nodes[i]] = list;
    }
  }

  /// Rows of its target that an equation drives. Throws if they are oblique.
  std::vector<Index> unit_rows(const Equation& e) const {
    const int size = g_.signals[at(e.target)].size;
    std::vector<Index> rows;
    if (e.part.whole()) {
      for (Index i = 0; i < size; ++i) rows.push_back(i);
      return rows;
    }
    for (Index i = 0; i < e.part.rows().rows(); ++i) {
      Index j = 0;
      if (e.part.rows().row(i).cwiseAbs().maxCoeff(&j) != 1 || e.part.rows().row(i).sum() != 1)
        throw std::invalid_argument("a channel is inverted along an oblique direction");
      rows.push_back(j);
    }
    return rows;
  }

  bool is_swapped(int node, int row) const {
    const MatrixXd& list = swapped_.at(&g_.nodes[at(node)]);
    for (Index k = 0; k < list.size(); ++k)
      if (list(k) == row + 1) return true;
    return false;
  }

  void drive(const Equation& e) {
    const Signal& s = g_.signals[at(e.target)];
    const MatrixXd right = sum(e.terms, e.part.whole() ? s.size : int(e.part.rows().rows()));
    if (s.role == Signal::Role::input) {
      // A force on a point whose acceleration is imposed drives nothing: the support takes it.
      if (is_swapped(s.node, s.first)) return;
      const MatrixXd P =
          e.part.whole() ? MatrixXd::Identity(s.size, s.size) : MatrixXd(e.part.rows().transpose());
      wires_.middleRows(first_in_[at(s.node)] + s.first, s.size) += P * right;
    } else {
      const auto rows = unit_rows(e);
      for (std::size_t k = 0; k < rows.size(); ++k)
        wires_.row(first_in_[at(s.node)] + s.first + rows[k]) += right.row(static_cast<Index>(k));
    }
  }

  MatrixXd sum(const std::vector<Term>& terms, int size) {
    MatrixXd all = MatrixXd::Zero(size, reads_);
    for (const Term& t : terms) {
      const MatrixXd f = coefficient(g_, t, values_);
      if (f.rows() != size) throw std::invalid_argument("the sizes of an equation differ");
      const MatrixXd read = reading(t);
      if (read.cols() > all.cols()) {
        const Index old = all.cols();
        all.conservativeResize(Eigen::NoChange, read.cols());
        all.rightCols(read.cols() - old).setZero();
      }
      all += f * read;
    }
    return all;
  }

  /// The rows of a term's signal over all that can be read.
  MatrixXd reading(const Term& t) {
    const Signal& s = g_.signals[at(t.signal)];
    MatrixXd rows = MatrixXd::Zero(s.size, reads_);
    if (s.role == Signal::Role::external) {
      rows.middleCols(external_[at(s.spec)], s.size).setIdentity();
      return rows;
    }
    for (int i = 0; i < s.size; ++i) {
      if ((s.role == Signal::Role::input) != is_swapped(s.node, s.first + i))
        rows.row(i) = driven(t.signal).row(i);
      else
        rows(i, first_out_[at(s.node)] + s.first + i) = 1;
    }
    if (t.of == Term::Of::position) return integrated(rows);
    if (t.of == Term::Of::rate) throw std::invalid_argument("a rate is read");
    if (t.of == Term::Of::reaction)
      for (const Equation& e : g_.equations)
        if (e.target == t.signal && e.accumulate)
          rows -= (e.part.whole() ? MatrixXd::Identity(s.size, s.size)
                                  : MatrixXd(e.part.rows().transpose())) *
                  sum(e.terms, e.part.whole() ? s.size : int(e.part.rows().rows()));
    return rows;
  }

  /// A driven signal as a combination of the readable ones.
  MatrixXd driven(int signal) {
    const Signal& s = g_.signals[at(signal)];
    MatrixXd all = MatrixXd::Zero(s.size, reads_);
    if (++depth_ > 100) throw std::invalid_argument(name_of(g_, signal) + " drives itself");
    for (const Equation& e : g_.equations) {
      if (e.target != signal) continue;
      const MatrixXd P =
          e.part.whole() ? MatrixXd::Identity(s.size, s.size) : MatrixXd(e.part.rows().transpose());
      all += P * sum(e.terms, static_cast<int>(P.cols()));
    }
    --depth_;
    return all;
  }

  /// Double integral, explicitly: rows of `integrals` are the integrands.
  MatrixXd integrated(const MatrixXd& rows) {
    const Index old = integrals_.rows(), m = rows.rows();
    integrals_.conservativeResize(old + m, reads_ - integrated_);
    integrals_.bottomRows(m) = rows.leftCols(reads_ - integrated_);
    integrated_ += m, reads_ += m;
    wires_.conservativeResize(Eigen::NoChange, reads_);
    wires_.rightCols(m).setZero();
    MatrixXd result = MatrixXd::Zero(m, reads_);
    result.rightCols(m).setIdentity();
    return result;
  }

  const Graph& g_;
  std::vector<double> values_;
  std::vector<Index> first_in_, first_out_, external_;
  Index inputs_ = 0, outputs_ = 0, externals_ = 0, reads_ = 0, integrated_ = 0;
  std::map<const Node*, MatrixXd> swapped_;
  int depth_ = 0;
  MatrixXd wires_, integrals_ = MatrixXd(0, 0);
};

}  // namespace

int main(int argc, char** argv) {
  const std::filesystem::path folder = argc > 1 ? argv[1] : ".";
  for (int i = 2; i < argc; ++i) {
    const std::filesystem::path file = argv[i];
    try {
      const Diagram d = read_diagram(file);
      const std::string text = Wiring(d.graph()).text();
      std::ofstream(folder / ("s" + file.stem().string() + ".m")) << text;
    } catch (const std::exception& error) {
      const std::string said = error.what();
      fmt::print("{}: {}\n", file.stem().string(), said.substr(0, said.find('\n')));
    }
  }
}
