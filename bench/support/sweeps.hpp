#pragma once

#include <complex>
#include <functional>
#include <string>
#include <titop/titop.hpp>
#include <vector>

/// Scenes with one quantity at extreme values: the data of the failure charts.
namespace titop_bench {

/// One value of a sweep: a scene, its test points s, and the exact transfers there.
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
  /// Approximate relative error of the answer per unit of the last place in the data, at this
  /// value: no method that reads the data can do better. 0 if negligible.
  std::function<double(double)> inherent = [](double) { return 0.0; };
};

std::vector<Sweep> sweeps();

}  // namespace titop_bench
