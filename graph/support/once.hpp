#pragma once

#include <mutex>

namespace titop::detail {

/// A value that is made at its first use, by one thread, and does not change.
template <class T>
class Once {
 public:
  /// make() is called the first time; if it throws, the next time, too.
  template <class Make>
  const T& get(Make make) const {
    std::call_once(flag_, [&] { value_ = make(); });
    return value_;
  }

 private:
  mutable std::once_flag flag_;
  mutable T value_ = {};
};

}  // namespace titop::detail
