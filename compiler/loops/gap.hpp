#pragma once

#include <titop/compiler/loops/form.hpp>
#include <vector>

namespace titop::loops {

/// Gap of the way round a chain, as a matrix times the position of its meeting point. 0 if the
/// geometry closes, unless ties leave translations free: these do not determine how far apart their
/// points are, and the ways do not have the lever arm.
struct Gap {
  Eigen::MatrixXd taken = {};  ///< part taken up by free angles on the way; empty: none
  double off = 0;              ///< largest entry of the rest, relative to 1 or to the lever
  double length = 0;           ///< the lever, if that entry is a translation [m]; 0 if a rotation
};

/// The parts of a gap. `form`: the closing equation; `units` of its rows, as in RoundedSum;
/// `lever`: the longest on the way [m], by which lengths are measured.
Gap gap_of(const Eigen::MatrixXd& gap, const Form& form, const std::vector<int>& units,
           double lever);

/// True if the states of one block move the closing equation's six directions: a chain through a
/// bushing, or a body of six modes.
bool has_spring(const Form& form);

}  // namespace titop::loops
