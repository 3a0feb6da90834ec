#include <fmt/format.h>

#include <stdexcept>
#include <titop/compiler/passes/incidence.hpp>
#include <titop/compiler/passes/passes.hpp>

namespace titop::passes {
namespace {

void demand(bool holds, const char* subject) {
  if (!holds) throw std::logic_error(std::string("titop, internal: ") + subject);
}

}  // namespace

void verify(const Stage& stage) {
  const Graph& g = stage.now();
  const auto signals = static_cast<int>(g.signals.size());
  const auto valid = [&](int s) { return s >= 0 && s < signals; };
  for (const Channel& c : g.channels) {
    demand(valid(c.accel) && valid(c.force), "a channel without its two signals");
    demand(g.signals[static_cast<std::size_t>(c.accel)].size == c.size, "channel size");
  }
  for (const Equation& e : g.equations) {
    demand(valid(e.target), "an equation without target");
    for (const Term& t : e.terms) {
      demand(valid(t.signal), "a term without signal");
      const int rows = e.part.whole() ? g.signals[static_cast<std::size_t>(e.target)].size
                                      : static_cast<int>(e.part.rows().rows());
      if (rows_of(g, t) != rows)  // the text costs more than the check
        throw std::logic_error("titop, internal: a term of the wrong size in " + print(g, e));
    }
  }
  for (const Output& o : g.outputs)
    for (const Term& t : o.terms) demand(valid(t.signal), "an output with a term without signal");
  if (stage.rows.empty()) return;
  int rows = 0, unknowns = 0;
  for (const Row& r : stage.rows)
    if (r.active) rows += r.size;
  for (const Signal& s : g.signals)
    if (is_unknown(s)) unknowns += s.size;
  if (rows != unknowns)
    throw std::logic_error(fmt::format("titop, internal: {} rows for {} unknowns", rows, unknowns));
}

}  // namespace titop::passes
