#pragma once

#include <complex>
#include <functional>
#include <string>
#include <titop/titop.hpp>
#include <vector>

/// Scenes of which one quantity goes to an extreme: what the failure charts are drawn over.
namespace titop_bench {

/// One value of a sweep: a scene, where it is looked at, and what is right there.
struct Extreme {
  titop::Diagram diagram;
  std::vector<std::complex<double>> s;
  std::vector<Eigen::MatrixXcd> exact = {};  ///< none: by oracle_transfer
  int minimize_up_to = 0;                    ///< Options::minimize_up_to
};

struct Sweep {
  std::string name;      ///< of the chart's file
  std::string title;     ///< of the chart
  std::string quantity;  ///< below its axis
  std::vector<double> values;
  std::function<Extreme(double)> at;
  /// About what one unit of the last place in the data makes of the answer, at this value: nothing
  /// that reads the data can do better. 0 where that is nothing to speak of.
  std::function<double(double)> inherent = [](double) { return 0.0; };
};

std::vector<Sweep> sweeps();

}  // namespace titop_bench
