#include <pthread.h>

#include <algorithm>
#include <boost/intrusive/list.hpp>
#include <condition_variable>
#include <csignal>
#include <exception>
#include <mutex>
#include <thread>
#include <titop/graph/support/workers.hpp>

namespace titop::detail {
namespace {

/// A call that waits for workers is in a list: at most once, as the thread that takes it out puts
/// it in again. (It brings its own link: no memory is allocated, which might fail.)
struct Call : boost::intrusive::list_base_hook<> {
  Call(const std::function<void()>& to_do, const std::function<bool()>& is_more, int others)
      : work(to_do), more(is_more), left(others) {}

  const std::function<void()>& work;
  const std::function<bool()>& more;
  int left;         ///< workers that may still be called
  int running = 0;  ///< workers that have begun
  std::condition_variable ended = {};
};

class Workers {
 public:
  void run(Call& call) {
    {
      const std::scoped_lock lock(mutex_);
      most_ = std::max(most_, call.left);
    }
    call_next(call);
    call.work();
    std::unique_lock lock(mutex_);
    call.left = 0;  // a worker on its way to call another finds that it is late
    if (call.is_linked()) called_.erase(called_.iterator_to(call));
    call.ended.wait(lock, [&] { return call.running == 0; });
  }

 private:
  void call_next(Call& call) {
    if (!call.more()) return;
    {
      const std::scoped_lock lock(mutex_);
      if (call.left == 0) return;
      --call.left;
      called_.push_back(call);
      if (asleep_ < called_.size() && started_ < most_) return start();
    }
    wake_.notify_one();
  }

  /// Signals are blocked in worker threads, except for those of a thread's own faults: the
  /// program's own threads handle them.
  void start() {
    sigset_t all, before;
    sigfillset(&all);
    for (const int fault : {SIGSEGV, SIGBUS, SIGFPE, SIGILL, SIGTRAP, SIGSYS})
      sigdelset(&all, fault);
    pthread_sigmask(SIG_SETMASK, &all, &before);
    try {
      std::thread([this] { serve(); }).detach();
      ++started_;
    } catch (const std::exception&) {  // no thread, no memory: those that there are do all of it
    }
    pthread_sigmask(SIG_SETMASK, &before, nullptr);
  }

  void serve() {
    for (std::unique_lock lock(mutex_);;) {
      ++asleep_;
      wake_.wait(lock, [this] { return !called_.empty(); });
      --asleep_;
      Call& call = called_.front();
      called_.pop_front();
      ++call.running;
      lock.unlock();
      call_next(call);
      call.work();
      lock.lock();
      if (--call.running == 0) call.ended.notify_one();
    }
  }

  std::mutex mutex_;
  std::condition_variable wake_;
  boost::intrusive::list<Call> called_;
  std::size_t asleep_ = 0;
  int started_ = 0, most_ = 0;
};

/// In a child of fork() the other threads do not exist, and signalling to them may block for ever.
bool is_child = false;

/// Never destroyed: a thread that ends the process must not wait for the others' work.
Workers& workers() {
  static Workers& all = []() -> Workers& {
    pthread_atfork(nullptr, nullptr, [] { is_child = true; });
    return *new Workers;
  }();
  return all;
}

}  // namespace

void work_together(int others, const std::function<void()>& work,
                   const std::function<bool()>& more) {
  if (others <= 0 || is_child) return work();
  Call call(work, more, others);
  workers().run(call);
}

}  // namespace titop::detail
