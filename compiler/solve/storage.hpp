#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <memory>
#include <new>
#include <titop/compiler/solve/memory.hpp>
#include <type_traits>

namespace titop::solve {

/// Memory for many numbers, in large pages if it is large. Trivially copyable types are not
/// initialised (std::complex would be): the caller must write to them.
template <class T>
class Storage {
 public:
  explicit Storage(std::size_t size)
      : numbers_(static_cast<T*>(::operator new(size * sizeof(T))), Free{size}) {
    detail::take_large_pages(numbers_.get(), size * sizeof(T));
    if constexpr (!kPlain) std::uninitialized_default_construct_n(numbers_.get(), size);
  }

  T* data() const { return numbers_.get(); }
  std::size_t size() const { return numbers_.get_deleter().size; }

 private:
  static constexpr bool kPlain =
      std::is_trivially_copyable_v<T> && std::is_trivially_destructible_v<T>;
  struct Free {
    std::size_t size = 0;
    void operator()(T* numbers) const {
      if constexpr (!kPlain) std::destroy_n(numbers, size);
      ::operator delete(numbers);
    }
  };
  std::unique_ptr<T, Free> numbers_;
};

/// Row-major, so that the columns of a right-hand side are contiguous.
template <class T>
using RowMatrix = Eigen::Matrix<T, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

/// A matrix that is still to be written, in large pages if it is large.
template <class T>
RowMatrix<T> unwritten(Eigen::Index rows, Eigen::Index cols) {
  RowMatrix<T> result(rows, cols);
  detail::take_large_pages(result.data(), static_cast<std::size_t>(result.size()) * sizeof(T));
  return result;
}

}  // namespace titop::solve
