#pragma once

namespace titop {

/// A block that keeps its spec, for the diagram file. Spec: SpringMass, RigidBody,
/// Rotor, FlexibleBody::Spec, Bushing, or the axes of a joint.
template <class Spec>
class Specified {
 public:
  virtual const Spec& spec() const = 0;

 protected:
  ~Specified() = default;
};

}  // namespace titop
