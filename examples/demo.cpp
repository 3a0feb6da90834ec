// A satellite from real finite-element data: a rigid hub, two booms read from CalculiX matrices,
// one of them on a hinge with a motor. Described in thirty lines (scenes/satellite.cpp), compiled
// to one state-space model, compared with M and K assembled by hand, drawn and reported. Then the
// hub's attitude is controlled.
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <numbers>
#include <titop/titop.hpp>

#include "by_hand/by_hand.hpp"
#include "scenes/satellite.hpp"
#include "scenes/satellite_by_hand.hpp"

using namespace titop;
using namespace scenes;
using std::numbers::pi;

namespace {

// --- the same by hand ----------------------------------------------------------------------------

bool cross_check(const System& system, const by_hand::Structure& a) {
  std::printf("\nagainst M and K assembled by hand (%ld coordinates)\n",
              static_cast<long>(a.M.rows()));
  std::vector<by_hand::MatrixXcd> scene, dense, hand;
  for (const double w : {0.3, 2.0, 10.0, 100.0, 500.0, 2000.0, 10000.0}) {
    const by_hand::Complex s{0.1 * w, w};
    scene.push_back(system.transfer(s));
    dense.push_back(system.state_space().transfer(s));
    by_hand::MatrixXcd G = by_hand::position_transfer(a, s);
    G.topRows(18) *= s * s;
    hand.push_back(G);
  }
  // Blocks of the definition: three translations or rotations; the angle and the motor by
  // themselves.
  double error = 0, dense_error = 0;
  const auto part = [](const std::vector<by_hand::MatrixXcd>& all, Eigen::Index row,
                       Eigen::Index rows, Eigen::Index col, Eigen::Index cols) {
    std::vector<by_hand::MatrixXcd> result;
    for (const auto& G : all) result.push_back(G.block(row, col, rows, cols));
    return result;
  };
  for (const Eigen::Index row : {0, 18})
    for (const Eigen::Index col : {0, 6}) {
      const Eigen::Index r = row == 18 ? 1 : 3, k = col == 6 ? 1 : 3;
      const Eigen::Index rows = row == 18 ? 1 : 18, cols = col == 6 ? 1 : 6;
      const auto exact = part(hand, row, rows, col, cols);
      error =
          std::max(error, by_hand::transfer_error(part(scene, row, rows, col, cols), exact, r, k));
      dense_error = std::max(
          dense_error, by_hand::transfer_error(part(dense, row, rows, col, cols), exact, r, k));
    }
  bool ok = by_hand::agrees("  transfer", error, 1e-12);
  ok &= by_hand::agrees("  dense model", dense_error, 1e-10);
  ok &= by_hand::agrees(
      "  poles",
      by_hand::pole_error(by_hand::moving(system.poles()), by_hand::poles(by_hand::elastic(a, 6))),
      1e-10);
  const bool same_order = system.state_space().order() == 2 * (a.M.rows() - 6);
  std::printf("  order: %ld %s\n", static_cast<long>(2 * (a.M.rows() - 6)),
              same_order ? "yes" : "NO");
  return ok && same_order;
}

/// Only the hub's rotations get integrators: translation stays as free as it was.
bool control_attitude(const FlexibleBody& boom) {
  const AttitudeLaw law{.kp = 40, .kd = 40};
  const System system = compile(satellite(boom, &law));
  const std::vector<Pole> poles = system.poles();
  std::printf(
      "\nattitude held by %g N m/rad and %g N m s/rad on the hub: order %d, slowest poles\n%s",
      law.kp, law.kd, system.state_space().order(),
      to_string(std::vector<Pole>(poles.begin(), poles.begin() + 5)).c_str());
  by_hand::Structure a = satellite_by_hand(boom.data());
  a.K.diagonal().segment<3>(3).array() += law.kp;
  a.D.diagonal().segment<3>(3).array() += law.kd;
  bool ok = by_hand::agrees(
      "  closed-loop poles against M, D and K",
      by_hand::pole_error(by_hand::moving(poles), by_hand::poles(by_hand::elastic(a, 3))), 1e-10);
  ok &= system.state_space().order() == 2 * (a.M.rows() - 3);
  return ok;
}

// --- pictures ------------------------------------------------------------------------------------

struct Curve {
  const char *output, *input, *label;
};
constexpr std::array<Curve, 4> curves{{{"hub(3)", "W(3)", "hub  [m/s^2 / N]"},
                                       {"tip1(3)", "W(3)", "tip of boom 1  [m/s^2 / N]"},
                                       {"theta", "tau_m", "joint angle  [rad / N m]"},
                                       {"tip2(3)", "tau_m", "tip of boom 2  [m/s^2 / N m]"}}};

void write_bode_data(const System& system) {
  const StateSpace& m = system.state_space();
  std::ofstream csv("bode.csv");
  csv.precision(9);
  csv << "rad_per_s";
  for (const Curve& k : curves)
    csv << ",|" << k.output << "/" << k.input << "|,"
        << "phase [deg]";
  csv << "\n";
  std::array<double, curves.size()> unwrapped{};
  constexpr int points = 3000;
  for (int i = 0; i <= points; ++i) {
    const double w = std::pow(10.0, -0.5 + 4.5 * i / points);
    const Eigen::MatrixXcd G = system.transfer({0, w});
    csv << w;
    for (std::size_t j = 0; j < curves.size(); ++j) {
      const std::complex<double> g = G(m.output(curves[j].output), m.input(curves[j].input));
      const double phase = std::arg(g) * 180 / pi;
      unwrapped[j] = i == 0 ? phase : phase + 360 * std::round((unwrapped[j] - phase) / 360);
      csv << "," << std::abs(g) << "," << unwrapped[j];
    }
    csv << "\n";
  }
}

/// Two columns, one per input; magnitude above phase. Solid and dashed lines of different weight,
/// so that it reads in black and white as well.
void write_bode_script() {
  std::ofstream gp("bode.gp");
  gp << R"(# gnuplot bode.gp: bode.csv to bode.svg
set terminal svg size 1200,760 font "Helvetica,15" background rgb "white"
set output "bode.svg"
set datafile separator ","
set multiplot
set logscale x
set xrange [0.3162:10000]
set mxtics 10
set grid xtics ytics mxtics lt 1 lc rgb "#cccccc" lw 0.7, lt 1 lc rgb "#eeeeee" lw 0.5
set border 3 lw 1.2
set tics nomirror out scale 0.6,0.3
set style line 1 lc rgb "#1d2f3f" lw 2.2 dt 1
set style line 2 lc rgb "#d95f02" lw 1.5 dt (10,4)
)";
  for (std::size_t column = 0; column < 2; ++column) {
    const double left = column == 0 ? 0.075 : 0.575;
    gp << "\nset lmargin at screen " << left << "\nset rmargin at screen " << left + 0.41;
    for (const bool phase : {false, true}) {
      gp << (phase ? R"(
set tmargin at screen 0.44
set bmargin at screen 0.10
unset label 1
unset key
unset logscale y
set yrange [*:*]
set format y "%g"
set format x "10^{%L}"
set ytics 180
set ylabel "phase [deg]" offset 1,0
set xlabel "frequency [rad/s]"
)"
                   : R"(
set tmargin at screen 0.85
set bmargin at screen 0.47
set key at graph 0, 1.04 left bottom Left reverse samplen 4 spacing 1.1
set logscale y
set format y "10^{%L}"
set format x ""
set ylabel "magnitude" offset 1,0
unset xlabel
)");
      if (!phase)
        gp << "set label 1 \"from "
           << (column == 0 ? "the force on the hub along z" : "the motor torque")
           << "\" at graph 0, 1.25 font \",18\"\nset ytics " << (column == 0 ? 10 : 100) << "\n";
      gp << "plot \\\n";
      for (std::size_t k = 0; k < 2; ++k) {
        const std::size_t j = 2 * column + k;
        gp << "  \"bode.csv\" skip 1 using 1:" << 2 + 2 * j + (phase ? 1 : 0) << " with lines ls "
           << k + 1 << " title \"" << curves[j].label << (k == 0 ? "\", \\\n" : "\"\n");
      }
    }
  }
  gp << "unset multiplot\n";
}

/// Writes the report of the model; without Graphviz it has no diagrams.
void report(const System& system) {
  ReportOptions options{.title = "Satellite with two booms",
                        .remark =
                            "Rigid hub, two booms from finite-element data, one of them on a "
                            "hinge with a motor. Written by titop's demo."};
  try {
    write_report(system, "report.html", options);
  } catch (const Error& error) {
    std::fputs(error.what(), stderr);
    options.diagrams = false;
    write_report(system, "report.html", options);
  }
}

/// Runs a drawing program; without it the text files are still there.
void draw(const char* program, const char* command) {
  if (std::system(command) != 0)
    std::fprintf(stderr, "%s is missing or failed: its picture is not drawn\n", program);
}

}  // namespace

int main() {
  const FlexibleBody boom = read_boom();
  std::printf("boom: %.4g kg, %ld modes and residual vectors, first three [Hz] %.5f %.5f %.5f\n\n",
              boom.data().D_P(0, 0), static_cast<long>(boom.data().omega.size()),
              boom.data().omega(0) / (2 * pi), boom.data().omega(1) / (2 * pi),
              boom.data().omega(2) / (2 * pi));

  const Diagram d = satellite(boom);
  const System system = compile(d);
  const StateSpace& model = system.state_space();
  std::printf("%s", (system.log() + system.dense_log()).c_str());
  std::printf("\nmodel: %d states, %zu inputs, %zu outputs; poles\n%s", model.order(),
              model.inputs.size(), model.outputs.size(), to_string(system.poles()).c_str());

  const Certificate cert = system.dense_certificate();
  std::printf("\ncertificate (numbers in certificate.txt)\n");
  bool ok = by_hand::agrees("  every equation as written", cert.residual, 1e-11);
  ok &= by_hand::agrees("  dense model against the factors", cert.dense_against_factors, 1e-12);
  ok &= cross_check(system, satellite_by_hand(boom.data()));
  ok &= control_attitude(boom);

  std::ofstream("certificate.txt") << to_string(cert);
  std::ofstream("satellite.dot") << to_dot(system.stage());
  write_bode_data(system);
  write_bode_script();
  draw("dot", "dot -Tsvg satellite.dot -o satellite.svg 2>dot.log");
  draw("gnuplot", "gnuplot bode.gp 2>gnuplot.log");
  report(system);
  std::printf(
      "\nreport.html: all of this and more, for reading and printing: open it in a browser\n"
      "satellite.dot, satellite.svg: the diagram, by dot\n"
      "bode.csv, bode.gp, bode.svg: the frequency response, by gnuplot\n");
  return ok ? 0 : 1;
}
