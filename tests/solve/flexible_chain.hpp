#pragma once

#include <fmt/format.h>

#include <titop/blocks/flexible_body.hpp>
#include <titop/graph/mount.hpp>
#include <vector>

#include "solve/oracle.hpp"

namespace solve_test {

/// Flexible bodies in a row, each with one child "C", free at its root. From the wrench "U" on the
/// root to the accelerations "root" and "tip".
struct FlexibleChain {
  std::vector<titop::ModalData> data;
  std::vector<titop::Matrix3d> T;  ///< from the frame of body i + 1 to that of body i

  /// `turn`: of the next body.
  void add(titop::ModalData body, const titop::Rotation& turn = {}) {
    data.push_back(std::move(body));
    T.push_back(turn.nominal());  // as stored: a Rotation repairs the last digit
  }

  titop::Diagram diagram() const {
    titop::Diagram d{"chain"};
    const auto U = d.input("U", 6);
    std::vector<titop::BodyHandle> body;
    for (std::size_t i = 0; i < data.size(); ++i)
      body.push_back(d.add(fmt::format("b{}", i + 1), titop::FlexibleBody(data[i])));
    body.front().parent.force = -U;
    for (std::size_t i = 1; i < body.size(); ++i)
      mount(body[i], body[i - 1].child, titop::Rotation::matrix(T[i - 1]));
    d.output("root", 6) = body.front().parent.accel;
    d.output("tip", 6) = body.back().child.accel;
    return d;
  }

  /// Its transfer in 150 digits, rounded.
  Eigen::MatrixXcd exact(std::complex<double> s) const {
    std::vector<BigMatrix> Y, rotations;
    for (const titop::ModalData& body : data) Y.push_back(modal_transfer(body, Complex(s)));
    for (const titop::Matrix3d& t : T) {
      Eigen::MatrixXd both = Eigen::MatrixXd::Zero(6, 6);
      both.topLeftCorner(3, 3) = both.bottomRightCorner(3, 3) = t;
      rotations.emplace_back(both);
    }
    return rounded(chain_transfer(Y, rotations, 6));
  }
};

}  // namespace solve_test
