#include <fmt/format.h>

#include <titop/graph/nodes/gain.hpp>
#include <titop/graph/opened.hpp>

namespace titop {
namespace {

constexpr std::string_view kLoopPoint = "LoopPoint";

/// y = D u with every port plain.
class Algebraic : public Block {
 public:
  Algebraic(std::string_view type, Interface face, Eigen::MatrixXd D, Value scale = 1)
      : type_(type), face_(std::move(face)), D_(std::move(D)), scale_(scale) {}
  std::string_view type() const override { return type_; }
  const Interface& interface() const override { return face_; }
  std::shared_ptr<const Dynamics> dynamics(ParameterValues values) const override {
    const auto ny = D_.rows(), nu = D_.cols();
    return std::make_shared<Dynamics>(Dynamics{Eigen::MatrixXd(0, 0), Eigen::MatrixXd(0, nu),
                                               Eigen::MatrixXd(ny, 0), scale_.at(values) * D_});
  }
  std::vector<Value> values() const override { return {scale_}; }
  /// z = in, one pair per scalar.
  std::optional<Opened> opened(ParameterValues values,
                               std::span<const int> parameters) const override {
    std::vector<OpenedPair> pairs;
    const auto n = D_.cols();
    for (Eigen::Index i = 0; i < n; ++i)
      pairs.push_back({scale_, {}, D_.col(i), {}, Eigen::RowVectorXd::Unit(n, i)});
    return with_pairs(*dynamics(values), pairs, parameters);
  }
  bool is_algebraic() const override { return true; }
  bool has_frame() const override { return false; }

 private:
  std::string_view type_;
  Interface face_;
  Eigen::MatrixXd D_;
  Value scale_;
};

}  // namespace

Gain::Handle::Handle(Graph* graph, int node)
    : in(detail::SignalRef(graph, detail::port_signal(*graph, node, "in"))),
      out(graph, detail::port_signal(*graph, node, "out")) {}

BlockPtr as_block(const Gain& spec) {
  if (spec.size < 1)
    throw Error(Code::size, fmt::format("a Gain of size {}", spec.size),
                "give it a size of 1 or more");
  return std::make_shared<Algebraic>("Gain",
                                     Interface{{}, {{"in", spec.size}}, {{"out", spec.size}}, {}},
                                     Eigen::MatrixXd::Identity(spec.size, spec.size), spec.gain);
}

BlockPtr as_block(const MatrixGain& spec) {
  if (spec.matrix.size() == 0)
    throw Error(Code::size, "a MatrixGain without entries", "give it a matrix of at least 1 x 1");
  return std::make_shared<Algebraic>("MatrixGain",
                                     Interface{{},
                                               {{"in", static_cast<int>(spec.matrix.cols())}},
                                               {{"out", static_cast<int>(spec.matrix.rows())}},
                                               {}},
                                     spec.matrix);
}

BlockPtr as_block(const LoopPoint& spec) {
  if (spec.size < 1)
    throw Error(Code::size, fmt::format("a LoopPoint of size {}", spec.size),
                "give it a size of 1 or more");
  return std::make_shared<Algebraic>(kLoopPoint,
                                     Interface{{}, {{"in", spec.size}}, {{"out", spec.size}}, {}},
                                     Eigen::MatrixXd::Identity(spec.size, spec.size));
}

bool is_loop_point(const Block& block) { return block.type() == kLoopPoint; }

Port<0, Kind::plain> Sum::Handle::in(int i) const {
  return Port<0, Kind::plain>(
      detail::SignalRef(graph_, detail::port_signal(*graph_, node_, fmt::format("in{}", i))));
}

BlockPtr as_block(const Sum& spec) {
  if (spec.size < 1 || spec.signs.empty())
    throw Error(Code::size, "a Sum without inputs", "give it a size and at least one sign");
  Interface face{{}, {}, {{"out", spec.size}}, {}};
  Eigen::MatrixXd D(spec.size, spec.size * static_cast<Eigen::Index>(spec.signs.size()));
  for (std::size_t i = 0; i < spec.signs.size(); ++i) {
    if (spec.signs[i] != '+' && spec.signs[i] != '-')
      throw Error(Code::bad_value, fmt::format("Sum: sign '{}' is not + or -", spec.signs[i]),
                  "write one + or - per input, as Sum{.signs = \"+-\"}");
    face.inputs.push_back({fmt::format("in{}", i + 1), spec.size});
    D.middleCols(static_cast<Eigen::Index>(i) * spec.size, spec.size) =
        (spec.signs[i] == '+' ? 1.0 : -1.0) * Eigen::MatrixXd::Identity(spec.size, spec.size);
  }
  return std::make_shared<Algebraic>("Sum", std::move(face), std::move(D));
}

}  // namespace titop
