#include "wild/oracle/print.hpp"

#include <algorithm>
#include <cmath>
#include <iomanip>
#include <sstream>

namespace wild {

namespace {

std::size_t at(int i) { return static_cast<std::size_t>(i); }

class Printer {
 public:
  explicit Printer(const Scene& scene) : scene_(scene) { out_ << std::setprecision(17); }

  std::string all() {
    for (const Node& n : scene_.nodes) node(n);
    for (const Tie& t : scene_.ties) tie(t);
    for (const Mechanism& m : scene_.mechanisms) {
      out_ << name({m.node, -1}) << ".q" << m.axis + 1 << (m.moves ? ".accel = " : ".force = ");
      if (!m.moves) out_ << m.k << " q + " << m.c << " qd + ";
      sum(m.more);
      out_ << "\n";
    }
    for (const Load& l : scene_.loads) {
      out_ << "wrench on " << name(l.at) << half(l.half) << " = ";
      sum(l.sum);
      out_ << "\n";
    }
    for (const Reading& r : scene_.outputs) {
      out_ << "output ";
      reading(r);
      out_ << "\n";
    }
    return out_.str();
  }

 private:
  std::string name(const Point& p) {
    if (p.node < 0) return "ground";
    const Node& n = scene_.nodes[at(p.node)];
    if (n.kind == Node::Kind::lti) return n.name;
    if (p.site < 0) return n.name + ".parent";
    return n.name + (n.kind == Node::Kind::body ? ".C" + std::to_string(p.site + 1) : ".child");
  }
  static std::string half(int h) { return h == 0 ? "" : h == 1 ? ".linear" : ".angular"; }
  void matrix(const std::string& measured, const MatrixXd& m) {
    out_ << " " << measured << " [";
    for (Eigen::Index i = 0; i < m.rows(); ++i) {
      for (Eigen::Index j = 0; j < m.cols(); ++j) out_ << (j ? " " : i ? "; " : "") << m(i, j);
    }
    out_ << "]";
  }

  void node(const Node& n) {
    out_ << n.name << ":";
    if (n.kind == Node::Kind::mass)
      out_ << " SpringMass mass " << n.m << " stiffness " << n.k << " damping " << n.c
           << " parent_mass " << n.m0;
    if (n.beam)
      beam(*n.beam);
    else if (n.kind == Node::Kind::body && n.omega.size() == 0) {
      out_ << " RigidBody mass " << n.mass;
      matrix("inertia", n.inertia);
      matrix("PA", n.PA.transpose());
    }
    if (n.kind == Node::Kind::body && n.omega.size() > 0) {
      out_ << " FlexibleBody";
      matrix("omega", n.omega.transpose());
      matrix("xi", n.xi.transpose());
      matrix("L_P", n.L_P);
      matrix("D_P", n.D_P);
    }
    for (std::size_t i = 0; i < n.sites.size(); ++i) {
      out_ << "\n    C" << i + 1;
      matrix("PC", n.sites[i].PC.transpose());
      if (n.omega.size() > 0) matrix("Phi", n.sites[i].Phi);
    }
    if (n.kind == Node::Kind::joint) {
      out_ << " Joint";
      for (const Axis& a : n.axes) matrix(a.turns ? "about" : "along", a.r.transpose());
    }
    if (n.kind == Node::Kind::bushing) {
      out_ << " Bushing";
      matrix("stiffness", n.stiffness);
      matrix("damping", n.damping);
    }
    if (n.kind == Node::Kind::lti) {
      constexpr const char* blocks[] = {" Lti", " Gain", " MatrixGain", " Sum"};
      out_ << blocks[static_cast<std::size_t>(n.written)];
      matrix("A", n.A);
      matrix("B", n.B);
      matrix("C", n.C);
      matrix("D", n.D);
      out_ << " in = ";
      sum(n.in);
    }
    out_ << "\n";
  }

  void beam(const Beam& b) {
    out_ << " Beam length " << b.length << " area " << b.area << " I_y " << b.I_y << " I_z "
         << b.I_z << " J " << b.J;
    if (b.I_x > 0) out_ << " I_x " << b.I_x;
    out_ << " E " << b.E << " rho " << b.rho << (b.G > 0 ? " G " : " nu ") << (b.G > 0 ? b.G : b.nu)
         << " elements " << b.elements << " kept " << b.kept;
    const auto list = [&](const char* what, const auto& values) {
      if (!values.empty()) out_ << what;
      for (const auto& x : values) out_ << " " << x;
    };
    list(", residual at", b.residual);
    list(", xi", b.xi);
    out_ << ", parent " << b.parent;
    list(", sites", b.sites);
  }

  void tie(const Tie& t) {
    out_ << name(t.a) << half(t.of == Tie::Of::linear ? 1 : t.of == Tie::Of::angular ? 2 : 0);
    for (const Axis& a : t.axes) matrix(a.turns ? "about" : "along", a.r.transpose());
    out_ << " moves as ";
    if (t.input >= 0)
      out_ << "accel u" << t.input + 1;
    else
      out_ << name(t.b);
    if (t.b.node >= 0 && !one_axis(scene_, t.a)) matrix("T", t.T);
    out_ << "\n";
  }

  void sum(const Sum& s) {
    if (s.empty()) out_ << "0";
    for (std::size_t i = 0; i < s.size(); ++i) {
      if (i > 0) out_ << " +";
      matrix("", s[i].gain);
      out_ << " * ";
      reading(s[i].of);
    }
  }

  void reading(const Reading& r) {
    constexpr const char* names[] = {
        "u",     "accel",   "rate", "position",     "reaction",         "accel", "rate", "position",
        "force", "stretch", "out",  "displacement", "displacement_rate"};
    if (r.measured == Reading::Measured::input) {
      out_ << "u" << r.axis + 1 << " (size " << scene_.inputs[at(r.axis)] << ")";
      return;
    }
    out_ << name(r.at) << ".";
    if (r.measured >= Reading::Measured::axis_accel && r.measured <= Reading::Measured::axis_force)
      out_ << "q" << r.axis + 1 << ".";
    out_ << names[static_cast<std::size_t>(r.measured)] << half(r.half);
  }

  const Scene& scene_;
  std::ostringstream out_;
};

/// Without node i and all that mentions it.
Scene without(const Scene& scene, int i) {
  Scene s = scene;
  const auto gone = [&](const Reading& r) {
    return r.measured != Reading::Measured::input && r.at.node == i;
  };
  const auto sum = [&](Sum& shares) {
    std::erase_if(shares, [&](const Share& share) { return gone(share.of); });
  };
  s.nodes.erase(s.nodes.begin() + i);
  std::erase_if(s.ties, [&](const Tie& t) { return t.a.node == i || t.b.node == i; });
  std::erase_if(s.mechanisms, [&](const Mechanism& m) { return m.node == i; });
  std::erase_if(s.loads, [&](const Load& l) { return l.at.node == i; });
  std::erase_if(s.outputs, gone);
  const auto down = [&](int& node) { node -= node > i; };
  const auto renumber = [&](Sum& shares) {
    sum(shares);
    for (Share& share : shares) down(share.of.at.node);
  };
  for (Node& n : s.nodes) renumber(n.in);
  for (Tie& t : s.ties) down(t.a.node), down(t.b.node);
  for (Mechanism& m : s.mechanisms) down(m.node), renumber(m.more);
  for (Load& l : s.loads) down(l.at.node), renumber(l.sum);
  std::erase_if(s.loads, [](const Load& l) { return l.sum.empty(); });
  for (Reading& r : s.outputs) down(r.at.node);
  return s;
}

/// To one digit, or 1, or 0.
double rounder(double x, int level) {
  if (x == 0) return 0;
  if (level == 0) {
    const double unit = std::pow(10, std::floor(std::log10(std::abs(x))));
    return std::round(x / unit) * unit;
  }
  return level == 1 ? (x > 0 ? 1 : -1) : 0;
}

template <class Visit>
void numbers(Scene& s, const Visit& visit) {
  const auto all = [&](auto& m) {
    for (Eigen::Index i = 0; i < m.size(); ++i) visit(m.data()[i]);
  };
  for (Node& n : s.nodes) {
    if (n.kind == Node::Kind::bushing)
      for (Matrix6d* m : {&n.stiffness, &n.damping})
        if (m->isDiagonal(0)) all(*m);
    if (n.kind == Node::Kind::mass)
      for (double* x : {&n.m, &n.k, &n.c, &n.m0}) visit(*x);
    if (n.beam) {
      Beam& b = *n.beam;
      for (double* x :
           {&b.length, &b.area, &b.I_y, &b.I_z, &b.J, &b.I_x, &b.E, &b.rho, &b.nu, &b.G})
        visit(*x);
      for (double& x : b.xi) visit(x);
    } else if (n.kind == Node::Kind::body && n.omega.size() == 0) {
      visit(n.mass);
      all(n.PA);
    }
    for (VectorXd* v : {&n.omega, &n.xi}) all(*v);
    for (MatrixXd* m : {&n.A, &n.B, &n.C, &n.D}) all(*m);
    for (Share& share : n.in) all(share.gain);
    for (Site& site : n.sites) all(site.Phi), all(site.PC);
  }
  for (Mechanism& m : s.mechanisms) visit(m.k), visit(m.c);
}

/// Without state i of node n.
void drop_state(Node& n, Eigen::Index i) {
  const auto rows = [&](MatrixXd& m) {
    MatrixXd less(m.rows() - 1, m.cols());
    less << m.topRows(i), m.bottomRows(m.rows() - 1 - i);
    m = less;
  };
  const auto cols = [&](MatrixXd& m) {
    MatrixXd t = m.transpose();
    rows(t);
    m = t.transpose();
  };
  rows(n.A), cols(n.A), rows(n.B), cols(n.C);
}

/// The beam with one thing less each: residual vectors, damping, a mode, an element.
std::vector<Beam> simpler(const Beam& beam) {
  std::vector<Beam> list(4, beam);
  list[0].residual.clear();
  list[1].xi.clear();
  if (beam.kept > 0) --list[2].kept;
  Beam& less = list[3];
  const int last = less.elements--;
  for (std::vector<int>* points : {&less.residual, &less.sites})
    for (int& point : *points) point -= point == last;
  less.parent -= less.parent == last;
  const auto bad = [](const Beam& b) {
    return b.elements < 1 || b.kept > 6 * b.elements ||
           std::find(b.sites.begin(), b.sites.end(), b.parent) != b.sites.end();
  };
  std::erase_if(list, bad);
  return list;
}

bool same(const Beam& a, const Beam& b) {
  return a.residual == b.residual && a.xi == b.xi && a.kept == b.kept && a.elements == b.elements;
}

void drop_mode(Node& n) {
  const Eigen::Index modes = n.omega.size() - 1;
  if (modes < 1) return;
  n.omega.conservativeResize(modes);
  n.xi.conservativeResize(modes);
  n.L_P = n.L_P.topRows(modes).eval();
  for (Site& site : n.sites) site.Phi = site.Phi.leftCols(modes).eval();
}

}  // namespace

std::string print(const Scene& scene) { return Printer(scene).all(); }

Scene shrink(Scene scene, const std::function<bool(const Scene&)>& fails, int tries) {
  const auto accept = [&](const Scene& less) {
    if (less.outputs.empty() || tries-- <= 0 || !fails(less)) return false;
    scene = less;
    return true;
  };
  for (bool again = true; again && tries > 0;) {
    again = false;
    for (int i = static_cast<int>(scene.nodes.size()) - 1; i >= 0; --i)
      again |= accept(without(scene, i));
    const auto each = [&](auto list) {
      for (int i = static_cast<int>((scene.*list).size()) - 1; i >= 0; --i) {
        Scene less = scene;
        (less.*list).erase((less.*list).begin() + i);
        again |= accept(less);
      }
    };
    each(&Scene::outputs);
    each(&Scene::loads);
    each(&Scene::mechanisms);
    each(&Scene::ties);
    for (std::size_t n = 0; n < scene.nodes.size(); ++n) {
      for (int k = static_cast<int>(scene.nodes[n].in.size()) - 1; k >= 0; --k) {
        Scene less = scene;
        less.nodes[n].in.erase(less.nodes[n].in.begin() + k);
        if (!less.nodes[n].in.empty()) again |= accept(less);
      }
      for (Eigen::Index k = scene.nodes[n].A.rows() - 1; k >= 0 && scene.nodes[n].A.rows() > 1;
           --k) {
        Scene less = scene;
        drop_state(less.nodes[n], k);
        again |= accept(less);
      }
      if (scene.nodes[n].beam)
        for (const Beam& beam : simpler(*scene.nodes[n].beam)) {
          Scene less = scene;
          less.nodes[n].beam = beam;
          again |= !same(beam, *scene.nodes[n].beam) && accept(less);
        }
      while (scene.nodes[n].omega.size() > 1) {
        Scene less = scene;
        drop_mode(less.nodes[n]);
        if (!accept(less)) break;
        again = true;
      }
    }
  }
  int count = 0;
  numbers(scene, [&](double&) { ++count; });
  for (int level = 2; level >= 0; --level)
    for (int i = 0; i < count; ++i) {
      Scene less = scene;
      int k = 0;
      bool changed = false;
      numbers(less, [&](double& x) {
        if (k++ != i) return;
        changed = x != rounder(x, level);
        x = rounder(x, level);
      });
      if (changed) accept(less);
    }
  return scene;
}

}  // namespace wild
