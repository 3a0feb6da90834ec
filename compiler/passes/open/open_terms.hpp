#pragma once

#include <set>
#include <string>
#include <titop/compiler/passes/open/open.hpp>

namespace titop::passes {

/// Takes parameters out of the terms of a graph, whose w become inputs and whose z outputs.
class OpenTerms {
 public:
  /// `values`: at which the parameters are opened.
  OpenTerms(Graph& graph, ParameterValues values, std::span<const ToOpen> parameters,
            std::vector<OpenedPairs>& pairs);

  /// The same terms; those with an opened parameter are written out with its w. `where`: the
  /// equation or output, for names and messages.
  std::vector<Term> opened(std::vector<Term> terms, const std::string& where);

  /// A new input w and output z of one name; returns the signal of w. z must be set.
  int pair(int parameter, int size, const std::string& where);

  std::vector<Mistake> mistakes;

 private:
  const ToOpen* find(const Value& value) const;
  bool concerns(const Term& term) const;
  std::vector<Term> written_out(const Term& term, const std::string& where);
  void times_value(std::vector<Term>& sum, const Value& value, const std::string& where);
  void times_rotation(std::vector<Term>& sum, const Rotation& T, const std::string& where);
  void times_turn(std::vector<Term>& sum, const Rotation::Turn& turn, const std::string& where);
  int number_of_turns(const Value& angle, const std::string& where);
  void turn_more(std::vector<Term>& sum, const Rotation& V, int parameter, double sign,
                 const std::string& where);

  Graph& g_;
  ParameterValues values_;
  std::span<const ToOpen> parameters_;
  std::vector<OpenedPairs>& pairs_;
  std::set<std::string> names_;
};

}  // namespace titop::passes
