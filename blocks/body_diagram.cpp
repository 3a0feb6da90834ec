#include <titop/blocks/flexible_body.hpp>

namespace titop {

Diagram diagram_of_body(const ModalData& data, const std::string& name) {
  Diagram d{name};
  auto body = d.add(name, FlexibleBody{data});
  body.parent.accel = d.input("a_P", 6);
  d.output("F_P", 6) = body.parent.force;
  for (const ModalChild& child : data.children) {
    body.child(child.name).force += d.input("F_" + child.name, 6);
    d.output("a_" + child.name, 6) = body.child(child.name).accel;
  }
  for (const ModalLine& line : data.lines)
    for (const LineShape& shape : line.shapes) {
      const std::string channel = channel_of(line, shape);
      const DualPort<1> port = body.line(line.name).shape(shape);
      port.force += d.input("F_" + channel);
      d.output("a_" + channel) = port.accel;
    }
  return d;
}

}  // namespace titop
