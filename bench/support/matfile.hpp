#pragma once

#include <Eigen/SparseCore>
#include <fstream>
#include <string>

namespace titop_bench {

/// Writes variables to a MAT-file of level 4, which Octave loads: per matrix a header of five
/// integers, the name, the numbers.
class MatFile {
 public:
  explicit MatFile(const std::string& path);
  void add(const std::string& name, const Eigen::MatrixXd& matrix);
  void add(const std::string& name, const Eigen::SparseMatrix<double>& matrix);

 private:
  void put(const std::string& name, const Eigen::MatrixXd& matrix, int kind);
  std::ofstream out_;
};

}  // namespace titop_bench
