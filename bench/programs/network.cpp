#include "support/network.hpp"

#include <fmt/format.h>

#include <cstdlib>
#include <exception>
#include <stdexcept>

#include "generate/draws.hpp"
#include "support/cases.hpp"
#include "support/matfile.hpp"

/// `network SCENE N FILE`: the network for Octave, with some columns V and titop's [A B; C D] V as
/// reference for Octave's result, and titop's response H at 100 frequencies w, one below the other.
namespace titop_bench {
namespace {

using Eigen::MatrixXcd;
using Eigen::MatrixXd;

void write(const std::string& name, int n, const std::string& path) {
  const titop::System system = compile(case_diagram(case_of(name), n), {.minimize_up_to = 0});
  const Network net = network_of(system);
  titop::StateSpace m;
  system.write(m);
  MatrixXd blocks(net.blocks.size(), 3);
  for (Eigen::Index i = 0; i < blocks.rows(); ++i)
    for (Eigen::Index k = 0; k < 3; ++k)
      blocks(i, k) = net.blocks[static_cast<std::size_t>(i)][static_cast<std::size_t>(k)];
  const MatrixXd V = titop::generate::Mersenne(11).matrix(m.A.cols() + m.B.cols(), 3);
  MatrixXd MV(m.A.rows() + m.C.rows(), 3);
  MV.topRows(m.A.rows()) = m.A * V.topRows(m.A.cols()) + m.B * V.bottomRows(m.B.cols());
  MV.bottomRows(m.C.rows()) = m.C * V.topRows(m.A.cols()) + m.D * V.bottomRows(m.B.cols());
  MatFile file(path);
  file.add("n", MatrixXd::Constant(1, 1, n));
  file.add("blocks", blocks);
  file.add("A", net.A), file.add("B", net.B), file.add("C", net.C), file.add("D", net.D);
  file.add("K", net.K), file.add("E", net.E), file.add("F", net.F), file.add("G", net.G);
  file.add("V", V), file.add("MV", MV);
  const std::vector<double> w = frequencies(100);
  const std::vector<MatrixXcd> response = system.frequency_response(w);
  MatrixXcd H(100 * m.C.rows(), m.B.cols());
  for (Eigen::Index i = 0; i < 100; ++i)
    H.middleRows(i * m.C.rows(), m.C.rows()) = response[static_cast<std::size_t>(i)];
  file.add("w", Eigen::VectorXd::Map(w.data(), 100));
  file.add("H_re", H.real()), file.add("H_im", H.imag());
}

}  // namespace
}  // namespace titop_bench

int main(int argc, char** argv) {
  try {
    if (argc != 4) throw std::invalid_argument("network SCENE N FILE");
    titop_bench::write(argv[1], std::atoi(argv[2]), argv[3]);
  } catch (const std::exception& e) {
    fmt::print(stderr, "{}\n", e.what());
    return 1;
  }
}
