#include "support/assembly.hpp"

#include <stdexcept>
#include <titop/graph/linalg/index.hpp>

#include "support/triplets.hpp"

namespace titop_bench {
namespace {

using Eigen::MatrixXd;
using titop::Signal;
using titop::linalg::at;

titop::Modal modal_of(const titop::Node& node, const std::vector<double>& values) {
  const auto d = node.block->dynamics(values);
  if (d->modal) return *d->modal;
  const MatrixXd rigid = d->dense_direct();
  if (node.block->type() != "RigidBody") throw std::logic_error(node.name + " is not a body");
  return {MatrixXd(0, rigid.cols()), rigid, {}, {}};
}

class Assembler {
 public:
  explicit Assembler(const titop::Graph& graph) : g_(graph), values_(nominal_values(graph)) {}

  Assembly operator()() {
    for (const titop::Node& node : g_.nodes) add_body(modal_of(node, values_));
    for (const titop::Equation& e : g_.equations) add_equation(e);
    if (g_.inputs.size() != 1 || g_.outputs.size() != 1)
      throw std::logic_error("a scene has one input and one output");
    for (const titop::Term& t : g_.outputs[0].terms) add_accel(C_, t, 0, 1);
    const int nw = g_.inputs[0].size, nz = g_.outputs[0].size;
    return {sparse(M_, n_, n_),
            sparse(D_, n_, n_),
            sparse(K_, n_, n_),
            sparse(G_, rows_, n_),
            sparse(B_, n_, nw),
            sparse(C_, nz, n_),
            sizes_,
            joints_};
  }

 private:
  /// T = [xd_P; etad]' [D_P, L_P'; L_P, I] [xd_P; etad] / 2.
  void add_body(const titop::Modal& body) {
    const auto modes = static_cast<int>(body.W.rows());
    const MatrixXd L = -body.W.rightCols(6);
    add(M_, -body.rigid.bottomRightCorner(6, 6), n_, n_);
    add(M_, L, n_ + 6, n_), add(M_, L.transpose(), n_, n_ + 6);
    add(M_, MatrixXd::Identity(modes, modes), n_ + 6, n_ + 6);
    add(D_, body.damping.asDiagonal().toDenseMatrix(), n_ + 6, n_ + 6);
    add(K_, body.stiffness.asDiagonal().toDenseMatrix(), n_ + 6, n_ + 6);
    first_.push_back(n_), bodies_.push_back(body), sizes_.push_back(6 + modes);
    n_ += 6 + modes;
  }

  const titop::Channel& channel_of(int signal) const {
    const int c = g_.signals[at(signal)].channel;
    if (c < 0) throw std::logic_error("a scene reads " + name_of(g_, signal));
    return g_.channels[at(c)];
  }

  /// A point's motion by its body's coordinates: that of P, or tau_CP and Phi_C.
  MatrixXd motion(const titop::Channel& c) const {
    const titop::Modal& body = bodies_[at(c.node)];
    MatrixXd J = MatrixXd::Zero(6, sizes_[at(c.node)]);
    if (c.takes == titop::Takes::accel) {
      J.leftCols(6).setIdentity();
    } else {
      J.leftCols(6) = body.rigid.block(g_.signals[at(c.accel)].first, body.rigid.cols() - 6, 6, 6);
      J.rightCols(J.cols() - 6) = body.W.middleCols(g_.signals[at(c.force)].first, 6).transpose();
    }
    return J;
  }

  void add_accel(Triplets& list, const titop::Term& t, int row, double sign) {
    const titop::Channel& c = channel_of(t.signal);
    if (c.accel != t.signal || t.of != titop::Term::Of::signal)
      throw std::logic_error("a scene reads " + name_of(g_, t.signal));
    add(list, sign * coefficient(g_, t, values_) * motion(c), row, first_[at(c.node)]);
  }

  /// An acceleration that is driven is a joint. Wrenches of one body on another follow from it.
  void add_equation(const titop::Equation& e) {
    const titop::Channel& c = channel_of(e.target);
    if (!e.part.whole() || c.size != 6) throw std::logic_error("joints hold all or nothing");
    if (e.target != c.accel) return add_wrenches(e, c);
    add(G_, motion(c), rows_, first_[at(c.node)]);
    for (const titop::Term& t : e.terms) add_accel(G_, t, rows_, -1);
    joints_.push_back(6);
    rows_ += 6;
  }

  /// The wrench of P acts from the body on its surroundings.
  void add_wrenches(const titop::Equation& e, const titop::Channel& c) {
    const double sign = c.takes == titop::Takes::accel ? -1 : 1;
    for (const titop::Term& t : e.terms)
      if (g_.signals[at(t.signal)].role == Signal::Role::external)
        add(B_, sign * motion(c).transpose() * coefficient(g_, t, values_), first_[at(c.node)], 0);
  }

  const titop::Graph& g_;
  std::vector<double> values_;
  std::vector<titop::Modal> bodies_;  ///< of each node
  std::vector<int> first_, sizes_;    ///< of each node: its coordinates
  std::vector<int> joints_;
  Triplets M_, D_, K_, G_, B_, C_;
  int n_ = 0, rows_ = 0;
};

}  // namespace

Assembly assemble(const titop::Diagram& diagram) { return Assembler(diagram.graph())(); }

}  // namespace titop_bench
