// Opens a source from an address that a person types, such as "serial:/dev/ttyACM0".
#include <fcntl.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <memory>
#include <string_view>
#include <utility>
#include <vector>

#include "arrival_watch.h"
#include "cabinet/device_source.h"
#include "exclusive_line.h"
#include "line_keeper.h"
#include "os/file_descriptor.h"

namespace cabinet {
namespace {

enum class Scheme : std::uint8_t { serial, hid, file };

struct Address {
  Scheme scheme;
  std::string path;
};

tl::expected<Address, std::string> parse_address(const std::string& text) {
  const auto colon = text.find(':');
  const std::string_view scheme = std::string_view(text).substr(0, std::min(colon, text.size()));
  if (colon != std::string::npos && colon + 1 < text.size()) {
    const std::string path = text.substr(colon + 1);
    if (scheme == "serial") return Address{Scheme::serial, path};
    if (scheme == "hid") return Address{Scheme::hid, path};
    if (scheme == "file") return Address{Scheme::file, path};
  }
  return tl::unexpected(
      "\"" + text +
      "\" is not a device: write serial:/dev/ttyACM0, hid:/dev/hidraw0 or file:recording.bin.");
}

// Empty, or the error sentence. A device may be connected later, but a missing recording is an
// error.
std::string objection(const std::string& text, const Address& address) {
  struct stat about {};
  if (stat(address.path.c_str(), &about) != 0) {
    if (address.scheme != Scheme::file && (errno == ENOENT || errno == ENOTDIR)) return {};
    return text + ": " + std::strerror(errno) + "; give the path of an existing " +
           (address.scheme == Scheme::file ? "recording." : "device.");
  }
  if (address.scheme == Scheme::file && !S_ISREG(about.st_mode)) {
    return text + ": not a regular file; give a recording of a device's bytes.";
  }
  if (address.scheme != Scheme::file && !S_ISCHR(about.st_mode)) {
    return text + ": not a device; " +
           (S_ISREG(about.st_mode) ? "for a recording write file:" + address.path + "."
                                   : "give the path of one.");
  }
  if (access(address.path.c_str(), R_OK) != 0) {
    return text + ": " + std::strerror(errno) +
           "; install cabinet/70-space-foosball.rules or join the file's group (docs/cabinet.md).";
  }
  return {};
}

// An attempt costs the poller nothing. The second attempt returns the device.
constexpr std::int64_t kReopenUs = 100'000;

std::unique_ptr<DeviceSource> line_source(DeviceOptions options, const std::string& path,
                                          CalibrationFinder find) {
  auto arrivals = std::make_shared<ArrivalWatch>();
  // The opening thread writes it before it hands over a descriptor; the poller reads it after that.
  auto found = std::make_shared<std::optional<Calibration>>();
  auto keeper = std::make_shared<LineKeeper>([path, arrivals, found, find = std::move(find)] {
    const int fd = open_exclusively(path.c_str());
    if (fd < 0) return fd;
    arrivals->watch(fd);
    if (find) *found = find();
    return fd;
  });
  options.calibration_of_open = [found] { return *found ? &**found : nullptr; };
  options.reopen_us = kReopenUs;
  options.opener_sets_line = true;
  options.arrived_us = [arrivals] { return arrivals->last_us(); };
  options.send_apart = [keeper](int fd, std::span<const std::byte> packet) {
    return keeper->send(fd, packet);
  };
  return std::make_unique<DeviceSource>(
      std::move(options), [keeper] { return keeper->take(); },
      [keeper](int fd) { keeper->close(fd); });
}

constexpr std::size_t kMaxRecordingBytes = std::size_t{64} << 20;

bool write_all(int fd, const char* bytes, std::size_t size) {
  while (size > 0) {
    const ssize_t written = ::write(fd, bytes, size);
    if (written <= 0) return false;
    bytes += written;
    size -= static_cast<std::size_t>(written);
  }
  return true;
}

// Copies the complete recording, positioned at the start. Empty: success.
std::string copy_to_memory(const std::string& text, const std::string& path, int memory) {
  const os::FileDescriptor file(::open(path.c_str(), O_RDONLY | O_CLOEXEC));
  if (!file || memory < 0) return text + ": " + std::strerror(errno) + "; try again.";
  std::vector<char> piece(std::size_t{1} << 20);
  std::size_t total = 0;
  while (true) {
    const ssize_t size = ::read(file.get(), piece.data(), piece.size());
    if (size == 0) break;
    total += size > 0 ? static_cast<std::size_t>(size) : 0;
    if (total > kMaxRecordingBytes) {
      return text + ": longer than 64 MiB; cut the recording into shorter ones.";
    }
    if (size < 0 || !write_all(memory, piece.data(), static_cast<std::size_t>(size))) {
      return text + ": " + std::strerror(errno) + "; check the disk and the free memory.";
    }
  }
  ::lseek(memory, 0, SEEK_SET);
  return {};
}

// The opener keeps its own descriptor, so that the poller's close() frees nothing.
tl::expected<std::unique_ptr<DeviceSource>, std::string> recording_source(DeviceOptions options,
                                                                          const std::string& path) {
  auto memory = std::make_shared<os::FileDescriptor>(::memfd_create("recording", MFD_CLOEXEC));
  const std::string sentence = copy_to_memory(options.name, path, memory->get());
  if (!sentence.empty()) return tl::unexpected(sentence);
  return std::make_unique<DeviceSource>(
      std::move(options), [memory] { return ::fcntl(memory->get(), F_DUPFD_CLOEXEC, 0); });
}

}  // namespace

std::string why_no_device(const std::string& address) {
  const auto parsed = parse_address(address);
  return parsed ? objection(address, *parsed) : parsed.error();
}

tl::expected<std::unique_ptr<DeviceSource>, std::string> open_device(
    const std::string& address, const Calibration& calibration,
    const std::array<double, kRods>& slide_limit, CalibrationFinder find) {
  if (std::string why = why_no_device(address); !why.empty()) return tl::unexpected(std::move(why));
  const auto parsed = parse_address(address);
  DeviceOptions options;
  options.name = address;
  options.framing = parsed->scheme == Scheme::hid ? DeviceFraming::report : DeviceFraming::cobs;
  options.calibration = calibration;
  options.slide_limit = slide_limit;
  if (parsed->scheme == Scheme::file) return recording_source(std::move(options), parsed->path);
  return line_source(std::move(options), parsed->path, std::move(find));
}

}  // namespace cabinet
