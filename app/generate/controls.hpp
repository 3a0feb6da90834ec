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
    for (const Control& c : list) {
      first_.push_back(total_), total_ += c.A.size();
      channel_.push_back(channels_), channels_ += c.size();
    }
  }

  /// `motion`: xdot; `y`, `e`: outputs and measurements, one row for each input of a controller.
  FirstOrder<S> around(const Table<S>& motion, const Table<S>& y, const Table<S>& e) {
    solve_loop(e);
    Table<S> all = closed(motion);
    const Table<S> measured = closed(e);
    for (std::size_t k = 0; k < list_.size(); ++k) {
      const Control& c = list_[k];
      Table<S> own = table<S>(c.B, c.size()) * measured.rows(channels(k));
      own.add(table<S>(c.A, c.A.size()), 0, first_[k]);
      all.append(own);
    }
    return split(all, closed(y));
  }

 private:
  /// v over [x, xc | u]: (1 - Dc Ev) v = Cc xc + Dc (Ex x + Eu u).
  void solve_loop(const Table<S>& e) {
    Table<S> loop = identity<S>(channels_), right(channels_, total_ + inputs_);
    for (std::size_t k = 0; k < list_.size(); ++k) {
      const Control& c = list_[k];
      const Table<S> by_e = table<S>(c.D, c.size()) * e.rows(channels(k));
      right.add(table<S>(c.C, c.A.size()), channel_[k], first_[k]);
      for (std::size_t i = 0; i < c.size(); ++i) {
        const std::size_t r = channel_[k] + i;
        for (std::size_t j = 0; j < channels_; ++j) loop(r, j) -= by_e(i, n_ + inputs_ + j);
        for (std::size_t j = 0; j < n_; ++j) right(r, j) = by_e(i, j);
        for (std::size_t j = 0; j < inputs_; ++j) right(r, total_ + j) = by_e(i, n_ + j);
      }
    }
    v_ = solve(loop, right);
  }

  std::vector<std::size_t> channels(std::size_t k) const {
    std::vector<std::size_t> list;
    for (std::size_t i = 0; i < list_[k].size(); ++i) list.push_back(channel_[k] + i);
    return list;
  }

  Table<S> closed(const Table<S>& rows) const {
    Table<S> out(rows.rows(), total_ + inputs_), by_v(rows.rows(), channels_);
    for (std::size_t i = 0; i < rows.rows(); ++i) {
      for (std::size_t j = 0; j < n_; ++j) out(i, j) = rows(i, j);
      for (std::size_t j = 0; j < inputs_; ++j) out(i, total_ + j) = rows(i, n_ + j);
      for (std::size_t j = 0; j < channels_; ++j) by_v(i, j) = rows(i, n_ + inputs_ + j);
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
  std::size_t n_, inputs_, total_, channels_ = 0;
  std::vector<std::size_t> first_, channel_;  ///< state and input of each controller
  Table<S> v_;
};

}  // namespace titop::generate
