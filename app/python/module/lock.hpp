#pragma once

#include <cxxabi.h>
#include <pybind11/pybind11.h>

/// Python's lock without and with which computations run. At the end of the interpreter Python ends
/// every other thread that takes the lock, by unwinding its stack; C++ answers this by
/// std::terminate at the first destructor. Here such a thread sleeps until the process is gone.
namespace titop::python {

/// Sleeps for ever.
[[noreturn]] void sleep_until_exit();
/// True from the moment at which no other thread may take the lock.
bool interpreter_ends();

/// For its lifetime this thread, which has the lock, gives it away.
class LockReleased {
 public:
  LockReleased() : state_(PyEval_SaveThread()) {}
  LockReleased(const LockReleased&) = delete;
  LockReleased& operator=(const LockReleased&) = delete;
  ~LockReleased();

 private:
  PyThreadState* state_;
};

/// For its lifetime this thread, of Python or not, has the lock.
class LockTaken {
 public:
  LockTaken();
  LockTaken(const LockTaken&) = delete;
  LockTaken& operator=(const LockTaken&) = delete;
  ~LockTaken() { PyGILState_Release(state_); }

 private:
  PyGILState_STATE state_;
};

/// f(), which runs Python's code, in any thread. Its result must not be an object of Python, and
/// its exceptions must not be either, unless they take the lock to be destroyed.
template <class F>
auto with_lock(F f) {
  const LockTaken lock;
  try {
    return f();
  } catch (const abi::__forced_unwind&) {
    sleep_until_exit();
  }
}

}  // namespace titop::python
