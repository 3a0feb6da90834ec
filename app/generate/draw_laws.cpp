#include "generate/draw_laws.hpp"

#include <algorithm>

namespace titop::generate {

void draw_small_law(Dice& dice, Control& c) {
  const bool acceleration = c.law == Control::Law::acceleration;
  const int n = dice.between(1, 2);
  const Ratio decay = dice.octaves(-1, 4);
  c.A.assign(static_cast<std::size_t>(n), std::vector<Ratio>(static_cast<std::size_t>(n)));
  c.B.assign(static_cast<std::size_t>(n), {Ratio(1)});
  c.C.assign(1, {});
  for (int i = 0; i < n; ++i) {
    const auto k = static_cast<std::size_t>(i);
    c.A[k][k] = -decay;
    c.B[k][0] = dice.fraction();
    c.C[0].push_back(dice.fraction() * Ratio(acceleration ? 1 : 64, 8));
  }
  if (n == 2) c.A[0][1] = dice.fraction(), c.A[1][0] = -c.A[0][1];
  c.D = {{acceleration ? dice.octaves(-3, 1) : dice.octaves(0, 4)}};
}

void draw_dense_law(Dice& dice, Control& c, int states, const Ratio& gain, const Ratio& direct) {
  const auto n = static_cast<std::size_t>(states), m = c.at.size();
  const auto matrix = [&](std::size_t rows, std::size_t cols, const Ratio& size) {
    RatioMatrix M(rows, std::vector<Ratio>(cols));
    for (auto& row : M)
      for (Ratio& x : row) x = dice.fraction() * size;
    return M;
  };
  c.A = matrix(n, n, 4);
  const int kind = dice.below(4);
  const std::size_t chain = std::min(n, static_cast<std::size_t>(dice.between(1, 2)));
  for (std::size_t i = 0; i < n; ++i) {
    if (kind < 2) c.A[i][i] = c.A[i][i] - Ratio(4 * states, kind == 0 ? 1 : 2);
    if (kind == 2) c.A[i][i] = c.A[i][i] + Ratio(2 * states);
    if (kind != 3 || i >= chain) continue;
    c.A[i].assign(n, Ratio(0));  // poles at 0: integrators, one after the other
    if (i > 0) c.A[i][i - 1] = 2;
  }
  c.B = matrix(n, m, 1), c.C = matrix(m, n, gain), c.D = matrix(m, m, direct * Ratio(1, 2));
  for (std::size_t i = 0; i < m; ++i)
    for (std::size_t j = 0; j <= i; ++j) c.D[i][j] = i == j ? direct : -c.D[j][i];
}

}  // namespace titop::generate
