#include <memory>
#include <optional>

#include "support/agreement.hpp"
#include "support/cases.hpp"
#include "support/timing.hpp"

/// Building the Diagram by itself, and one body changed against all of them changed (and against
/// everything compiled anew), without a dense model.
namespace titop_bench {
namespace {

using titop::Diagram;
using titop::System;

System compiled(const Diagram& diagram) { return compile(diagram, {.minimize_up_to = 0}); }

Prepared diagram(Case c, int n) {
  const auto kept = std::make_shared<std::optional<Diagram>>();
  return {[=] { kept->emplace(case_diagram(c, n)); }, {}};
}

Prepared whole(Case c, int n) {
  const auto built = std::make_shared<Diagram>(case_diagram(c, n));
  const auto kept = std::make_shared<std::optional<System>>();
  return {[=] { kept->emplace(compiled(*built)); }, {}};
}

Prepared changed(Case c, int n, Varies varies) {
  struct Data {
    System first;
    std::optional<System> last = {};
    double p = 1;
  };
  const auto data = std::make_shared<Data>(Data{compiled(case_diagram(c, n, {.varies = varies}))});
  const auto once = [=] {
    data->p = data->p == 1.0625 ? 1.125 : 1.0625;  // never that of `first`
    data->last.emplace(data->first.update({{"p", data->p}}));
  };
  return {once, [=] {  // compared at one s with a compile at the same value
            const System fresh = compiled(case_diagram(c, n, {.varies = varies, .p = data->p}));
            const std::complex<double> s{1, 3};
            using List = std::vector<Eigen::MatrixXcd>;
            return difference(List{data->last->transfer(s)}, List{fresh.transfer(s)});
          }};
}

std::vector<Method> methods() {
  std::vector<Method> list;
  for (const Case c : {Case::T, Case::D, Case::C, Case::A, Case::BL, Case::F, Case::K}) {
    // The hub's direct term is dense: its size squared limits F.
    const auto sizes =
        c == Case::F ? std::vector<int>{10, 30, 100} : std::vector<int>{10, 100, 1000};
    const auto add = [&](const char* task, const std::function<Prepared(int)>& make) {
      list.push_back({task, name_of(c), "titop", sizes, make});
    };
    add("diagram", [=](int n) { return diagram(c, n); });
    add("whole", [=](int n) { return whole(c, n); });
    add("change all", [=](int n) { return changed(c, n, Varies::all); });
    add("change one", [=](int n) { return changed(c, n, Varies::one); });
  }
  return list;
}

}  // namespace
}  // namespace titop_bench

int main(int argc, char** argv) { return titop_bench::run(argc, argv, titop_bench::methods()); }
