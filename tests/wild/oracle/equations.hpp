#pragma once

#include <array>

#include "wild/oracle/beam.hpp"
#include "wild/oracle/scene.hpp"

/// (P0 + s P1 + s^2 P2) z = R u, y = (Q0 + s Q1 + s^2 Q2) z + E u, of a scene; z: coordinates of
/// all nodes, multipliers, states and signals of controllers.
namespace wild {

using Eigen::Index;

struct Equations {
  using Real = long double;  ///< of data that are doubles: rounding is 2000 times below theirs
  using Matrix = Eigen::Matrix<Real, Eigen::Dynamic, Eigen::Dynamic>;
  /// A signal: of[k] s^k summed, times z, and `in` times u.
  struct Signal {
    std::array<Matrix, 3> of;
    Matrix in;
  };

  explicit Equations(const Scene& scene);

  std::array<Matrix, 3> P, Q;
  Matrix R, E;
  int redundant = 0;
  std::string none;

 private:
  void place();
  void node(int i);
  void body(const Node& n, Index x);
  void controller(const Node& n, Index z);
  void tie(std::size_t i);
  void mechanisms();
  void drop_redundant();
  void outputs();

  Matrix jacobian(const Point& point) const;
  Matrix six(const Matrix3d& T) const;
  /// Row vectors that a wrench on the body at this point adds to the Newton rows: -J' w.
  void push(const Point& point, Index column, const Matrix& wrench);
  Signal read(const Reading& reading);
  Signal sum(const Sum& shares, Index rows);
  void subtract(Index row, const Signal& signal);
  Matrix half(int which) const;

  const Scene& scene_;
  Index n_ = 0, inputs_ = 0;
  std::vector<Index> x_, size_, Q_, z_, lambda_;  ///< places: per node, per tie
  std::vector<Index> input_;
  std::vector<BeamModel> beams_;  ///< per node; empty of other nodes
  /// Constraint rows in P: the row, whether an input drives it.
  struct Held {
    Index row;
    bool given;
  };
  std::vector<Held> held_;
  std::vector<char> undetermined_;  ///< per unknown
};

}  // namespace wild
