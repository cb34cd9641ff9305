#include "doctor_find.h"

#include <fcntl.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <charconv>
#include <filesystem>
#include <fstream>
#include <sstream>

#include "os/file_descriptor.h"

namespace cabinet {
namespace {

namespace fs = std::filesystem;

// Bits of linux/input-event-codes.h.
constexpr unsigned kRelX = 0, kRelY = 1, kButtonSouth = 0x130;
constexpr const char* kControllerId = ":00001209:00000001";  // pid.codes' test id
constexpr std::size_t kMostEntries = 256, kMostText = 4096;

std::string read_text(const fs::path& path) {
  std::ifstream file(path, std::ios::binary);
  std::string text(kMostText, '\0');
  file.read(text.data(), static_cast<std::streamsize>(text.size()));
  text.resize(static_cast<std::size_t>(std::max<std::streamsize>(file.gcount(), 0)));
  while (!text.empty() && text.back() == '\n') text.pop_back();
  return text;
}

std::vector<std::string> entries(const fs::path& folder, const std::string& prefix) {
  std::vector<std::string> names;
  std::error_code error;
  for (fs::directory_iterator at(folder, error), end; !error && at != end; at.increment(error)) {
    std::string name = at->path().filename().string();
    if (name.rfind(prefix, 0) == 0 && names.size() < kMostEntries) names.push_back(std::move(name));
  }
  std::ranges::sort(names);
  return names;
}

// The kernel's list of bits: hexadecimal words of 64, the highest first.
bool has_bit(const std::string& text, unsigned bit) {
  std::istringstream stream(text);
  std::vector<std::string> words;
  for (std::string word; stream >> word;) words.push_back(word);
  const std::size_t index = bit / 64;
  if (index >= words.size()) return false;
  const std::string& word = words[words.size() - 1 - index];
  std::uint64_t value = 0;
  const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value, 16);
  return error == std::errc{} && end == word.data() + word.size() && (value >> bit % 64 & 1) != 0;
}

// Opening it costs a board its state, if it is a serial line: its rights are looked at.
int error_of(const fs::path& node, bool open) {
  if (::access(node.c_str(), R_OK) != 0) return errno;
  if (!open) return 0;
  const os::FileDescriptor fd(::open(node.c_str(), O_RDONLY | O_NONBLOCK | O_NOCTTY | O_CLOEXEC));
  return fd ? 0 : errno;
}

std::string value_of(const std::string& uevent, const std::string& key) {
  std::istringstream lines(uevent);
  for (std::string line; std::getline(lines, line);) {
    if (line.rfind(key + "=", 0) == 0) return line.substr(key.size() + 1);
  }
  return {};
}

FoundDevice found(DeviceKind kind, const fs::path& node, std::string name, bool open) {
  FoundDevice device;
  device.kind = kind;
  device.path = node.string();
  device.name = std::move(name);
  device.error = error_of(node, open);
  return device;
}

}  // namespace

std::vector<FoundDevice> find_devices(const std::string& dev, const std::string& sys) {
  std::vector<FoundDevice> devices;
  const fs::path nodes(dev), classes = fs::path(sys) / "class";
  for (const std::string& name : entries(classes / "hidraw", "hidraw")) {
    const std::string uevent = read_text(classes / "hidraw" / name / "device" / "uevent");
    if (value_of(uevent, "HID_ID").find(kControllerId) == std::string::npos) continue;
    devices.push_back(
        found(DeviceKind::hid_controller, nodes / name, value_of(uevent, "HID_NAME"), false));
  }
  for (const char* prefix : {"ttyACM", "ttyUSB"}) {
    for (const std::string& name : entries(nodes, prefix)) {
      devices.push_back(found(DeviceKind::serial_controller, nodes / name, "serial line", false));
    }
  }
  for (const std::string& name : entries(classes / "input", "event")) {
    const fs::path device = classes / "input" / name / "device";
    const std::string axes = read_text(device / "capabilities" / "rel");
    const bool mouse = has_bit(axes, kRelX) && has_bit(axes, kRelY);
    const bool gamepad = has_bit(read_text(device / "capabilities" / "key"), kButtonSouth);
    if (!mouse && !gamepad) continue;
    devices.push_back(found(mouse ? DeviceKind::mouse : DeviceKind::gamepad, nodes / "input" / name,
                            read_text(device / "name"), true));
  }
  return devices;
}

}  // namespace cabinet
