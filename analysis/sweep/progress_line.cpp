#include <fmt/format.h>
#include <unistd.h>

#include <chrono>
#include <cmath>
#include <memory>
#include <titop/analysis/sweep/sweep.hpp>
#include <utility>

namespace titop {
namespace {

using Clock = std::chrono::steady_clock;
using Seconds = std::chrono::duration<double>;

constexpr double kBetween = 0.2;  ///< least time between two drawings [s]

/// "8 s", "3 min 20 s", "2 h 5 min"
std::string text_of(double seconds) {
  const auto s = static_cast<long long>(std::ceil(seconds));
  if (s < 60) return fmt::format("{} s", s);
  if (s < 3600) return fmt::format("{} min {} s", s / 60, s % 60);
  return fmt::format("{} h {} min", s / 3600, s / 60 % 60);
}

class ProgressLine {
 public:
  ProgressLine(std::FILE* to, std::string counted) : to_(to), counted_(std::move(counted)) {}

  void show(std::size_t done, std::size_t all) {
    const Clock::time_point now = Clock::now();
    if (done < all && Seconds(now - drawn_).count() < kBetween) return;
    drawn_ = now;
    const double taken = Seconds(now - begun_).count(), part = double(done) / double(all);
    std::string text = fmt::format("{} of {} {}, {} %, ", done, all, counted_, 100 * done / all);
    text += done < all ? text_of(taken * (1 / part - 1)) + " left" : text_of(taken);
    const std::size_t before = std::exchange(size_, text.size());
    if (before > size_) text.append(before - size_, ' ');  // erases the line before
    std::fputs(("\r" + text + (done < all ? "" : "\n")).c_str(), to_);
    std::fflush(to_);
  }

 private:
  std::FILE* to_;
  std::string counted_;
  Clock::time_point begun_ = Clock::now(), drawn_ = begun_;
  std::size_t size_ = 0;
};

}  // namespace

std::function<void(std::size_t, std::size_t)> progress_line(std::FILE* to, DrawLine draw,
                                                            std::string counted) {
  if (draw == DrawLine::on_terminals && !isatty(fileno(to))) return [](std::size_t, std::size_t) {};
  return [line = std::make_shared<ProgressLine>(to, std::move(counted))](
             std::size_t done, std::size_t all) { line->show(done, all); };
}

}  // namespace titop
