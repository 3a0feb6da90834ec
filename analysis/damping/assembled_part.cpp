#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <set>
#include <titop/analysis/damping/assembled_part.hpp>
#include <titop/analysis/reduction/whole.hpp>
#include <titop/blocks/specified.hpp>
#include <titop/compiler/system/compile_graph.hpp>
#include <titop/graph/closed_form.hpp>
#include <titop/graph/linalg/index.hpp>
#include <titop/graph/support/some_names.hpp>

namespace titop::detail {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;
using linalg::at;

/// Digits of an eigenproblem of numbers that an elimination has computed.
constexpr double kDigits = 12;
/// Of a port's sensitivity to all modes: less is rounding (by symmetry no force moves the mode);
/// and of the sensitivity of all ports: less is rounding (no mode moves the port in this
/// direction).
constexpr double kSeen = 1e-10;

[[noreturn]] void refuse(const std::string& message, const std::string& hint,
                         std::vector<std::string> details = {}) {
  throw Error(Code::bad_value, message, hint, std::move(details));
}

/// "boom.parent", "tip.C1".
std::string port_name(const Graph& g, const Channel& c) {
  const Node& n = g.nodes[at(c.node)];
  return n.name + "." + n.block->interface().channels[at(c.spec)].name;
}

/// Index of the channel of this name; throws unknown_name.
int find_port(const Graph& g, const std::string& name) {
  std::vector<std::string> valid;
  for (const Channel& c : g.channels) {
    if (port_name(g, c) == name) return static_cast<int>(&c - g.channels.data());
    if (c.size == 6) valid.push_back(port_name(g, c));
  }
  throw Error(Code::unknown_name, fmt::format("{} has no port {}", g.name, name),
              fmt::format("take one of {}", some_names(valid)));
}

/// Refuses an equation that drives one of these signals.
void refuse_driven(const Graph& g, std::initializer_list<int> signals, const std::string& message,
                   const char* hint) {
  for (const Equation& e : g.equations)
    if (std::ranges::find(signals, e.target) != signals.end())
      refuse(message, hint, {fmt::format("its equation is at {}", to_string(e.where))});
}

int find_root(const Graph& g, const std::string& name) {
  const int c = find_port(g, name);
  const Channel& root = g.channels[at(c)];
  if (root.takes != Takes::accel || root.size != 6)
    refuse(fmt::format("{} is no root: it is no parent port of six degrees of freedom", name),
           "take the parent port of the body by which the part hangs");
  refuse_driven(g, {root.accel, root.force}, fmt::format("the root {} is driven", name),
                "leave it free: the scene drives it where the body is mounted; the diagram "
                "contains the part alone");
  return c;
}

int find_child(const Graph& g, const std::string& name) {
  const int c = find_port(g, name);
  const Channel& child = g.channels[at(c)];
  if (child.takes != Takes::force || child.size != 6)
    refuse(fmt::format("{} is no child port of six degrees of freedom", name),
           "take a child port of a body; a joint that the scene drives stays outside of the part");
  refuse_driven(g, {child.accel}, fmt::format("the motion of port {} is imposed", name),
                "impose it at the body's child");
  return c;
}

/// The part with its ports as inputs and outputs: wrenches at the children and the acceleration of
/// the root; accelerations of the children and the wrench at the root.
Diagram with_ports(const Diagram& part, const std::string& root,
                   const std::vector<AssemblyPort>& ports) {
  const Graph& g = part.graph();
  for (const auto& [kind, names] :
       {std::pair{"input", g.inputs.empty() ? "" : g.inputs[0].name},
        std::pair{"output", g.outputs.empty() ? "" : g.outputs[0].name}})
    if (!names.empty())
      refuse(fmt::format("{} has the {} {}", g.name, kind, names),
             "a body has ports alone: connect inputs and outputs at its children in the scene");
  Diagram d = part.clone();
  const auto dual = [&](Graph* graph, int channel) {
    const Channel& c = graph->channels[at(channel)];
    return DualPort<6>(graph, c.accel, c.force);
  };
  std::set<std::string> names;
  for (const AssemblyPort& p : ports) {
    const int channel = find_child(g, p.port);
    if (!names.insert(p.name).second)
      throw Error(Code::duplicate_name, fmt::format("two ports of {} are named {}", g.name, p.name),
                  "name each child once");
    const InputRef wrench = d.input("wrench at " + p.name, 6);
    const DualPort<6> child = dual(wrench.graph(), channel);
    child.force += wrench;
    d.output("motion of " + p.name, 6) = child.accel;
  }
  const int channel = find_root(g, root);
  const InputRef motion = d.input("motion of the root", 6);
  const DualPort<6> parent = dual(motion.graph(), channel);
  parent.accel = motion;
  d.output("wrench at the root", 6) = parent.force;
  return d;
}

struct CompiledPart {
  std::shared_ptr<const SystemData> data;
  Whole modes;
};

[[noreturn]] void refuse_loose(const Diagram& d, std::span<const std::string> states) {
  refuse(
      fmt::format("{} moves without stiffness at {}", d.name(), some_names(states)),
      "give a joint a spring or lock it (= 0); a joint that the scene drives stays outside of the "
      "part");
}

/// True if an equation drives the motion of a child point. Free joints of a closed chain may move
/// as others with springs make them.
bool closes_chains(const Graph& g) {
  return std::any_of(g.equations.begin(), g.equations.end(), [&](const Equation& e) {
    const Signal& target = g.signals[at(e.target)];
    return target.channel >= 0 && g.channels[at(target.channel)].takes == Takes::force &&
           g.channels[at(target.channel)].accel == e.target;
  });
}

/// States that the compiler has removed, as nothing reads them: those of free joints.
std::vector<std::string> removed_states(const Graph& g, const std::vector<std::string>& kept) {
  if (closes_chains(g)) return {};
  const std::set<std::string> all(kept.begin(), kept.end());
  std::vector<std::string> removed;
  for (const Node& n : g.nodes)
    for (const std::string& state : n.block->interface().states)
      if (std::string name = n.name + "." + state; !all.contains(name))
        removed.push_back(std::move(name));
  return removed;
}

CompiledPart compile_part(const Diagram& d) {
  require_state_space(d.graph());
  CompiledPart c{compile_graph(d.graph(), {.minimize_up_to = 0}), {}};
  const System system(c.data);
  for (const Note& n : system.notes())
    if (n.kind == Note::Kind::removed && n.pass == "split")
      refuse(fmt::format("{} is not connected to the root or a port of {}",
                         n.text.substr(0, n.text.find(':')), d.name()),
             "mount it, or remove it from the part");
  if (const auto loose = removed_states(d.graph(), c.data->layout().states); !loose.empty())
    refuse_loose(d, loose);
  try {
    const Coordinates q = coordinates(system, *c.data);
    if (q.n_elastic < q.size()) refuse_loose(d, std::span(q.names).subspan(at(q.n_elastic)));
    c.modes = whole(system, q, std::vector<char>(system.outputs().size(), 0));
  } catch (const NoStructure& error) {
    const Mistake& m = error.mistakes().front();
    refuse(fmt::format("{} has no modes of an undamped structure: {}", d.name(), m.message),
           "keep controllers, momenta and dampers without a spring outside of the part: connect "
           "them to the body's ports in the scene",
           m.details);
  }
  return c;
}

/// Largest radius of gyration about the root [m]; 1 if no mass is off it.
double radius(const Whole& w) {
  const Vector6 mass = -w.D0.bottomRightCorner<6, 6>().diagonal();
  const double square = mass.tail<3>().maxCoeff() / mass.head<3>().mean();
  return square > 0 && std::isfinite(square) ? std::sqrt(square) : 1;
}

/// Sizes of the columns of b (modes x ports, six columns a port, the root last), as shares of those
/// of all children, or of the root: in one unit, rotations and moments at this radius.
VectorXd shares_of_ports(const MatrixXd& b, double radius) {
  VectorXd size = b.colwise().norm();
  const Index root = size.size() - 6;
  for (Index j = 0; j < size.size(); ++j)
    if (j % 6 >= 3) size(j) *= j < root ? radius : 1 / radius;
  size.head(root).normalize();
  size.tail(6).normalize();
  return size;
}

/// Scales of the ports' columns, by which they compare; 0: its inputs move, and its outputs read,
/// no mode beyond rounding (a hinge moves no point along its axis).
VectorXd scales_of_ports(const Whole& w) {
  const MatrixXd read = w.ca.transpose();
  const VectorXd share_moved = shares_of_ports(w.b, radius(w)),
                 share_read = shares_of_ports(read, radius(w));
  VectorXd scale(w.b.cols());
  for (Index j = 0; j < scale.size(); ++j) {
    const double size = w.b.col(j).norm();
    const bool seen = share_moved(j) > kSeen || share_read(j) > kSeen;
    scale(j) = !seen ? 0 : size > 0 ? 1 / size : 1;
  }
  return scale;
}

/// W of y = rigid u + W' etadd, etadd = W u - ...: the modes of mass 1. Stiffnesses of parts
/// without modal data are known up to a factor, so that outputs read a mode `mass` times as inputs
/// move it.
MatrixXd mass_normalised(const Whole& w, const std::string& name) {
  const VectorXd scale = scales_of_ports(w);
  MatrixXd W = MatrixXd::Zero(w.b.rows(), w.b.cols());
  for (Index j = 0; j < W.rows(); ++j) {
    const VectorXd moved = w.b.row(j).transpose().cwiseProduct(scale),
                   read = w.ca.col(j).cwiseProduct(scale);
    if (moved.cwiseAbs().maxCoeff() <= kSeen) continue;
    const double mass = moved.dot(read) / moved.squaredNorm();
    if (!(mass > 0) || (read - mass * moved).norm() > kSymmetric * mass * moved.norm())
      refuse(
          fmt::format("{} is not reciprocal: forces at its ports excite the mode at {:.4g} rad/s "
                      "otherwise than their motions show it",
                      name, std::sqrt(w.lambda(j))),
          "keep controllers and gains outside of the part");
    W.row(j) =
        std::sqrt(mass) * (scale.array() > 0).select(w.b.row(j).transpose(), 0.0).transpose();
  }
  return W;
}

/// A child from its rows of the rigid kinematics, in the frame of the root: rows and modes of its
/// own frame are turned.
ModalChild child_at(const AssemblyPort& port, const Matrix6& rigid, const MatrixXd& Phi) {
  const Matrix3d R = rigid.topLeftCorner<3, 3>();  // from the root's frame to the child's
  const Matrix3d arm = R.transpose() * rigid.topRightCorner<3, 3>();
  ModalChild c{port.name, {arm(1, 2), arm(2, 0), arm(0, 1)}, MatrixXd(6, Phi.cols())};
  c.Phi_C.topRows<3>() = R.transpose() * Phi.topRows<3>();
  c.Phi_C.bottomRows<3>() = R.transpose() * Phi.bottomRows<3>();
  Matrix6 expected = tau(-c.PC);
  expected.topRows<3>() = (R * expected.topRows<3>()).eval();
  expected.bottomRows<3>() = (R * expected.bottomRows<3>()).eval();
  const double scale = std::max(1.0, c.PC.norm());
  if ((rigid - expected).cwiseAbs().maxCoeff() > kSymmetric * scale ||
      (R * R.transpose() - Matrix3d::Identity()).cwiseAbs().maxCoeff() > kSymmetric)
    refuse(fmt::format("{} does not follow rigid motions of the root", port.port),
           "the part hangs by its root alone: connect other supports to the body's ports");
  return c;
}

double digits_of(const Graph& g) {
  double digits = kDigits;
  for (const Node& n : g.nodes)
    if (const auto* body = dynamic_cast<const Specified<FlexibleBody::Spec>*>(n.block.get()))
      digits = std::min(digits, body->spec().data->digits);
  return digits;
}

}  // namespace

ModalData assembled_part(const Diagram& part, const std::string& root,
                         const std::vector<AssemblyPort>& ports) {
  const CompiledPart c = compile_part(with_ports(part, root, ports));
  const Whole& w = c.modes;
  const MatrixXd W = mass_normalised(w, part.name());
  ModalData data;
  data.omega = w.lambda.cwiseSqrt();
  data.xi = VectorXd::Zero(data.omega.size());
  data.digits = digits_of(part.graph());
  data.L_P = -W.rightCols<6>();
  const Matrix6 D_P = -w.D0.bottomRightCorner<6, 6>();
  data.D_P = (D_P + D_P.transpose()) / 2;
  for (std::size_t i = 0; i < ports.size(); ++i) {
    const auto first = static_cast<Index>(6 * i);
    data.children.push_back(child_at(ports[i], w.D0.block<6, 6>(first, w.D0.cols() - 6),
                                     W.middleCols<6>(first).transpose()));
  }
  return data;
}

}  // namespace titop::detail
