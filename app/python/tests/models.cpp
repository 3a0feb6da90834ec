// The diagrams and models of the C++ examples, and what analyses make of these, for comparison with
// those of examples/python: the examples themselves are compiled here, with a `compile` that also
// writes what it returns, and run.
#include <fmt/format.h>

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>
#include <Eigen/LU>
#include <Eigen/QR>
#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <complex>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <functional>
#include <map>
#include <numbers>
#include <random>
#include <set>
#include <sstream>
#include <string>
#include <titop/titop.hpp>
#include <vector>
#ifdef TITOP_NLOPT
#include <nlopt.hpp>
#include <optional>

#include "by_hand/codesign.hpp"
#endif

#include "by_hand/by_hand.hpp"
#include "scenes/cmg.hpp"
#include "scenes/satellite.hpp"
#include "scenes/satellite_by_hand.hpp"
#include "scenes/sloshing.hpp"
#include "scenes/solar_array.hpp"
#include "scenes/solar_array_drive.hpp"
#include "scenes/telecom.hpp"
#include "scenes/two_link_arm.hpp"
#include "scenes/wheels.hpp"
#include "telecom_law.hpp"

namespace reference {

std::filesystem::path folder;
std::map<std::string, int> seen;
int left = 0;  ///< calls of `compile` before the example is stopped
struct Done {};

/// The numbers of an analysis as one row; none if it refuses the model.
Eigen::MatrixXd row_of(const std::function<std::vector<double>()>& analysis) {
  try {
    const std::vector<double> numbers = analysis();
    return Eigen::Map<const Eigen::RowVectorXd>(numbers.data(),
                                                static_cast<Eigen::Index>(numbers.size()));
  } catch (const titop::Error&) {
    return {};
  }
}

std::vector<double> numbers(const titop::Margins& m) {
  std::vector<double> all{m.disk.alpha, m.disk.omega, m.nearest.value, m.nearest.omega};
  for (const titop::LoopMargins& l : m.loops)
    for (const titop::MarginAt& a : {l.larger_gain, l.smaller_gain, l.phase, l.delay, l.nearest})
      all.insert(all.end(), {a.value, a.omega});
  return all;
}

constexpr int kAnalysed = 60;  ///< states: analyses of more would take minutes

/// A, B, C, D; of up to kAnalysed states H2 and H-infinity norms of the model whose poles are moved
/// left by 1 rad/s, without direct term, so that they are finite; margins of its first output over
/// its first input as L.
std::vector<Eigen::MatrixXd> matrices(const titop::StateSpace& m) {
  if (m.order() > kAnalysed) return {m.A, m.B, m.C, m.D};
  const Eigen::MatrixXd A = m.A - Eigen::MatrixXd::Identity(m.order(), m.order());
  const titop::StateSpace stable{A, m.B, m.C, 0 * m.D};
  const auto h2 = [&] { return std::vector{norm_h2(stable)}; };
  const auto hinf = [&] {
    const titop::HinfNorm norm = norm_hinf(stable);
    return std::vector{norm.value, norm.omega};
  };
  const Eigen::Index rows = std::min<Eigen::Index>(1, m.C.rows()),
                     cols = std::min<Eigen::Index>(1, m.B.cols());
  const titop::StateSpace L{A, m.B.leftCols(cols), m.C.topRows(rows),
                            Eigen::MatrixXd::Zero(rows, cols)};
  const auto margins = [&] { return numbers(titop::margins(L)); };
  return {m.A, m.B, m.C, m.D, row_of(h2), row_of(hinf), row_of(margins)};
}

/// The margins at all loop points, one after the other.
std::vector<double> loop_margins(const titop::System& s) {
  std::vector<double> all;
  for (const std::string& name : loop_points(s)) {
    const std::vector<double> more = numbers(margins(loop(s, name)));
    all.insert(all.end(), more.begin(), more.end());
  }
  return all;
}

/// The same, its loops and the response to a unit step of all inputs, which is checked by an
/// estimate; of distributed bodies, which have no model, a transfer's real and imaginary part.
std::vector<Eigen::MatrixXd> matrices(const titop::System& s) {
  try {
    std::vector<Eigen::MatrixXd> all = matrices(s.state_space());
    if (all.size() == 4) return all;
    all.push_back(row_of([&] { return loop_margins(s); }));
    const auto u = Eigen::VectorXd::Ones(static_cast<Eigen::Index>(s.inputs().size()));
    const titop::Trajectory t =
        simulate(s, titop::Excitation::step(u), {.step = 0.01, .until = 0.5});
    all.insert(all.end(), {t.y, t.error});
    return all;
  } catch (const titop::Error& error) {
    if (error.mistakes().front().code != titop::Code::not_rational) throw;
    const Eigen::MatrixXcd H = s.transfer({2, 60});
    return {H.real(), H.imag()};
  }
}

/// N.json: the diagram; N.bin: sizes and entries of its matrices, column by column.
void write(const titop::Diagram& d, const std::vector<Eigen::MatrixXd>& model) {
  const std::string text = titop::diagram_json(d);
  if (const auto [place, isnew] = seen.try_emplace(text, static_cast<int>(seen.size())); isnew) {
    const std::string name = std::to_string(place->second);
    std::ofstream(folder / (name + ".json"), std::ios::binary) << text;
    std::ofstream file(folder / (name + ".bin"), std::ios::binary);
    for (const Eigen::MatrixXd& matrix : model) {
      const std::int64_t sizes[] = {matrix.rows(), matrix.cols()};
      file.write(reinterpret_cast<const char*>(sizes), sizeof sizes);
      file.write(reinterpret_cast<const char*>(matrix.data()), 8 * matrix.size());
    }
  }
  if (--left == 0) throw Done();
}

titop::System compile(const titop::Diagram& d, const titop::Options& options = {}) {
  titop::System s = titop::compile(d, options);
  write(d, matrices(s));
  return s;
}

titop::ReducedSystem compile(const titop::Diagram& d, const titop::Scene& scene,
                             const titop::Options& options = {}) {
  titop::ReducedSystem s = titop::compile(d, scene, options);
  write(d, matrices(s.state_space()));
  return s;
}

/// Its two scenes.
titop::InterfaceBracket interface_bracket(
    const std::function<titop::Diagram(titop::Lumping)>& scene,
    const titop::BracketOptions& options = {}) {
  for (const auto lumping : {titop::Lumping::constrained, titop::Lumping::released})
    reference::compile(scene(lumping));
  return titop::interface_bracket(scene, options);
}

}  // namespace reference

// Headers that the examples include stand above; with their guards they are empty below.
#define compile ::reference::compile
#define interface_bracket ::reference::interface_bracket
#define main program
namespace e01 {
#include "01_spring_mass.cpp"
}
namespace e02 {
#include "02_five_masses.cpp"
}
namespace e03 {
#include "03_locked_mass.cpp"
}
namespace e04 {
#include "04_spacecraft.cpp"
}
namespace e05 {
#include "05_robot_joint.cpp"
}
namespace e07 {
#include "07_robot_arm.cpp"
}
namespace e08 {
#include "08_see_the_passes.cpp"
}
namespace e10 {
#include "10_parameters.cpp"
}
namespace e11 {
#include "11_closed_chains.cpp"
}
namespace e12 {
#include "12_joints.cpp"
}
namespace e13 {
#include "13_singular_scenes.cpp"
}
namespace e14 {
#include "14_reduction.cpp"
}
namespace e16 {
#include "16_time_response.cpp"
}
namespace e17 {
#include "17_report.cpp"
}
namespace e18 {
#include "18_attitude_loop.cpp"
}
namespace e19 {
#include "19_lft.cpp"
}
#ifdef TITOP_NLOPT
namespace e20 {
#include "20_codesign.cpp"
}
#endif
namespace e21 {
#include "21_worst_case.cpp"
}
namespace e22 {
#include "22_wheels.cpp"
}
namespace e23 {
#include "23_damping.cpp"
}
namespace e24 {
#include "24_cmg.cpp"
}
namespace e25 {
#include "25_solar_array_drive.cpp"
}
namespace e26 {
#include "26_sloshing.cpp"
}
namespace e27 {
#include "27_margins.cpp"
}
namespace e28 {
#include "28_solar_array.cpp"
}
namespace e29 {
#include "29_exact_beam.cpp"
}
namespace e30 {
#include "30_telecom.cpp"
}
namespace demo {
#include "demo.cpp"
}
#undef main

int main(int, char** arguments) {
  const std::filesystem::path all = arguments[1];
  for (const auto& [name, run, count] : {std::tuple{"01_spring_mass", &e01::program, 1},
                                         {"02_five_masses", &e02::program, 4},
                                         {"03_locked_mass", &e03::program, 1},
                                         {"04_spacecraft", &e04::program, 2},
                                         {"05_robot_joint", &e05::program, 4},
                                         {"07_robot_arm", &e07::program, 1},
                                         {"08_see_the_passes", &e08::program, 1},
                                         {"10_parameters", &e10::program, 2},
                                         {"11_closed_chains", &e11::program, 2},
                                         {"12_joints", &e12::program, 2},
                                         {"13_singular_scenes", &e13::program, 3},
                                         {"14_reduction", &e14::program, 1},
                                         {"16_time_response", &e16::program, 1},
                                         {"17_report", &e17::program, 1},
                                         {"18_attitude_loop", &e18::program, 1},
                                         {"19_lft", &e19::program, 1},
#ifdef TITOP_NLOPT
                                         {"20_codesign", &e20::program, 3},
#endif
                                         {"21_worst_case", &e21::program, 1},
                                         {"22_wheels", &e22::program, 7},
                                         {"23_damping", &e23::program, 3},
                                         {"24_cmg", &e24::program, 1},
                                         {"25_solar_array_drive", &e25::program, 1},
                                         {"26_sloshing", &e26::program, 2},
                                         {"27_margins", &e27::program, 1},
                                         {"28_solar_array", &e28::program, 2},
                                         {"29_exact_beam", &e29::program, 7},
                                         {"30_telecom", &e30::program, 4},
                                         {"demo", &demo::program, 2}}) {
    reference::folder = all / name;
    reference::seen.clear();
    std::filesystem::create_directories(reference::folder);
    reference::left = count;
    try {
      run();
    } catch (const reference::Done&) {
      continue;
    }
    std::fprintf(stderr, "%s compiles fewer diagrams than %d\n", name, count);
    return 1;
  }
}
