#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <titop/titop.hpp>

#include "scenes/two_link_arm.hpp"
#include "support/quick.hpp"

/// Finite models of distributed bodies, in CSV: chart, series, x, y.
///
/// "arm": two links on a free hub, 0 to 50 Hz: the error against the distributed beams (estimate of
/// `compare`) over the number of states, for meshes with all modes, for fine meshes with a few
/// modes, with and without residual vectors, all pairs of the two planes of bending kept whole or
/// one parted, and for the choice of `reduce_beams`. "plates": two halves of a clamped square plate
/// welded along the cut: relative width of the bracket of each frequency over the number of
/// Legendre polynomials, for displacement and slope each. Returns 1 if a chosen model misses its
/// accuracy, or a bracket the frequency of the uncut plate.
using namespace titop;
using namespace scenes::two_link_arm;

namespace {

void row(const char* chart, const std::string& series, double x, double y) {
  fmt::print("{},{},{:.4g},{:.3e}\n", chart, series, x, y);
  std::fflush(stdout);
}

// --- an arm --------------------------------------------------------------------------------------

void print_finite(const char* series, const System& exact, int elements,
                  const fe::ModeOptions& modes) {
  const System finite = compile(arm_of(elements, modes), {.minimize_up_to = 0});
  row("arm", series, finite.order(), compare(finite, exact, band).worst);
}

void print_modes(const char* series, const System& exact, int elements,
                 const std::vector<int>& kept, fe::ModeOptions modes) {
  for (const int n : kept) {
    modes.kept = n;
    print_finite(series, exact, elements, modes);
  }
}

bool print_chosen(const Diagram& distributed, double accuracy) {
  Scene scene = band;
  scene.accuracy = accuracy;
  const ReducedBeams chosen = reduce_beams(distributed, scene);
  row("arm", "automatic choice", chosen.system.order(), chosen.error.worst);
  return chosen.error.worst <= accuracy;
}

bool print_arm(bool quick) {
  const Diagram distributed = arm(upper, lower);
  const System exact = compile(distributed);
  const std::vector<int> meshes = quick ? std::vector{2, 4} : std::vector{1, 2, 3, 4, 6, 8, 12, 16};
  for (const int n : meshes) print_finite("elements with all modes", exact, n, {});
  const int fine = quick ? 8 : 48;
  // Numbers of modes that part a pair of the two planes of bending have series of their own.
  const std::vector<int> whole = quick ? std::vector{6, 12} : std::vector{4, 6, 9, 12, 24},
                         parted = quick ? std::vector{8} : std::vector{8, 16};
  const fe::ModeOptions with_residuals{.residual = {"C", "P"}};
  print_modes("modes", exact, fine, whole, {});
  if (!quick) print_modes("modes", exact, fine, {48}, {});
  print_modes("modes (a pair parted)", exact, fine, parted, {});
  if (!quick) print_modes("modes (a pair parted)", exact, fine, {32}, {});
  print_modes("modes and residual vectors", exact, fine, whole, with_residuals);
  print_modes("modes and residual vectors (a pair parted)", exact, fine, parted, with_residuals);
  bool good = true;
  const std::vector<double> accuracies =
      quick ? std::vector{1e-1} : std::vector{3e-1, 1e-1, 3e-2, 1e-2, 3e-3, 1e-3, 3e-4, 1e-4};
  for (const double accuracy : accuracies) good &= print_chosen(distributed, accuracy);
  return good;
}

// --- plates --------------------------------------------------------------------------------------

/// omega a^2 sqrt(rho h / D) of a plate of width 1, nu = 0.3.
fe::Mesh plate(double a, int along_x, int along_y) {
  return plate_mesh({.a = a,
                     .b = 1,
                     .thickness = 0.01,
                     .material = {.rho = 100},
                     .D = PlateStiffness{1, 0.3, 1, 0.35},
                     .elements = {along_x, along_y}});
}

fe::Mesh held(const fe::Mesh& mesh) {
  return fe::with_interface(mesh, "root", fe::rigid(fe::edge(mesh, "x0")));
}

Diagram halves(Lumping lumping, int shapes, int along_x, int along_y) {
  const auto line = [&](const fe::Mesh& mesh, const std::string& edge) {
    return lumping == Lumping::constrained
               ? fe::shapes(fe::edge(mesh, edge), fe::legendre(shapes))
               : fe::moments(fe::edge(mesh, edge), fe::legendre(shapes));
  };
  const auto body = [](const fe::Mesh& mesh, const std::string& parent, const std::string& child) {
    return FlexibleBody{
        fe::modal_data(mesh, parent, {child}, {.kept = 30, .residual = {parent, child}})};
  };
  fe::Mesh a = held(plate(0.5, along_x, along_y)), b = plate(0.5, along_x, along_y);
  a = fe::with_interface(a, "next", line(a, "x1"));
  b = fe::with_interface(b, "prev", line(b, "x0"));
  const std::string corner = fmt::format("{},{}", along_x, along_y);
  Diagram d{"halves"};
  auto inner = d.add("inner", body(a, "root", "next")),
       outer = d.add("outer", body(b, "prev", corner));
  ground(inner);
  weld(outer.line("prev"), inner.line("next"));
  outer.child(corner).force += d.input("F", 6);
  d.output("x", 6) = outer.child(corner).position;
  return d;
}

bool print_plates(bool quick) {
  const int along_x = quick ? 3 : 4, along_y = quick ? 4 : 8, modes = 5;
  const fe::Mesh whole = held(plate(1, 2 * along_x, along_y));
  const Eigen::VectorXd uncut = fe::modal_data(whole, "root", {}, {.kept = modes}).omega;
  bool good = true;
  std::vector<InterfaceBracket> brackets;
  for (int shapes = 2; shapes <= (quick ? 3 : 7); ++shapes)
    brackets.push_back(interface_bracket(
        [&](Lumping l) { return halves(l, shapes, along_x, along_y); }, {.modes = modes}));
  for (int k = 0; k < modes; ++k)
    for (std::size_t i = 0; i < brackets.size(); ++i) {
      const InterfaceBracket::Interval& interval = brackets[i].omega[static_cast<std::size_t>(k)];
      // Thirty modes of each half with residual vectors move a frequency by 1e-6.
      good &= interval.below <= uncut(k) * (1 + 1e-6) && interval.above >= uncut(k) * (1 - 1e-6);
      row("plates", fmt::format("mode {}", k + 1), static_cast<double>(i) + 2,
          interval.width() / interval.above);
    }
  return good;
}

}  // namespace

int main(int argc, char** argv) {
  const bool quick = titop_bench::is_quick(argc, argv);
  fmt::print("chart,series,x,y\n");
  const bool arm_is_good = print_arm(quick), plates_are_good = print_plates(quick);
  return arm_is_good && plates_are_good ? 0 : 1;
}
