#pragma once

#include <functional>

namespace titop::detail {

/// Runs work() on this thread and on up to `others` more at the same time, and returns when all
/// that have begun it have ended. Every one calls the next before it sets to work, while `more()`:
/// on a machine of many cores no more are woken than come in time to share the work. Neither may
/// throw. From any thread, also within work() of another call.
///
/// The others are kept, asleep, for the next call: to start a thread and to end it takes as long as
/// writing a small model. There are never more than the largest `others` so far, for all calls
/// together; if none is free or can be started, there are fewer, or this thread alone, as in a
/// child of fork().
void work_together(int others, const std::function<void()>& work,
                   const std::function<bool()>& more);

}  // namespace titop::detail
