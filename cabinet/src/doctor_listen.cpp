#include "doctor_listen.h"

#include <linux/input.h>
#include <sys/ioctl.h>
#include <time.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cmath>
#include <memory>
#include <optional>
#include <utility>

#include "arrival_watch.h"
#include "cabinet/device_source.h"
#include "cabinet/mouse_source.h"
#include "exclusive_line.h"
#include "input_events.h"
#include "os/clock.h"
#include "os/file_descriptor.h"

namespace cabinet {
namespace {

constexpr double kStartSeconds = 3;  // of an Arduino's boot loader and our firmware
// Reports further apart belong to two motions.
constexpr std::int64_t kLongestPauseUs = 50'000;

std::function<std::int64_t()> each_millisecond() {
  return [due = os::monotonic_ns()]() mutable {
    due = std::max(due + 1'000'000, os::monotonic_ns());
    os::sleep_until_ns(due);
    return os::monotonic_us();
  };
}

std::function<std::int64_t()> polls_of(const DoctorOptions& options) {
  return options.next_poll ? options.next_poll : each_millisecond();
}

double seconds(std::int64_t us) {
  return 1e-6 * static_cast<double>(us);
}

class RangesOfRods {
 public:
  void add(const RodInputs& rods) {
    for (std::size_t i = 0; i < rods.size(); ++i) {
      Range& range = ranges_[i];
      const double slide = rods[i].slide - rods[i].slide_ahead;
      const double angle = rods[i].angle - rods[i].angle_ahead;
      range = {std::min(range.slide_min, slide), std::max(range.slide_max, slide),
               std::min(range.angle_min, angle), std::max(range.angle_max, angle)};
    }
  }
  RodCheck check(std::size_t rod, RodStatus status) const {
    const Range& range = ranges_[rod];
    return {status, range.slide_max - range.slide_min, range.angle_max - range.angle_min};
  }

 private:
  struct Range {
    double slide_min = 0, slide_max = 0, angle_min = 0, angle_max = 0;
  };
  std::array<Range, kRods> ranges_;
};

// Report rate during motion.
class RateOfMotion {
 public:
  void add(std::uint64_t frames, std::int64_t now_us) {
    if (frames == frames_) return;
    if (last_us_ && now_us - *last_us_ <= kLongestPauseUs) {
      active_us_ += now_us - *last_us_;
      reports_ += frames - frames_;
    }
    frames_ = frames;
    last_us_ = now_us;
  }
  double per_second() const {
    return active_us_ > 0 ? static_cast<double>(reports_) / seconds(active_us_) : 0;
  }

 private:
  std::uint64_t frames_ = 0, reports_ = 0;
  std::int64_t active_us_ = 0;
  std::optional<std::int64_t> last_us_;
};

// EBUSY: another program has locked or grabbed the device. It is not grabbed here, so that the
// desktop's pointer still works.
int open_input(const char* path) {
  os::FileDescriptor fd(open_exclusively(path));
  if (!fd) return -1;
  int clock = CLOCK_MONOTONIC;
  (void)::ioctl(fd.get(), EVIOCSCLOCKID, &clock);
  if (::ioctl(fd.get(), EVIOCGRAB, 1) == 0) {
    (void)::ioctl(fd.get(), EVIOCGRAB, nullptr);
  } else if (errno == EBUSY) {
    fd.reset();
    errno = EBUSY;
    return -1;
  }
  return fd.release();
}

// Listens to a mouse or a gamepad alongside others.
class Ear {
 public:
  virtual ~Ear() = default;
  virtual void poll(std::int64_t now_us) = 0;
  virtual void report(FoundDevice& device) const = 0;
};

// Moves a rod as a hand mouse does.
class MouseEar final : public Ear {
 public:
  explicit MouseEar(const std::string& path)
      : source_(MouseOptions{.rod = 0}, [path] { return open_input(path.c_str()); }) {}
  void poll(std::int64_t now_us) override {
    source_.poll(now_us);
    ranges_.add(source_.rods());
    rate_.add(source_.counters().frames, now_us);
  }
  void report(FoundDevice& device) const override {
    device.state = source_.counters().reopened > 0 ? DeviceState::missing : source_.state();
    device.error = device.state == DeviceState::refused ? source_.open_error() : 0;
    device.counters = source_.counters();
    device.rods[0] = ranges_.check(0, source_.rods()[0].status);
    device.reports_per_s = rate_.per_second();
  }

 private:
  MouseSource source_;
  RangesOfRods ranges_;
  RateOfMotion rate_;
};

class GamepadEar final : public Ear {
 public:
  explicit GamepadEar(const std::string& path) : fd_(open_input(path.c_str())) {
    error_ = fd_ ? 0 : errno;
    for (Stick& stick : sticks_) {
      input_absinfo info{};
      if (fd_ && ::ioctl(fd_.get(), EVIOCGABS(stick.code), &info) == 0 &&
          info.maximum > info.minimum) {
        stick.middle = 0.5 * (double{1} * info.maximum + info.minimum);
        stick.way = info.maximum - stick.middle;
        stick.moved_to(info.value);
      }
    }
  }
  void poll(std::int64_t now_us) override {
    while (fd_) {
      const auto room = reader_.room();
      const ssize_t got = ::read(fd_.get(), room.data(), room.size());
      if (got < 0 && errno == EINTR) continue;
      if (got < 0 && (errno == EAGAIN || errno == EWOULDBLOCK)) break;
      if (got <= 0) fd_.reset();
      if (got > 0) reader_.filled(static_cast<std::size_t>(got));
      input_event event;
      while (reader_.next(event)) take(event, now_us);
    }
    rate_.add(counters_.frames, now_us);
  }
  void report(FoundDevice& device) const override {
    device.state = fd_ ? DeviceState::live : state_of_error(error_);
    device.error = device.state == DeviceState::refused ? error_ : 0;
    device.counters = counters_;
    device.reports_per_s = rate_.per_second();
    for (const Stick& stick : sticks_) {
      device.stick_peak = std::max(device.stick_peak, stick.peak);
      device.stick_rest = std::max(device.stick_rest, stick.now);
    }
  }

 private:
  // Deflection as a fraction of the axis range. If the kernel does not report the range, a 16-bit
  // axis is assumed.
  struct Stick {
    std::uint16_t code;
    double middle = 0, way = 32'768;
    double now = 0, peak = 0;
    void moved_to(std::int32_t value) {
      now = std::min(std::abs(value - middle) / way, 1.0);
      peak = std::max(peak, now);
    }
  };

  void take(const input_event& event, std::int64_t now_us) {
    if (event.type == EV_SYN && event.code == SYN_DROPPED) ++counters_.lost;
    if (event.type == EV_SYN && event.code == SYN_REPORT && std::exchange(changed_, false)) {
      const auto stamp = stamp_of(event, now_us);
      ++counters_.frames;
      if (!stamp) ++counters_.stale;
      counters_.add_latency(now_us - stamp.value_or(now_us));
    }
    if (event.type == EV_SYN) return;
    changed_ = true;
    for (Stick& stick : sticks_)
      if (event.type == EV_ABS && event.code == stick.code) stick.moved_to(event.value);
  }

  os::FileDescriptor fd_;
  int error_ = 0;
  EventReader reader_;
  std::array<Stick, 4> sticks_{Stick{ABS_X}, Stick{ABS_Y}, Stick{ABS_RX}, Stick{ABS_RY}};
  bool changed_ = false;
  SourceCounters counters_;
  RateOfMotion rate_;
};

}  // namespace

void listen_to_controller(FoundDevice& device, const Calibration& calibration,
                          const DoctorOptions& options) {
  ArrivalWatch arrivals;
  DeviceOptions with;
  with.name = device.path;
  with.framing =
      device.kind == DeviceKind::hid_controller ? DeviceFraming::report : DeviceFraming::cobs;
  with.calibration = calibration;
  with.opener_sets_line = true;
  with.arrived_us = [&arrivals] { return arrivals.last_us(); };
  DeviceSource source(std::move(with), [&device, &arrivals] {
    const int fd = open_exclusively(device.path.c_str());
    if (fd >= 0) arrivals.watch(fd);
    return fd;
  });
  const auto next_poll = polls_of(options);
  const std::int64_t began = next_poll();
  std::int64_t first = -1, now = began;
  RangesOfRods ranges;
  while (seconds(now - (first >= 0 ? first : began)) <
         options.seconds + (first >= 0 ? 0 : kStartSeconds)) {
    now = next_poll();
    source.poll(now);
    if (source.state() == DeviceState::refused) break;
    if (first < 0 && source.counters().frames > 0) first = now;
    ranges.add(source.rods());
  }
  device.state = source.state();
  device.error = device.state == DeviceState::refused ? source.open_error() : 0;
  device.seconds = first >= 0 ? seconds(now - first) : 0;
  device.counters = source.counters();
  for (std::size_t rod = 0; rod < device.rods.size(); ++rod) {
    device.rods[rod] = ranges.check(rod, source.rods()[rod].status);
  }
}

void listen_to_inputs(std::vector<FoundDevice>& devices, const DoctorOptions& options) {
  std::vector<std::pair<FoundDevice*, std::unique_ptr<Ear>>> ears;
  for (FoundDevice& device : devices) {
    if (device.error != 0) continue;
    if (device.kind == DeviceKind::mouse)
      ears.emplace_back(&device, std::make_unique<MouseEar>(device.path));
    if (device.kind == DeviceKind::gamepad)
      ears.emplace_back(&device, std::make_unique<GamepadEar>(device.path));
  }
  if (ears.empty()) return;
  const auto next_poll = polls_of(options);
  const std::int64_t began = next_poll();
  for (std::int64_t now = began; seconds(now - began) < options.seconds;) {
    now = next_poll();
    for (const auto& [device, ear] : ears) ear->poll(now);
  }
  for (const auto& [device, ear] : ears) ear->report(*device);
}

}  // namespace cabinet
