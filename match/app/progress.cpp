#include "progress.h"

#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "os/clock.h"

namespace app {
namespace {

std::string clock_text(double seconds) {
  const auto s = static_cast<long>(std::lround(std::clamp(seconds, 0.0, 3.6e6)));
  char text[32];
  if (s >= 3600) {
    std::snprintf(text, sizeof text, "%ld:%02ld:%02ld", s / 3600, s / 60 % 60, s % 60);
  } else {
    std::snprintf(text, sizeof text, "%ld:%02ld", s / 60, s % 60);
  }
  return text;
}

// True if a series may be decided before its last match.
bool ends_early(const match::Schedule& schedule) {
  return std::ranges::any_of(schedule.series(), [](const match::Series& series) {
    return series.desc().test || series.desc().band;
  });
}

// For a single series with a test: the test's value and its bounds.
std::string test_text(const match::Schedule& schedule) {
  if (schedule.series().size() != 1 || !schedule.series()[0].desc().test) return {};
  const match::Series& series = schedule.series()[0];
  const match::SequentialTest& test = *series.desc().test;
  char text[64];
  std::snprintf(text, sizeof text, ", LLR %.2f (%.2f to %.2f)",
                match::log_likelihood_ratio(series.pairs(), test.score0, test.score1),
                test.lower_bound(), test.upper_bound());
  return text;
}

}  // namespace

Progress::Progress(bool quiet)
    : quiet_(quiet), terminal_(::isatty(STDERR_FILENO) == 1), begun_ns_(os::monotonic_ns()) {}

void Progress::show(const match::Schedule& schedule, const match::Effort& effort) {
  const std::int64_t now = os::monotonic_ns();
  const std::uint64_t done = schedule.games_taken();
  const std::uint64_t all = std::max(expected_, schedule.games_at_most());
  if (effort.games == 1 && !begun_) known_ = done > 0 ? done - 1 : 0;
  begun_ = true;
  const std::int64_t every = terminal_ ? 100'000'000 : 10'000'000'000;
  if (quiet_ || all == 0 || (now - shown_ns_ < every && done < all)) return;
  shown_ns_ = now;
  const double seconds = static_cast<double>(now - begun_ns_) * 1e-9;
  const double played =
      static_cast<double>(std::max<std::uint64_t>(1, done - std::min(done, known_)));
  const double left = seconds / played * static_cast<double>(all - done);
  const char* bound = ends_early(schedule) ? "at most " : "";
  const double share = static_cast<double>(done) / static_cast<double>(all);
  if (terminal_) {
    constexpr int kWidth = 30;
    const int full = static_cast<int>(share * kWidth);
    std::fprintf(stderr, "\r[%s%s] ", std::string(static_cast<std::size_t>(full), '=').c_str(),
                 std::string(static_cast<std::size_t>(kWidth - full), ' ').c_str());
  }
  std::fprintf(stderr, "%llu of %s%llu matches, %s%s left%s%s",
               static_cast<unsigned long long>(done), bound, static_cast<unsigned long long>(all),
               bound, clock_text(left).c_str(), test_text(schedule).c_str(),
               terminal_ ? "\033[K" : "\n");
  std::fflush(stderr);
  drawn_ = terminal_;
}

void Progress::note(const std::string& line) {
  if (quiet_) return;
  finish();
  std::fprintf(stderr, "%s\n", line.c_str());
}

void Progress::finish() {
  if (drawn_) std::fputs("\r\033[K", stderr);
  drawn_ = false;
}

}  // namespace app
