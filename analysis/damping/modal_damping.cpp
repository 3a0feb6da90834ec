#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <titop/analysis/damping/damping_of_assembly.hpp>

/// Damping ratios over frequency.
namespace titop {
namespace {

void check_row(const DampingPoint& row) {
  if (!(row.xi >= 0 && row.xi < 1))
    throw Error(Code::bad_value,
                fmt::format("an assembled mode is given the damping ratio {}", row.xi),
                "give fractions of critical damping, from 0 to below 1: 0.003 is 0.3 %");
  if (!(row.hertz >= 0) || !std::isfinite(row.hertz))
    throw Error(Code::bad_value,
                fmt::format("a table of damping ratios has the frequency {} Hz", row.hertz),
                "give finite frequencies, 0 or more");
}

}  // namespace

ModalDamping::ModalDamping(double xi) : ModalDamping(std::vector<DampingPoint>{{0, xi}}) {}

ModalDamping::ModalDamping(std::vector<DampingPoint> table) : table_(std::move(table)) {
  if (table_.empty())
    throw Error(Code::bad_value, "a table of damping ratios has no row",
                "give a row {frequency in Hz, xi}, or one number");
  for (std::size_t i = 0; i < table_.size(); ++i) {
    check_row(table_[i]);
    if (i > 0 && !(table_[i].hertz > table_[i - 1].hertz))
      throw Error(Code::bad_value,
                  fmt::format("a table of damping ratios has {} Hz after {} Hz", table_[i].hertz,
                              table_[i - 1].hertz),
                  "sort its rows by frequency, each frequency once");
  }
}

double ModalDamping::at(double omega) const {
  const double hertz = omega / (2 * std::numbers::pi);
  const auto above =
      std::upper_bound(table_.begin(), table_.end(), hertz,
                       [](double f, const DampingPoint& row) { return f < row.hertz; });
  if (above == table_.begin()) return table_.front().xi;
  if (above == table_.end()) return table_.back().xi;
  const DampingPoint &a = *(above - 1), &b = *above;
  return std::lerp(a.xi, b.xi, (hertz - a.hertz) / (b.hertz - a.hertz));
}

}  // namespace titop
