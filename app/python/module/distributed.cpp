#include "signals.hpp"

namespace titop::python {
namespace {

void bind_exact_beam(py::module_& m) {
  py::class_<ExactBeam>(
      m, "ExactBeam",
      "The beam of Beam as its partial differential equations have it, with all of its infinitely "
      "many modes, from P at the origin to C at (length, 0, 0) [m]; damping (mass [1/s], stiffness "
      "[s]). It has no state space: transfer and frequency_response take it.")
      .def(py::init([](double length, const Section& section, const Material& material,
                       const std::pair<double, double>& damping) {
             return ExactBeam{length, section, material, {damping.first, damping.second}};
           }),
           py::kw_only(), "length"_a, "section"_a, "material"_a,
           "damping"_a = std::pair<double, double>(0, 0))
      .def_readonly("length", &ExactBeam::length, "[m]")
      .def_readonly("section", &ExactBeam::section, "Its Section.")
      .def_readonly("material", &ExactBeam::material, "Its Material.")
      .def_property_readonly(
          "damping",
          [](const ExactBeam& b) { return std::pair(b.damping.mass, b.damping.stiffness); },
          "(mass [1/s], stiffness [s]).");
  add_to_diagram<ExactBeam>(m);
  m.def("with_elements", &with_elements, "beam"_a, "elements"_a, "modes"_a = fe::ModeOptions(),
        "The Beam of so many elements with the same damping; modes: which are kept.");
}

void bind_compare(py::module_& m) {
  m.def("compare", py::overload_cast<const System&, const System&, const Scene&>(&compare),
        "finite"_a, "exact"_a, "scene"_a, Unlocked(),
        "How far a model of finitely many modes is from one with distributed bodies, over the "
        "scene's band: an ErrorBound, relative to each pair's largest magnitude (an estimate).");
  m.def("compare", py::overload_cast<const ReducedSystem&, const System&>(&compare), "reduced"_a,
        "exact"_a, Unlocked(), "The same of a reduced model, over the band of its scene.");
}

void bind_reduced_beams(py::module_& m) {
  py::class_<FiniteBeam>(m, "FiniteBeam", "The finite body chosen for an ExactBeam.")
      .def_readonly("name", &FiniteBeam::name, "Of its node.")
      .def_readonly("elements", &FiniteBeam::elements, "Of equal length.")
      .def_readonly("modes", &FiniteBeam::modes, "Kept, clamped at P.")
      .def_readonly("residuals", &FiniteBeam::residuals, "Residual vectors of C and P.");
  py::class_<ReducedBeams>(m, "ReducedBeams",
                           "A reduced model of a scene with distributed beams; printed as a table.")
      .def_readonly("system", &ReducedBeams::system, "The ReducedSystem.")
      .def_readonly("beams", &ReducedBeams::beams, "In the order of the diagram.")
      .def_readonly("error", &ReducedBeams::error, "Of system against the distributed beams.")
      .def_readonly("of_beams", &ReducedBeams::of_beams, "Of system.full, before the reduction.")
      .def("__str__", [](const ReducedBeams& r) { return to_string(r); });
  m.def(
      "reduce_beams",
      [](const Diagram& d, const Scene& scene, int minimize_up_to, const std::string& dump_to,
         double resolution, const std::string& internal_forces, int exact_up_to) {
        const Options options =
            options_of(minimize_up_to, dump_to, resolution, internal_forces, exact_up_to);
        const LockReleased unlocked;
        return reduce_beams(d, scene, options);
      },
      "diagram"_a, "scene"_a, py::kw_only(), "minimize_up_to"_a = 100, "dump_to"_a = "",
      "resolution"_a = 0.0, "internal_forces"_a = "refuse", "exact_up_to"_a = 0,
      "The reduced model of a scene whose beams are ExactBeam, with as many elements and modes of "
      "each as the scene's accuracy needs.");
}

}  // namespace

void bind_distributed(py::module_& m) {
  bind_exact_beam(m);
  bind_compare(m);
  bind_reduced_beams(m);
}

}  // namespace titop::python
