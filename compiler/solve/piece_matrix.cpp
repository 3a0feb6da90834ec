#include <titop/compiler/solve/null_rows.hpp>
#include <titop/compiler/solve/piece_matrix.hpp>

namespace titop::solve {

Eigen::MatrixXd matrix_of(const Piece& p, const Numbers& numbers) {
  const auto at = [](int i) { return static_cast<std::size_t>(i); };
  const Eigen::MatrixXd right = p.right < 0
                                    ? Eigen::MatrixXd(Eigen::MatrixXd::Identity(p.size, p.size))
                                    : Eigen::MatrixXd(*numbers.coefficients[at(p.right)]);
  const double sign = p.sign;
  switch (p.of) {
    case Piece::Left::one: return sign * right;
    case Piece::Left::direct:
      return sign * numbers.blocks[at(p.left)]->D.block(p.row, p.col, p.rows, p.cols) * right;
    case Piece::Left::state:
      return sign * numbers.blocks[at(p.left)]->C.middleRows(p.row, p.rows) * right;
    case Piece::Left::coefficient: return sign * *numbers.coefficients[at(p.left)] * right;
  }
  return {};
}

Eigen::MatrixXd product(const Eigen::MatrixXd& a, const Eigen::MatrixXd& b) {
  const Eigen::MatrixXd sum = a * b, terms = a.cwiseAbs() * b.cwiseAbs();
  return (sum.array().abs() <= kCancelled * terms.array()).select(0, sum);
}

}  // namespace titop::solve
