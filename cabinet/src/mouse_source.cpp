#include "cabinet/mouse_source.h"

#include <fcntl.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cmath>
#include <utility>

#include "input_events.h"
#include "rod_limits.h"
#include "state_filter.h"

namespace cabinet {
namespace {

constexpr int kMaxReadsPerPoll = 16;  // of 64 events: 5 polls of the fastest mouse
// Max delay from the kernel's stamp until an event can be read.
constexpr std::int64_t kHandOverUs = 500;

}  // namespace

RodCalibration hand_mouse(double slide_sign, double angle_sign) {
  constexpr double kMetresPerCount = 25.4e-6;
  return {.m = {{slide_sign * 1.5 * kMetresPerCount, 0}, {0, angle_sign * 60 * kMetresPerCount}}};
}

struct MouseSource::Impl {
  Impl(MouseOptions with, DeviceOpener opener, DeviceCloser closer)
      : options(std::move(with)),
        open(std::move(opener)),
        close(std::move(closer)),
        integrator(options.calibration),
        filter(count_of(options.calibration), true) {}
  ~Impl() { close_device(); }

  void open_device(std::int64_t now_us);
  void close_device();
  void lose_device(std::int64_t now_us);
  void take_in(std::int64_t now_us);
  void report(const MouseReport& report, std::int64_t now_us);
  void predict(std::int64_t now_us);
  RodInput& rod() { return rods[static_cast<std::size_t>(options.rod)]; }

  MouseOptions options;
  DeviceOpener open;
  DeviceCloser close;
  RodIntegrator integrator;
  StateFilter filter;
  RodMotion measured{0, 0};
  RodInputs rods{};
  RodCounts counts{};
  SourceCounters counters;
  int fd = -1, open_error = ENOENT;
  bool tried = false, ever_open = false;
  std::int64_t try_open_us = 0;

  EventReader reader;
  MouseReports reports;
  std::int64_t seen_us = 0;  // time of the last report, or poll
  std::int64_t reported_us = 0;
};

void MouseSource::Impl::open_device(std::int64_t now_us) {
  if (tried && now_us < try_open_us) return;
  tried = true;
  try_open_us = now_us + options.reopen_us;
  errno = ENOENT;
  fd = open();
  if (fd < 0) {
    open_error = errno;
    fd = -1;
    return;
  }
  const int flags = ::fcntl(fd, F_GETFL);
  if (flags < 0 || ::fcntl(fd, F_SETFL, flags | O_NONBLOCK) != 0) {
    open_error = errno;
    return close_device();
  }
  if (std::exchange(ever_open, true)) ++counters.reopened;
  reader.reset();
  reports.reset();
  seen_us = std::max(seen_us, now_us);
  filter.rest();
  rod().status = RodStatus::live;
}

void MouseSource::Impl::close_device() {
  if (fd >= 0) close(fd);
  fd = -1;
}

void MouseSource::Impl::lose_device(std::int64_t now_us) {
  close_device();
  open_error = 0;
  try_open_us = now_us + options.reopen_us;
  filter.rest();
  predict(now_us);
  rod().status = RodStatus::held;
}

void MouseSource::Impl::take_in(std::int64_t now_us) {
  for (int reads = 0; reads < kMaxReadsPerPoll; ++reads) {
    const std::span<std::byte> room = reader.room();
    const ssize_t got = ::read(fd, room.data(), room.size());
    if (got < 0 && errno == EINTR) continue;
    if (got < 0 && (errno == EAGAIN || errno == EWOULDBLOCK)) return;
    if (got <= 0) return lose_device(now_us);
    reader.filled(static_cast<std::size_t>(got));
    input_event event;
    while (reader.next(event)) {
      if (const auto made = reports.take(event, now_us, counters)) report(*made, now_us);
    }
  }
}

void MouseSource::Impl::report(const MouseReport& report, std::int64_t now_us) {
  const std::int64_t time = std::max(report.time_us, seen_us);
  const double seconds = 1e-6 * static_cast<double>(std::max(time - reported_us, std::int64_t{0}));
  RodMotion moved =
      integrator.add(static_cast<double>(report.right), static_cast<double>(report.forward),
                     std::min(seconds, 1.0), measured.angle);
  if (possible(moved, std::min(seconds, kLongestReport))) {
    RodCount& count = counts[static_cast<std::size_t>(options.rod)];
    count.slide += report.right;
    count.spin += report.forward;
  } else {
    ++counters.impossible;
    moved = {0, 0};
  }
  filter.update(moved.slide, moved.angle, time);
  seen_us = reported_us = time;
  measured.slide += moved.slide;
  measured.angle += moved.angle;
  if (options.slide_limit > 0) {
    measured.slide = std::clamp(measured.slide, -options.slide_limit, options.slide_limit);
  }
  rod().time_us = now_us;
}

void MouseSource::Impl::predict(std::int64_t now_us) {
  show_ahead(measured, filter.at(now_us), options.slide_limit, rod());
}

MouseSource::MouseSource(MouseOptions options, DeviceOpener open, DeviceCloser close)
    : impl_(std::make_unique<Impl>(std::move(options), std::move(open),
                                   close ? std::move(close) : DeviceCloser(::close))) {}

MouseSource::~MouseSource() = default;

void MouseSource::poll(std::int64_t now_us) {
  Impl& in = *impl_;
  if (in.fd < 0) in.open_device(now_us);
  if (in.fd >= 0) in.take_in(now_us);
  if (in.fd < 0) return;
  if (now_us - kHandOverUs > in.seen_us) {  // no event until then
    in.seen_us = now_us - kHandOverUs;
    in.filter.update(0, 0, in.seen_us);
  }
  in.predict(now_us);
}

const RodInputs& MouseSource::rods() const {
  return impl_->rods;
}
const SourceCounters& MouseSource::counters() const {
  return impl_->counters;
}
const std::string& MouseSource::name() const {
  return impl_->options.name;
}
DeviceState MouseSource::state() const {
  return impl_->fd >= 0 ? DeviceState::live : state_of_error(impl_->open_error);
}
int MouseSource::open_error() const {
  return impl_->open_error;
}
const RodCounts& MouseSource::counts() const {
  return impl_->counts;
}

}  // namespace cabinet
