#pragma once

#include <memory>
#include <string>
#include <titop/compiler/certificate/dense_check.hpp>
#include <titop/compiler/minreal/minimize.hpp>
#include <titop/graph/state_space.hpp>
#include <utility>
#include <vector>

namespace titop::detail {

struct SystemData;

/// Result of `dense`: A, B, C, D as written from the factors.
struct Realization {
  std::shared_ptr<const StateSpace> model;
  double against_factors = -1;  ///< Certificate::dense_against_factors
  DenseError error{{-1}, {-1}};
  std::vector<Note> notes = {};
};

/// Result of `minimize`: the realization's own model if nothing is removed.
struct Minimal {
  std::shared_ptr<const StateSpace> model;
  OrderVerdict order = {};
  std::vector<Note> notes = {};
};

/// The dense models of a system.
struct DenseModel {
  Realization written;
  Minimal minimal;
  std::vector<std::pair<std::string, double>> seconds = {};  ///< per pass
};

/// All passes on dense models, in the order of the table in pipeline.cpp.
DenseModel dense_model(const SystemData& data);

}  // namespace titop::detail
