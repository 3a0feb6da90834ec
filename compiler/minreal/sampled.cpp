#include <cmath>
#include <titop/compiler/minreal/sampled.hpp>
#include <titop/graph/linalg/rounding.hpp>
#include <titop/graph/support/steady_random.hpp>

namespace titop::detail {

using Eigen::Index;
using Eigen::MatrixXd;

Sampled sampled(const StateSpace& model, const StateSpace& rounding) {
  Sampled s{model, {}};
  for (int i = 1; i <= kSamples; ++i) {
    detail::SteadyRandom random(i);
    StateSpace off = model;
    const auto add = [&](MatrixXd& m, const MatrixXd& sizes) {
      for (Index c = 0; c < m.cols(); ++c)
        for (Index r = 0; r < m.rows(); ++r)
          m(r, c) +=
              (sizes.size() ? sizes(r, c) : linalg::kEpsilon * std::abs(m(r, c))) * random.unit();
    };
    add(off.A, rounding.A);
    add(off.B, rounding.B);
    add(off.C, rounding.C);
    add(off.D, rounding.D);
    s.off.push_back(std::move(off));
  }
  return s;
}

void clear_rounding(Sampled& s) {
  for (MatrixXd StateSpace::*part : {&StateSpace::A, &StateSpace::B, &StateSpace::C}) {
    MatrixXd& entries = s.model.*part;
    entries = cleared(
        entries, rounding_of(s.off, entries, [&](const StateSpace& off) { return off.*part; }));
  }
}

MatrixXd jittered(MatrixXd T, int sample) {
  detail::SteadyRandom random(kSamples + 1 + sample);
  for (Index c = 0; c < T.cols(); ++c)
    for (Index r = 0; r < T.rows(); ++r) T(r, c) *= 1 + 4 * linalg::kEpsilon * random.unit();
  return T;
}

}  // namespace titop::detail
