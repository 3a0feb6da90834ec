#include <doctest/doctest.h>

#include <cmath>
#include <vector>

#include "support/cut_plate.hpp"

/// The welded halves of tests/fe/lines.cpp on the mesh of a table, which takes a minute.

using Eigen::Index;
using Eigen::VectorXd;
using titop_test::cut_plate;

TEST_CASE("two halves of 8 x 16 elements: a table of another program, and the exact weld between") {
  const std::vector<double> exact = {3.471225, 8.507253, 21.286262, 27.199299, 30.958527};
  struct Row {
    int m;
    std::vector<double> above, below;
  };
  for (const Row& row : {
           Row{2, {3.490581, 8.511057, 21.906331}, {3.470666, 8.227548, 20.127938}},
           Row{3,
               {3.472600, 8.511057, 21.291469, 28.167588, 31.005304},
               {3.470820, 8.227548, 21.258095, 27.015238, 30.924957}},
           Row{4,
               {3.472600, 8.508216, 21.291469, 28.167588, 30.992842},
               {3.470820, 8.448152, 21.258095, 27.015238, 30.951772}},
           Row{5,
               {3.471228, 8.508216, 21.289380, 27.231293, 30.992842},
               {3.471122, 8.448152, 21.278599, 27.143380, 30.951772}},
           Row{6,
               {3.471228, 8.507255, 21.289380, 27.231293, 30.959648},
               {3.471122, 8.489309, 21.278599, 27.143380, 30.956513}},
       }) {
    const VectorXd above = cut_plate(8, 16, 16, row.m, true),
                   below = cut_plate(8, 16, 16, row.m, false);
    for (std::size_t k = 0; k < row.above.size(); ++k) {
      CAPTURE(row.m);
      CAPTURE(k);
      const auto i = static_cast<Index>(k);
      CHECK(std::abs(above(i) - row.above[k]) <=
            6e-7);  // half of the last digit printed, and rounding
      CHECK(std::abs(below(i) - row.below[k]) <= 6e-7);
      CHECK(above(i) >= exact[k] - 5e-7);
      CHECK(below(i) <= exact[k] + 5e-7);
    }
  }
}
