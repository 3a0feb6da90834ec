#pragma once

#include "generate/assembly.hpp"
#include "generate/tables.hpp"

/// Controllers around a motion: v = Cc xc + Dc e, with the measurements e = Ex x + Eu u + Ev v and
/// the forces v. Solves for v and substitutes it everywhere.
namespace titop::generate {

template <class S>
class Controls {
 public:
  /// `order`: states x of the motion. Rows over [x | u | v] become rows over [x, xc | u].
  Controls(const std::vector<Control>& list, std::size_t order, std::size_t inputs)
      : list_(list), n_(order), inputs_(inputs), total_(order) {
    for (const Control& c : list) first_.push_back(total_), total_ += c.A.size();
  }

  /// `motion`: xdot; `y`, `e`: outputs and measurements, one row for each controller.
  FirstOrder<S> around(const Table<S>& motion, const Table<S>& y, const Table<S>& e) {
    solve_loop(e);
    Table<S> all = closed(motion);
    const Table<S> measured = closed(e);
    for (std::size_t k = 0; k < list_.size(); ++k) {
      const Control& c = list_[k];
      Table<S> own = table<S>(c.B, 1) * measured.rows({k});
      own.add(table<S>(c.A, c.A.size()), 0, first_[k]);
      all.append(own);
    }
    return split(all, closed(y));
  }

 private:
  /// v over [x, xc | u]: (1 - Dc Ev) v = Cc xc + Dc (Ex x + Eu u).
  void solve_loop(const Table<S>& e) {
    const std::size_t nc = list_.size();
    Table<S> loop = identity<S>(nc), right(nc, total_ + inputs_);
    for (std::size_t k = 0; k < nc; ++k) {
      const Control& c = list_[k];
      const S D = exactly<S>(c.D);
      for (std::size_t j = 0; j < c.A.size(); ++j) right(k, first_[k] + j) = exactly<S>(c.C[0][j]);
      for (std::size_t j = 0; j < nc; ++j) loop(k, j) -= D * e(k, n_ + inputs_ + j);
      for (std::size_t j = 0; j < n_; ++j) right(k, j) = D * e(k, j);
      for (std::size_t j = 0; j < inputs_; ++j) right(k, total_ + j) = D * e(k, n_ + j);
    }
    v_ = solve(loop, right);
  }

  Table<S> closed(const Table<S>& rows) const {
    Table<S> out(rows.rows(), total_ + inputs_), by_v(rows.rows(), list_.size());
    for (std::size_t i = 0; i < rows.rows(); ++i) {
      for (std::size_t j = 0; j < n_; ++j) out(i, j) = rows(i, j);
      for (std::size_t j = 0; j < inputs_; ++j) out(i, total_ + j) = rows(i, n_ + j);
      for (std::size_t j = 0; j < list_.size(); ++j) by_v(i, j) = rows(i, n_ + inputs_ + j);
    }
    return out + by_v * v_;
  }

  FirstOrder<S> split(const Table<S>& x, const Table<S>& y) const {
    std::vector<std::size_t> left, right;
    for (std::size_t j = 0; j < total_; ++j) left.push_back(j);
    for (std::size_t j = 0; j < inputs_; ++j) right.push_back(total_ + j);
    return {x.cols(left), x.cols(right), y.cols(left), y.cols(right)};
  }

  const std::vector<Control>& list_;
  std::size_t n_, inputs_, total_;
  std::vector<std::size_t> first_;  ///< state of each controller
  Table<S> v_;
};

}  // namespace titop::generate
