#include <algorithm>
#include <cmath>
#include <span>
#include <titop/compiler/passes/lower/amounts.hpp>
#include <titop/graph/linalg/index.hpp>
#include <titop/graph/linalg/rounding.hpp>

namespace titop::passes {
namespace {

using Eigen::MatrixXd;
using linalg::at;

bool less(const Summand& a, const Summand& b) {
  if (a.signal != b.signal) return a.signal < b.signal;
  return std::lexicographical_compare(a.c.data(), a.c.data() + a.c.size(), b.c.data(),
                                      b.c.data() + b.c.size());
}

}  // namespace

Pattern product(const Pattern& a, const Pattern& b) {
  if (a.size() == 0 || b.size() == 0) return {};
  return (a.cast<int>() * b.cast<int>()).array() > 0;
}

Pattern product(const MatrixXd& m, const Pattern& p) {
  return p.size() == 0 ? Pattern() : product(Pattern(m.array() != 0), p);
}

Amount times(const MatrixXd& m, const Pattern& declared, Amount sum) {
  for (Summand& t : sum) t.c = m * t.c, t.p = product(declared, t.p);
  return sum;
}

Amount times(const MatrixXd& m, Amount sum) {
  for (Summand& t : sum) t.c = m * t.c, t.p = product(m, t.p);
  return sum;
}

namespace {

/// Most terms of scalar scenes have a coefficient of 1 or -1: they share it, as others do not.
std::shared_ptr<const MatrixXd> kept(MatrixXd c) {
  static const auto plus = std::make_shared<const MatrixXd>(MatrixXd::Ones(1, 1)),
                    minus = std::make_shared<const MatrixXd>(-MatrixXd::Ones(1, 1));
  if (c.size() == 1 && std::abs(c(0, 0)) == 1) return c(0, 0) > 0 ? plus : minus;
  return std::make_shared<const MatrixXd>(std::move(c));
}

std::shared_ptr<const Pattern> kept(Pattern p) {
  static const auto one = std::make_shared<const Pattern>(Pattern::Constant(1, 1, true));
  if (p.size() == 0) return {};
  return p.size() == 1 && p(0, 0) ? one : std::make_shared<const Pattern>(std::move(p));
}

}  // namespace

namespace {

/// The sum of terms of one signal; an entry whose terms cancel up to their rounding is 0: momenta
/// of wheels that balance each other leave no coupling.
Summand total_of(std::span<Summand> terms) {
  Summand total = std::move(terms.front());
  if (terms.size() == 1) return total;
  MatrixXd sizes = total.c.cwiseAbs();
  for (const Summand& t : terms.subspan(1)) {
    total.c += t.c;
    sizes += t.c.cwiseAbs();
    if (total.p.size() == 0 || t.p.size() == 0)
      total.p.resize(0, 0);
    else
      total.p = total.p.array() || t.p.array();
  }
  total.c = (total.c.array().abs() < linalg::kProductRounding * sizes.array()).select(0, total.c);
  return total;
}

}  // namespace

Amount summed(Amount sum) {
  if (sum.size() < 2) return sum;
  std::sort(sum.begin(), sum.end(), less);
  auto last = sum.begin();
  for (auto first = sum.begin(); first != sum.end(); ++last) {
    const auto end =
        std::find_if(first, sum.end(), [&](const Summand& t) { return t.signal != first->signal; });
    *last = total_of({first, end});
    first = end;
  }
  sum.erase(last, sum.end());
  return sum;
}

std::vector<Term> merged(Amount sum) {
  sum = summed(std::move(sum));
  std::vector<Term> terms;
  terms.reserve(sum.size());
  for (Summand& s : sum) {
    Term term{.signal = s.signal};
    term.factors.emplace_back(Matrix{kept(std::move(s.c)), kept(std::move(s.p))});
    terms.push_back(std::move(term));
  }
  return terms;
}

}  // namespace titop::passes
