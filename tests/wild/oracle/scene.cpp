#include "wild/oracle/scene.hpp"

#include <numeric>

namespace wild {

namespace {

std::size_t at(int i) { return static_cast<std::size_t>(i); }

void add_blocks(std::vector<int>& blocks, int size) {
  for (; size > 3; size -= 3) blocks.push_back(3);
  blocks.push_back(size);
}

}  // namespace

bool one_axis(const Scene& scene, const Point& point) {
  return scene.nodes[at(point.node)].kind == Node::Kind::mass;
}

int size_of(const Scene& scene, const Reading& reading) {
  using Measured = Reading::Measured;
  switch (reading.measured) {
    case Measured::input: return scene.inputs[at(reading.axis)];
    case Measured::accel:
    case Measured::rate:
    case Measured::position:
    case Measured::reaction: return one_axis(scene, reading.at) ? 1 : reading.half == 0 ? 6 : 3;
    case Measured::displacement:
    case Measured::displacement_rate: return reading.half == 0 ? 6 : 3;
    case Measured::out: return static_cast<int>(scene.nodes[at(reading.at.node)].D.rows());
    default: return 1;
  }
}

int size_of(const Scene& scene, const Tie& tie) {
  return static_cast<int>(rows_of(scene, tie).rows());
}

MatrixXd rows_of(const Scene& scene, const Tie& tie) {
  if (one_axis(scene, tie.a)) return MatrixXd::Identity(1, 1);
  if (tie.of == Tie::Of::all) return MatrixXd::Identity(6, 6);
  if (tie.of == Tie::Of::linear) return MatrixXd::Identity(6, 6).topRows(3);
  if (tie.of == Tie::Of::angular) return MatrixXd::Identity(6, 6).bottomRows(3);
  MatrixXd rows = MatrixXd::Zero(static_cast<Eigen::Index>(tie.axes.size()), 6);
  for (std::size_t i = 0; i < tie.axes.size(); ++i)
    rows.block<1, 3>(static_cast<Eigen::Index>(i), tie.axes[i].turns ? 3 : 0) =
        tie.axes[i].r.transpose();
  return rows;
}

bool closes(const Scene& scene) {
  // Groups of coupled nodes; the ground is the last one.
  std::vector<std::size_t> group(scene.nodes.size() + 1);
  std::iota(group.begin(), group.end(), std::size_t{0});
  const auto of = [&](int node) { return node < 0 ? group.back() : group[at(node)]; };
  for (const Tie& t : scene.ties) {
    const std::size_t a = of(t.a.node), b = of(t.b.node);
    if (a == b) return true;
    for (std::size_t& g : group)
      if (g == a) g = b;
  }
  return false;
}

std::vector<int> output_blocks(const Scene& scene) {
  std::vector<int> blocks;
  for (const Reading& r : scene.outputs) {
    if (r.measured == Reading::Measured::out)
      blocks.insert(blocks.end(), at(size_of(scene, r)), 1);
    else
      add_blocks(blocks, size_of(scene, r));
  }
  return blocks;
}

std::vector<int> input_blocks(const Scene& scene) {
  std::vector<int> blocks;
  for (const int size : scene.inputs) add_blocks(blocks, size);
  return blocks;
}

}  // namespace wild
