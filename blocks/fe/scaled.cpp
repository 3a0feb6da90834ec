#include <fmt/format.h>

#include <cmath>
#include <titop/blocks/fe/scaled.hpp>
#include <titop/graph/error.hpp>

namespace titop {

ModalData scaled(ModalData data, const DataUnits& units) {
  const auto [L, M, T] = units;
  for (const double unit : {L, M, T})
    if (!(unit > 0) || !std::isfinite(unit))
      throw Error(Code::bad_value, fmt::format("units of {} m, {} kg, {} s", L, M, T),
                  "give positive numbers: mm is .length = 1e-3");
  const double root = std::sqrt(M);
  data.omega /= T;
  data.L_P.leftCols(data.L_P.cols() / 2) *= root;
  data.L_P.rightCols(data.L_P.cols() / 2) *= root * L;
  Vector6 size;  // D_P(i, j) has the unit size(i) size(j)
  size << Vector3d::Constant(root), Vector3d::Constant(root * L);
  data.D_P = size.asDiagonal() * data.D_P * size.asDiagonal();
  for (ModalChild& child : data.children) {
    child.PC *= L;
    child.Phi_C.topRows(child.Phi_C.rows() / 2) /= root;
    child.Phi_C.bottomRows(child.Phi_C.rows() / 2) /= root * L;
  }
  for (ModalLine& line : data.lines) {
    line.length *= L;
    for (std::size_t i = 0; i < line.shapes.size(); ++i)
      line.Phi.row(static_cast<Eigen::Index>(i)) /= line.shapes[i].component < 3 ? root : root * L;
  }
  return data;
}

}  // namespace titop
