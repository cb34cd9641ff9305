#include "cabinet/device_source.h"

#include <fcntl.h>
#include <sys/ioctl.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <optional>
#include <utility>

#include "frame_reader.h"
#include "raw_line.h"
#include "rod_tracker.h"

namespace cabinet {
namespace {

// Bounds the work of a poll: 160 ms of a line at 1 Mbaud. The rest waits for the next poll.
constexpr std::size_t kMaxBytesPerPoll = 16 * 1024;
constexpr int kMaxReadsPerPoll = 512;
// A recording's pause is played in full up to this length; a longer one separates two sessions.
constexpr std::int64_t kLongestPauseUs = 600'000'000;
// Max interval between polls for estimates of the arrival time.
constexpr std::int64_t kLongestPollUs = 1'500;
// A line with more unsent bytes than this gets no packet: 10 ms at 1 Mbaud.
constexpr int kMaxQueuedBytes = 1024;
// A device that sends noise does not become silent between two bursts of it.
constexpr std::int64_t kNoiseUs = 1'000'000;

bool keeps_message_bounds(int fd, const struct stat& about) {
  if (S_ISSOCK(about.st_mode)) {
    int type = 0;
    socklen_t size = sizeof type;
    return getsockopt(fd, SOL_SOCKET, SO_TYPE, &type, &size) == 0 && type != SOCK_STREAM;
  }
  return S_ISCHR(about.st_mode) && isatty(fd) == 0;
}

Packing packing_of_recording(int fd) {
  std::uint8_t start[wire::kDeviceReportBytes];
  wire::DeviceFrame frame;
  const bool whole = pread(fd, start, sizeof start, 0) == static_cast<ssize_t>(sizeof start);
  return whole && decode_report(start, frame) ? Packing::report_stream : Packing::cobs;
}

}  // namespace

DeviceState state_of_error(int error) {
  const bool absent =
      error == 0 || error == ENOENT || error == ENOTDIR || error == ENODEV || error == ENXIO;
  return absent ? DeviceState::missing : DeviceState::refused;
}

struct DeviceSource::Impl {
  Impl(DeviceOptions with, DeviceOpener opener, DeviceCloser closer)
      : options(std::move(with)),
        open(std::move(opener)),
        close(std::move(closer)),
        tracker(options.calibration, options.slide_limit) {}
  ~Impl() { close_device(); }

  void open_device(std::int64_t now_us);
  void close_device();
  void lose_device(std::int64_t now_us);
  void take_in(std::int64_t now_us);
  bool take_frames(std::int64_t now_us);
  std::int64_t due_us(std::int64_t now_us) const;
  void accept(std::int64_t now_us);
  bool garbled() const;
  std::int64_t arrival_us(std::int64_t now_us) const;

  DeviceOptions options;
  DeviceOpener open;
  DeviceCloser close;
  std::function<void(const wire::DeviceFrame&)> observer;
  RodTracker tracker;
  FrameReader reader;
  SourceCounters counters;
  int fd = -1;
  int open_error = 0;
  std::int64_t try_open_us = 0;
  bool tried = false;
  bool received = false;  // a frame since it was opened
  bool ever_received = false;
  bool fresh = false;  // a frame within silence_us
  // Times of the last frame and the last two polls.
  std::int64_t received_us = 0, polled_us = 0, before_us = 0;
  std::optional<std::int64_t> bytes_us;  // time of the last bytes since it was opened

  // Of a recording, one frame is read ahead of its time.
  bool socket = false, hidraw = false;  // type of the open device
  bool recording = false, played = false;
  bool pending = false;
  wire::DeviceFrame frame{};
  std::int64_t last_due_us = 0;
};

void DeviceSource::Impl::open_device(std::int64_t now_us) {
  if (played || (tried && now_us < try_open_us)) return;
  tried = true;
  try_open_us = now_us + options.reopen_us;
  errno = ENOENT;
  fd = open();
  if (fd < 0) {
    open_error = errno;
    fd = -1;
    return;
  }
  open_error = 0;
  struct stat about {};
  const int flags = fcntl(fd, F_GETFL);
  if (fstat(fd, &about) != 0 || flags < 0 || fcntl(fd, F_SETFL, flags | O_NONBLOCK) != 0) {
    close_device();
    return;
  }
  recording = S_ISREG(about.st_mode);
  socket = S_ISSOCK(about.st_mode);
  hidraw = S_ISCHR(about.st_mode) && isatty(fd) == 0;
  Packing packing = Packing::cobs;
  if (recording) {
    packing = packing_of_recording(fd);
  } else if (options.framing == DeviceFraming::report) {
    packing = keeps_message_bounds(fd, about) ? Packing::report_message : Packing::report_stream;
  }
  if (!options.opener_sets_line && isatty(fd) != 0) make_raw(fd);
  reader.reset(packing);
  tracker.forget_base();
  const Calibration* own = options.calibration_of_open ? options.calibration_of_open() : nullptr;
  if (own != nullptr) tracker.calibrate(*own);
  received = pending = false;
  bytes_us.reset();
}

void DeviceSource::Impl::close_device() {
  if (fd >= 0) close(fd);
  fd = -1;
}

void DeviceSource::Impl::lose_device(std::int64_t now_us) {
  close_device();
  played = recording;
  try_open_us = now_us + options.reopen_us;
  fresh = false;
  tracker.hold();
}

// Time when the pending frame of a recording is due: its original interval after the last one.
std::int64_t DeviceSource::Impl::due_us(std::int64_t now_us) const {
  if (!received) return now_us;
  const auto elapsed = static_cast<std::int32_t>(frame.time_us - tracker.last_frame_time_us());
  if (elapsed <= 0 || elapsed > kLongestPauseUs) return now_us;
  return last_due_us + elapsed;
}

// Arrival time of the bytes found by a poll.
std::int64_t DeviceSource::Impl::arrival_us(std::int64_t now_us) const {
  const std::int64_t since = std::max(before_us, now_us - kLongestPollUs);
  const std::int64_t told = options.arrived_us ? options.arrived_us() : 0;
  if (told > since && told <= now_us) return told;
  return recording ? now_us : (since + now_us) / 2;
}

void DeviceSource::Impl::accept(std::int64_t now_us) {
  const std::int64_t due = recording ? due_us(now_us) : now_us;
  const std::int64_t arrived = arrival_us(now_us);
  if (!tracker.accept(frame, arrived, now_us, counters)) return;
  if (observer) observer(frame);
  if (options.arrived_us) counters.add_latency(now_us - arrived);
  last_due_us = due;
  if (!received && ever_received) ++counters.reopened;
  received = ever_received = fresh = true;
  received_us = now_us;
}

// Bytes arrived recently that are not part of a frame. Bytes right after the last frame do not
// count: they are an incomplete frame of a device that fell silent.
bool DeviceSource::Impl::garbled() const {
  if (!bytes_us || polled_us - *bytes_us > kNoiseUs) return false;
  return !received || *bytes_us - received_us > options.silence_us / 2;
}

// False if the next frame of a recording is not due yet.
bool DeviceSource::Impl::take_frames(std::int64_t now_us) {
  while (pending || reader.next(frame, counters)) {
    pending = recording && due_us(now_us) > now_us;
    if (pending) return false;
    accept(now_us);
  }
  return true;
}

void DeviceSource::Impl::take_in(std::int64_t now_us) {
  std::size_t bytes = 0;
  for (int reads = 0; reads < kMaxReadsPerPoll && bytes < kMaxBytesPerPoll; ++reads) {
    if (!take_frames(now_us)) return;
    const auto room = reader.room();
    const ssize_t got = ::read(fd, room.data(), room.size());
    if (got > 0) {
      bytes += static_cast<std::size_t>(got);
      bytes_us = now_us;
      reader.filled(static_cast<std::size_t>(got), counters);
      continue;
    }
    if (got < 0 && errno == EINTR) continue;
    const bool nothing_yet = got < 0 && (errno == EAGAIN || errno == EWOULDBLOCK);
    if (!nothing_yet) lose_device(now_us);
    return;
  }
  take_frames(now_us);
}

DeviceSource::DeviceSource(DeviceOptions options, DeviceOpener open, DeviceCloser close)
    : impl_(std::make_unique<Impl>(std::move(options), std::move(open),
                                   close ? std::move(close) : DeviceCloser(::close))) {}

DeviceSource::~DeviceSource() = default;

void DeviceSource::poll(std::int64_t now_us) {
  Impl& in = *impl_;
  in.before_us = std::exchange(in.polled_us, now_us);
  if (in.fd < 0) in.open_device(now_us);
  if (in.fd >= 0) in.take_in(now_us);
  if (in.fresh && now_us - in.received_us > in.options.silence_us) {
    in.fresh = false;
    in.tracker.hold();
  }
  if (in.fresh) in.tracker.predict(now_us);
}

bool DeviceSource::send(std::span<const std::byte> packet) {
  const Impl& in = *impl_;
  if (in.fd < 0 || in.recording || packet.empty()) return false;
  if (in.hidraw) return in.options.send_apart && in.options.send_apart(in.fd, packet);
  if (in.socket)
    return ::send(in.fd, packet.data(), packet.size(), MSG_DONTWAIT | MSG_NOSIGNAL) ==
           static_cast<ssize_t>(packet.size());
  // A partial packet would corrupt the next one too, so nothing goes into a queue that may lack the
  // capacity for all of it.
  int queued = 0;
  if (::ioctl(in.fd, TIOCOUTQ, &queued) != 0 || queued > kMaxQueuedBytes) return false;
  return ::write(in.fd, packet.data(), packet.size()) == static_cast<ssize_t>(packet.size());
}

const RodInputs& DeviceSource::rods() const {
  return impl_->tracker.rods();
}
const SourceCounters& DeviceSource::counters() const {
  return impl_->counters;
}
const std::string& DeviceSource::name() const {
  return impl_->options.name;
}
DeviceState DeviceSource::state() const {
  const Impl& in = *impl_;
  if (in.fd < 0 && in.played) return DeviceState::over;
  if (in.fd < 0) return state_of_error(in.open_error);
  if (in.fresh || in.pending) return DeviceState::live;
  return in.garbled() ? DeviceState::garbled : DeviceState::silent;
}
void DeviceSource::observe(std::function<void(const wire::DeviceFrame&)> observer) {
  impl_->observer = std::move(observer);
}
DeviceFraming DeviceSource::framing() const {
  return impl_->options.framing;
}
int DeviceSource::open_error() const {
  return impl_->open_error;
}
const RodCounts& DeviceSource::counts() const {
  return impl_->tracker.counts();
}
std::uint32_t DeviceSource::last_frame_time_us() const {
  return impl_->tracker.last_frame_time_us();
}

}  // namespace cabinet
