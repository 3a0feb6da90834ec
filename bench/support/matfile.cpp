#include "matfile.hpp"

#include <array>
#include <cstdint>
#include <stdexcept>

namespace titop_bench {

MatFile::MatFile(const std::string& path) : out_(path, std::ios::binary) {
  out_.exceptions(std::ios::failbit | std::ios::badbit);
}

void MatFile::put(const std::string& name, const Eigen::MatrixXd& matrix, int kind) {
  const std::array<std::int32_t, 5> header{
      kind, static_cast<std::int32_t>(matrix.rows()), static_cast<std::int32_t>(matrix.cols()),
      /*imaginary part=*/0, static_cast<std::int32_t>(name.size() + 1)};
  out_.write(reinterpret_cast<const char*>(header.data()), sizeof header);
  out_.write(name.c_str(), header[4]);
  out_.write(reinterpret_cast<const char*>(matrix.data()),
             static_cast<std::streamsize>(sizeof(double)) * matrix.size());
}

void MatFile::add(const std::string& name, const Eigen::MatrixXd& matrix) { put(name, matrix, 0); }

void MatFile::add(const std::string& name, const Eigen::SparseMatrix<double>& matrix) {
  Eigen::MatrixXd triplets(matrix.nonZeros() + 1, 3);  // the last row has the size
  Eigen::Index k = 0;
  for (int j = 0; j < matrix.outerSize(); ++j)
    for (Eigen::SparseMatrix<double>::InnerIterator it(matrix, j); it; ++it)
      triplets.row(k++) << static_cast<double>(it.row() + 1), static_cast<double>(j + 1),
          it.value();
  triplets.row(k) << static_cast<double>(matrix.rows()), static_cast<double>(matrix.cols()), 0;
  put(name, triplets, 2);
}

}  // namespace titop_bench
