#pragma once

#include <concepts>
#include <titop/graph/graph.hpp>
#include <vector>

/// Linear combinations of signals, as the user writes them on the right of `=`.
namespace titop {

/// A sum of terms. Ports, signals and inputs turn into one; +, -, and products with a number, a
/// parameter, a `Rotation` or a matrix make new ones. Nothing is checked here: sizes, quantities
/// and frames are checked by the compiler, all together, where both sides can be shown.
///
///  - `-x`, `T_ba * x` and a part of x keep the quantity of x (T_ba also changes the frame);
///  - `3.0 * x`, `k * x`, `x / 2.0`, `M * x` give a plain signal: gains carry units. Parameters p
///    and q multiply as `p * (q * x)`;
///  - `x + 2.0`, `x * x`, `x / p` do not compile: the error names the linear form.
class Expr {
 public:
  Expr() = default;
  Expr(Graph* graph, Term term) : graph_(graph) { terms_.push_back(std::move(term)); }
  const Expr& expr() const { return *this; }
  Graph* graph() const { return graph_; }
  const std::vector<Term>& terms() const { return terms_; }

  Expr plus(const Expr& other, double sign) const;  ///< this + sign * other, O(terms)
  Expr times(const Factor& factor) const;  ///< factor * this; a number or parameter: plain signal
  Expr negated() const;                    ///< -this, of the same quantity

 private:
  Graph* graph_ = nullptr;
  std::vector<Term> terms_;
};

/// Any right-hand side of `=`.
template <class T>
concept Readable = requires(const T& x) {
  { x.expr() } -> std::convertible_to<Expr>;
};

template <Readable L, Readable R>
Expr operator+(const L& l, const R& r) {
  return l.expr().plus(r.expr(), 1);
}
template <Readable L, Readable R>
Expr operator-(const L& l, const R& r) {
  return l.expr().plus(r.expr(), -1);
}
template <Readable R>
Expr operator-(const R& r) {
  return r.expr().negated();
}
template <Readable R>
Expr operator*(const Value& k, const R& r) {
  return r.expr().times(k);
}
template <Readable L>
Expr operator*(const L& l, const Value& k) {
  return l.expr().times(k);
}
template <Readable L>
Expr operator/(const L& l, double divisor) {
  return l.expr().times(Value(1 / divisor));
}
template <Readable R>
Expr operator*(const Rotation& T_ba, const R& r) {
  return r.expr().times(T_ba);
}
template <Readable R>
Expr operator*(const Eigen::MatrixXd& M, const R& r) {
  return r.expr().times(Matrix{std::make_shared<const Eigen::MatrixXd>(M), nullptr});
}

// Terms that are not linear in the signals do not compile; the error names the linear form.

template <Readable L, detail::Constant C>
Expr operator+(const L& l, const C&) {
  static_assert(detail::never<C>,
                "titop: a number or parameter cannot be added to a signal. "
                "Declare the constant as an input, auto c = d.input(\"c\"), and add c.");
  return l.expr();
}
template <detail::Constant C, Readable R>
Expr operator+(const C& c, const R& r) {
  return r + c;
}
template <Readable L, detail::Constant C>
Expr operator-(const L& l, const C&) {
  static_assert(detail::never<C>,
                "titop: a number or parameter cannot be subtracted from a signal. "
                "Declare the constant as an input, auto c = d.input(\"c\"), and subtract c.");
  return l.expr();
}
template <detail::Constant C, Readable R>
Expr operator-(const C&, const R& r) {
  static_assert(detail::never<C>,
                "titop: a signal cannot be subtracted from a number or parameter. For 0 - x write "
                "-x; else declare the constant as an input, auto c = d.input(\"c\").");
  return r.expr();
}
template <Readable L, Readable R>
Expr operator*(const L& l, const R&) {
  static_assert(detail::never<L>,
                "titop: a product of two signals is not linear. "
                "Write a number, a parameter, a Rotation or a matrix times one signal.");
  return l.expr();
}
template <Readable L, detail::Parametric P>
Expr operator/(const L& l, const P&) {
  static_assert(detail::never<P>,
                "titop: a signal cannot be divided by a parameter p. "
                "Declare the reciprocal, r = d.param(\"r\", 1 / number), and write r * x.");
  return l.expr();
}

/// The literal 0, and nothing else: `= 0` compiles; `= 0.0`, `= false` and `= 3` do not.
struct Zero {
  SourceLine where;

  template <std::same_as<int> Int>
  consteval Zero(Int value, SourceLine at = std::source_location::current()) : where(at) {
    if (value != 0) throw "only 0 may be written here; other constants need an input";
  }
};

/// The right-hand side of `=`, with its source line.
class Rhs {
 public:
  template <Readable T>
  Rhs(const T& expression, SourceLine at = std::source_location::current())
      : expression_(expression.expr()), where_(at) {}
  Rhs(Zero zero) : where_(zero.where) {}
  template <detail::Constant C>
    requires(!std::same_as<C, int>)  // the literal 0 is a Zero
  Rhs(const C&) {
    static_assert(detail::never<C>,
                  "titop: only the literal 0 may stand alone on the right of an equation. "
                  "Declare another constant as an input, auto c = d.input(\"c\").");
  }

  const Expr& expr() const { return expression_; }
  const SourceLine& where() const { return where_; }

 private:
  Expr expression_;
  SourceLine where_;
};

}  // namespace titop
