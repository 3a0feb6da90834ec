#pragma once

#include <string>
#include <titop/compiler/diagram/fold.hpp>
#include <titop/compiler/passes/stage.hpp>
#include <vector>

/// The content of a diagram's picture, before it is text. Everything is in natural order of names,
/// so that the picture does not depend on the order of adds.
///
/// The tree has its root at the top, as in the paper: parents above, children below. A block has
/// its parent channel along its top and its children along its bottom, so accelerations run down
/// and wrenches return upwards next to them.
namespace titop::diagram {

/// One side of a block: where a wire leaves or arrives. `loose`: it may go either way.
enum class BlockSide { top, bottom, loose };

/// The end of a wire.
struct Anchor {
  std::string port;  ///< Graphviz text: "z1":c0f:s
  BlockSide side = BlockSide::loose;
};

/// A driven port (or a part of one) or an output, with its terms.
struct Assignment {
  int target = -1, output = -1;  ///< a signal, or an index in Graph::outputs
  std::string part = {};         ///< ".linear" if only that is driven
  std::vector<Term> terms = {};  ///< none: it is 0
  bool active = true;
};

struct Picture {
  const Stage& stage;
  const Graph& graph;
  /// Quoted, each once; inputs (outputs) of one box alone share one.
  std::vector<std::string> node_id, input_id, output_id;
  std::vector<int> nodes, inputs, outputs;  ///< indices in natural order
  std::vector<int> loop;                    ///< per signal: 1, 2, ..., 0 for none
  std::vector<char> inverted;               ///< per channel
  std::vector<std::string> zero;            ///< per signal: "= 0", or empty
  std::vector<Assignment> assignments;
  Fold fold;
  std::vector<std::string> box_id;  ///< quoted
};

/// `most`: as in `fold`.
Picture picture(const Stage& stage, int most);

/// The box of a signal's block, -1 for none.
int box_of(const Picture& p, int signal);
/// True if a box has a part in it: then only its wires are drawn, no sums or gains.
bool is_folded(const Picture& p, const Assignment& a);

/// Drawing of one term on its wire.
struct Look {
  bool minus = false;
  std::string box = {};                 ///< "k1", "T(A1←B)", "M 3x6"; empty: a plain wire
  std::string before = {}, after = {};  ///< labels: size and frame, part
  int rows = 1;
  bool rotation = false;
};

Look look(const Picture& p, const Assignment& a, const Term& term);

/// False if every signal of the node has been set aside.
bool is_active(const Graph& g, int node);
/// Outputs of signals at the top are drawn above their block, all others below.
BlockSide output_side(const Graph& g, const Assignment& a);
/// Side of its block at which a signal is drawn.
BlockSide side_of(const Graph& g, int signal);
/// Name of a signal's cell in its block's table.
std::string cell_name(const Graph& g, int signal);
Anchor anchor(const Picture& p, int signal);

/// One piece of wire. Graphviz puts tails above heads, so an upward wire is written from head to
/// tail with its arrow at the back.
struct Wire {
  std::string from = {}, to = {};
  bool up = false, arrow = true, minus = false;
  bool active = true;
  int rows = 1, loop = 0;
  Quantity quantity = Quantity::plain;
  std::string label = {};
};
std::string draw(const Wire& wire);

/// The text of all boxes; of the wires to and from them, those of one kind between two as one.
std::string draw_boxes(const Picture& p);
std::string draw_folded_wires(const Picture& p);

/// The text of all blocks, external inputs and outputs; of all wires with the small nodes on
/// them; of the legend (as an HTML-like label).
std::string draw_nodes(const Picture& p);
std::string draw_wires(const Picture& p);
std::string draw_legend(const Picture& p);

}  // namespace titop::diagram
