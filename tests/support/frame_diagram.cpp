#include "loops/frame_diagram.hpp"

namespace loops_test {
namespace {

struct FrameDiagram {
  FrameScene scene;
  const Frame& f = scene.frame;
  titop::Diagram d{"frame"};
  std::vector<titop::BodyHandle> handles = {};  ///< of the bodies

  titop::BodyHandle add(int i) {
    const Frame::Body& b = f.bodies[at(i)];
    if (b.beam) return d.add(f.names[at(i)], titop::FlexibleBody{b.tube().beam()});
    titop::RigidBody body{.mass = b.mass, .inertia = b.inertia(), .PA = b.PA};
    for (const Frame::Joint& j : f.joints) {
      if (j.b == i) body.children.push_back({"b" + j.name, b.here(j.X)});
      if (j.a == i && j.closes) body.children.push_back({"a" + j.name, b.here(j.X)});
    }
    for (const Frame::Bushing& k : f.bushings)
      if (k.a == i || k.b == i) body.children.push_back({k.name, b.here(k.X)});
    body.children.push_back({"E", b.here(b.E)});
    return d.add(f.names[at(i)], body);
  }
  titop::DualPort<6> point(int i, const std::string& name) const {
    return f.bodies[at(i)].beam ? titop::DualPort<6>(handles[at(i)].child)
                                : handles[at(i)].child(name);
  }

  /// A joint's axes in another frame, each with a name.
  static std::vector<titop::Axis> axes_of(const Frame::Joint& j, const Matrix3d& to) {
    std::vector<titop::Axis> result;
    for (const Frame::JointAxis& a : j.axes)
      result.push_back({a.axis.kind, to * a.axis.direction, "q" + std::to_string(result.size())});
    return result;
  }
  void drive_axes(const titop::Joint::Handle& h, const Frame::Joint& j) const {
    using Mode = Frame::JointAxis::Mode;
    int number = 0;
    for (const Frame::JointAxis& a : j.axes) {
      const auto q = h.axis("q" + std::to_string(number++));
      if (a.mode == Mode::locked)
        q.accel = 0;
      else if (a.mode == Mode::free)
        q.force = 0;
      else
        q.force = a.stiffness * q.position + kDamping * a.stiffness * q.rate;
    }
  }
  titop::Rotation between(int a, int b) const {
    const Matrix3d to_b = b == kGround ? Matrix3d::Identity() : Matrix3d(f.bodies[at(b)].R);
    return titop::Rotation::matrix(to_b.transpose() * f.bodies[at(a)].R);
  }
  void hang(const Frame::Joint& j) {
    const titop::DualPort<6> site = point(j.b, "b" + j.name);
    const titop::BodyHandle& body = handles[at(j.a)];
    if (j.axes.empty()) return mount(body, site, between(j.a, j.b));
    const Matrix3d to_a = f.bodies[at(j.a)].R.transpose();
    drive_axes(joint(d, j.name, body, site, between(j.a, j.b), axes_of(j, to_a)), j);
  }
  /// The joint has the frame of b, or the world's.
  void close(const Frame::Joint& j) {
    const titop::DualPort<6> on_a = point(j.a, "a" + j.name);
    const bool to_ground = j.b == kGround;
    if (j.axes.empty())
      return to_ground ? ground(on_a) : weld(on_a, point(j.b, "b" + j.name), between(j.a, j.b));
    const Matrix3d R = to_ground ? Matrix3d::Identity() : Matrix3d(f.bodies[at(j.b)].R);
    const auto h = d.add(j.name, titop::Joint{axes_of(j, R.transpose())});
    mount(h, on_a, titop::Rotation::matrix(f.bodies[at(j.a)].R.transpose() * R));
    drive_axes(h, j);
    to_ground ? ground(h.child) : weld(h.child, point(j.b, "b" + j.name));
  }

  void add(const Frame::SpringMass& m) {
    const auto mass = d.add(
        m.name, titop::SpringMass{
                    .mass = m.mass, .stiffness = m.stiffness, .damping = kDamping * m.stiffness});
    mount(mass, point(m.body, "E").along(f.bodies[at(m.body)].R.transpose() * m.direction));
  }
  void add(const Frame::Bushing& k) {
    const auto h = d.add(k.name, titop::Bushing{.stiffness = k.K, .damping = kDamping * k.K});
    mount(h, point(k.a, k.name));
    k.b == kGround ? ground(h.child) : weld(h.child, point(k.b, k.name), between(k.a, k.b));
  }

  titop::Diagram build() {
    for (int i = 0; i < static_cast<int>(f.bodies.size()); ++i) handles.push_back(add(i));
    if (scene.driven)
      handles[0].parent.accel = d.input("A", 6);
    else
      f.grounded ? ground(handles[0]) : release(handles[0]);
    for (const Frame::Joint& j : f.joints) j.closes ? close(j) : hang(j);
    for (const Frame::SpringMass& m : f.spring_masses) add(m);
    for (const Frame::Bushing& k : f.bushings) add(k);
    const auto U = d.input("U", 6);
    point(f.pushed, "E").force += U;
    d.output("pushed", 6) = point(f.pushed, "E").accel;
    d.output("watched", 6) = point(f.watched, "E").accel;
    if (scene.read >= 0)
      d.output("force", 6) = handles[at(f.joints[at(scene.read)].a)].parent.force;
    return std::move(d);
  }
};

}  // namespace

titop::Diagram diagram_of(const FrameScene& scene) { return FrameDiagram{scene}.build(); }

}  // namespace loops_test
