#pragma once

#include <string>
#include <titop/compiler/certificate/dense_check.hpp>
#include <titop/compiler/minreal/minimize.hpp>
#include <titop/graph/state_space.hpp>
#include <utility>
#include <vector>

namespace titop::detail {

struct SystemData;

/// The dense model of a system, with all results about it.
struct DenseModel {
  StateSpace model;
  double against_factors = -1;  ///< Certificate::dense_against_factors
  DenseError error{{-1}, {-1}};
  OrderVerdict order;
  std::vector<Note> notes = {};
  std::vector<std::pair<std::string, double>> seconds = {};  ///< per pass
};

/// All passes on the dense model, in the order of the table in pipeline.cpp.
DenseModel dense_model(const SystemData& data);

}  // namespace titop::detail
