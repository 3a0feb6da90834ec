#include <titop/graph/expr.hpp>

namespace titop {

Expr Expr::plus(const Expr& other, double sign) const {
  Expr sum = *this;
  if (!sum.graph_) sum.graph_ = other.graph_;
  if (other.graph_ && sum.graph_ != other.graph_)
    throw Error(Code::unknown_name, "an equation mixes signals of two diagrams",
                "take both signals from the same Diagram");
  for (Term term : other.terms_) {
    term.sign *= sign;
    sum.terms_.push_back(std::move(term));
  }
  return sum;
}

Expr Expr::times(const Factor& factor) const {
  Expr product = *this;
  for (Term& term : product.terms_) term.factors.insert(term.factors.begin(), factor);
  return product;
}

Expr Expr::negated() const {
  Expr result = *this;
  for (Term& term : result.terms_) term.sign = -term.sign;
  return result;
}

}  // namespace titop
