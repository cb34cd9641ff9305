// "serial:/dev/ttyACM0" and its kin: from an address a person types to an open source.
#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <string_view>

#include "cabinet/device_source.h"

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
  return tl::unexpected("\"" + text +
                        "\" names no device: write serial:/dev/ttyACM0, hid:/dev/hidraw0 or "
                        "file:recording.bin.");
}

// Empty, or the sentence. A device may come later; a recording will not.
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
    return text + ": not a device; for a recording write file:" + address.path + ".";
  }
  if (access(address.path.c_str(), R_OK) != 0) {
    return text + ": " + std::strerror(errno) +
           "; install cabinet/70-space-foosball.rules or join the file's group (docs/cabinet.md).";
  }
  return {};
}

}  // namespace

tl::expected<std::unique_ptr<DeviceSource>, std::string> open_device(
    const std::string& address, const Calibration& calibration,
    const std::array<double, kRods>& slide_limit) {
  const auto parsed = parse_address(address);
  if (!parsed) return tl::unexpected(parsed.error());
  if (const std::string sentence = objection(address, *parsed); !sentence.empty()) {
    return tl::unexpected(sentence);
  }
  DeviceOptions options;
  options.name = address;
  options.framing = parsed->scheme == Scheme::hid ? DeviceFraming::report : DeviceFraming::cobs;
  options.calibration = calibration;
  options.slide_limit = slide_limit;
  return std::make_unique<DeviceSource>(options, [path = parsed->path] {
    return ::open(path.c_str(), O_RDONLY | O_NONBLOCK | O_NOCTTY | O_CLOEXEC);
  });
}

}  // namespace cabinet
