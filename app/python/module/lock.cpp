#include "lock.hpp"

#include <chrono>
#include <thread>

namespace titop::python {

void sleep_until_exit() {
  while (true) std::this_thread::sleep_for(std::chrono::hours(1));
}

bool interpreter_ends() {
#if PY_VERSION_HEX >= 0x030D0000
  return Py_IsFinalizing();
#else
  return _Py_IsFinalizing();
#endif
}

// The interpreter may begin to end while this thread waits for the lock: then Python unwinds the
// stack from inside of the call, which only catch (...) sees.
LockReleased::~LockReleased() {
  if (interpreter_ends()) sleep_until_exit();
  try {
    PyEval_RestoreThread(state_);
  } catch (...) {
    sleep_until_exit();
  }
}

LockTaken::LockTaken() {
  if (interpreter_ends()) sleep_until_exit();
  try {
    state_ = PyGILState_Ensure();
  } catch (...) {
    sleep_until_exit();
  }
}

}  // namespace titop::python
