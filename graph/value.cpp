#include <titop/graph/error.hpp>
#include <titop/graph/value.hpp>

namespace titop {

Value::Value(double scale, const Param& p)
    : number_(p.nominal), scale_(scale), index_(p.index), owner_(p.owner) {
  if (p.index < 0)
    throw Error(Code::unknown_name, "a parameter that no diagram has made is used",
                "make it first: auto k = d.param(\"k\", 10.0)");
}

}  // namespace titop
