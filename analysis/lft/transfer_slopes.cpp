#include <fmt/format.h>

#include <numeric>
#include <titop/analysis/lft/paths.hpp>
#include <titop/graph/error.hpp>
#include <titop/graph/linalg/index.hpp>

/// Derivatives of the transfer at one s, from columns and rows of the opened one.
namespace titop {

using Eigen::Index;
using Eigen::MatrixXcd;
using linalg::at;

int Derivatives::index_of(const std::string& p) const {
  std::string known;
  for (std::size_t i = 0; i < names_.size(); ++i) {
    if (names_[i] == p) return static_cast<int>(i);
    known += (known.empty() ? "" : ", ") + names_[i];
  }
  throw Error(Code::unknown_name, fmt::format("no derivatives by {} were asked for", p),
              "they are by " + known);
}

/// From the dense model.
Derivatives::Paths Derivatives::paths_of_model(std::complex<double> s,
                                               const std::vector<int>& parameters) const {
  Paths result;
  std::vector<Index> pairs;
  for (const int i : parameters) {
    const Pairs& p = pairs_[at(i)];
    result.first.push_back(std::ssize(pairs));
    for (Index k = 0; k < p.size; ++k) pairs.push_back(p.first + k);
  }
  const MatrixXcd M = m_.transfer(s);
  const Index ny = M.rows() - all_pairs_, nu = M.cols() - all_pairs_;
  result.yw = M.bottomRows(ny)(Eigen::all, pairs);
  result.zu = M.rightCols(nu)(pairs, Eigen::all);
  result.zw = M(pairs, pairs);
  result.yu = M.bottomRightCorner(ny, nu);
  return result;
}

Derivatives::Paths Derivatives::paths(std::complex<double> s, const std::vector<int>& parameters,
                                      bool both, bool direct) const {
  try {
    return paths_of_factors(s, parameters, both, direct);
  } catch (const Error& error) {
    // A block may have a pole at 0 that the system has not: a hinge with a spring.
    if (s != 0.0 || !error.has(Code::singular)) throw;
    return paths_of_model(s, parameters);
  }
}

/// M_zu by columns of u or rows of z, M_yw by rows of y or columns of w, whichever are fewer.
Derivatives::Paths Derivatives::paths_of_factors(std::complex<double> s,
                                                 const std::vector<int>& parameters, bool both,
                                                 bool direct) const {
  Paths result;
  detail::PartOfTransfer part;
  std::vector<Index> z, w;  // scalars of the opened transfer
  std::vector<int> w_ports, z_ports;
  for (const int i : parameters) {
    const Pairs& p = pairs_[at(i)];
    result.first.push_back(std::ssize(z));
    z.insert(z.end(), out_.begin() + p.first, out_.begin() + p.first + p.size);
    w.insert(w.end(), in_.begin() + p.first, in_.begin() + p.first + p.size);
    w_ports.insert(w_ports.end(), p.inputs.begin(), p.inputs.end());
    z_ports.insert(z_ports.end(), p.outputs.begin(), p.outputs.end());
  }
  const std::vector<Index> u(in_.begin() + all_pairs_, in_.end()),
      y(out_.begin() + all_pairs_, out_.end());
  const Index r = std::ssize(z), nu = std::ssize(u), ny = std::ssize(y);
  const bool by_u = direct || nu <= r, by_w = both || ny > r;
  part.inputs = by_w ? w_ports : std::vector<int>();
  if (by_u) part.inputs.insert(part.inputs.end(), inputs_.begin(), inputs_.end());
  part.outputs = by_w ? std::vector<int>() : outputs_;
  if (!by_u) part.outputs.insert(part.outputs.end(), z_ports.begin(), z_ports.end());
  const detail::TransferPart m = detail::transfer_part(*opened_, s, part);
  const auto of_w = m.columns.leftCols(by_w ? r : 0);
  const auto of_y = m.rows.topRows(by_w ? 0 : ny);
  result.yw = by_w ? MatrixXcd(of_w(y, Eigen::all)) : MatrixXcd(of_y(Eigen::all, w));
  result.zu = by_u ? MatrixXcd(m.columns.rightCols(nu)(z, Eigen::all))
                   : MatrixXcd(m.rows.bottomRows(r)(Eigen::all, u));
  if (both) result.zw = of_w(z, Eigen::all);
  if (direct) result.yu = m.columns.rightCols(nu)(y, Eigen::all);
  result.cost = m.cost;
  return result;
}

MatrixXcd Derivatives::transfer(std::complex<double> s, const std::string& p,
                                TransferCost* cost) const {
  const int i = index_of(p);
  const Paths m = paths(s, {i});
  if (cost) *cost = m.cost;
  return pairs_[at(i)].slope * m.yw * m.zu;
}

std::vector<MatrixXcd> Derivatives::transfers(std::complex<double> s, TransferCost* cost) const {
  std::vector<int> all(pairs_.size());
  std::iota(all.begin(), all.end(), 0);
  const Paths m = paths(s, all);
  if (cost) *cost = m.cost;
  std::vector<MatrixXcd> result;
  for (const Pairs& p : pairs_)
    result.push_back(p.slope * m.yw.middleCols(p.first, p.size) * m.zu.middleRows(p.first, p.size));
  return result;
}

MatrixXcd Derivatives::transfer(std::complex<double> s, const std::string& p,
                                const std::string& q) const {
  const int a = index_of(p), b = index_of(q);
  const Pairs &i = pairs_[at(a)], &j = pairs_[at(b)];
  if (!i.exact || !j.exact) {
    const auto named = std::ranges::find_if(by_differences_, [&](const std::string& text) {
      return text.starts_with((i.exact ? q : p) + " ");
    });
    throw Error(Code::not_rational,
                fmt::format("second derivatives by {} and {}: a block gives differences of its "
                            "matrices only{}",
                            p, q, named == by_differences_.end() ? "" : ", " + *named),
                "write Block::opened for it");
  }
  const Paths m = paths(s, a == b ? std::vector{a} : std::vector{a, b}, true);
  const Index second = m.first.back();
  const auto path = [&](Index last, Index last_size, Index first, Index first_size) {
    return MatrixXcd(m.yw.middleCols(last, last_size) *
                     MatrixXcd(m.zw.block(last, first, last_size, first_size) *
                               m.zu.middleRows(first, first_size)));
  };
  return i.slope * j.slope * (path(0, i.size, second, j.size) + path(second, j.size, 0, i.size));
}

}  // namespace titop
