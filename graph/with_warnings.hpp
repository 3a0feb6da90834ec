#pragma once

#include <string>
#include <vector>

namespace titop {

/// A block whose data may hold something that is rarely meant derives from this too: `compile` logs
/// each line as a warning, after the node's name.
class WithWarnings {
 public:
  virtual std::vector<std::string> warnings() const = 0;

 protected:
  ~WithWarnings() = default;
};

}  // namespace titop
