#include "doctor_find.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <charconv>
#include <filesystem>
#include <fstream>
#include <sstream>

#include "cabinet/controller.h"
#include "cabinet/mouse_source.h"
#include "mouse_line.h"
#include "os/file_descriptor.h"

namespace cabinet {
namespace {

namespace fs = std::filesystem;

// Bits of linux/input-event-codes.h.
constexpr unsigned kRelX = 0, kRelY = 1, kButtonSouth = 0x130;
// pid.codes test IDs: of a controller, and of one that is also four gamepads; the first of its
// interfaces has the frames.
constexpr const char* kControllerId = ":00001209:00000001";
constexpr const char* kGamepadsId = ":00001209:00000002";
constexpr const char* kFirstInterface = "/input0";
// The USB bridges of the boards with our serial firmware: Arduino Mega 2560 with an ATmega8U2 or
// 16U2, and the CH340 of its copies. Other lines belong to other devices, which opening might
// restart.
constexpr std::array kBridges = {"2341:0010", "2341:0042", "2a03:0010", "2a03:0042", "1a86:7523"};
constexpr std::size_t kMaxEntries = 256, kMaxText = 4096;

std::string read_text(const fs::path& path) {
  std::ifstream file(path, std::ios::binary);
  std::string text(kMaxText, '\0');
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
    if (name.rfind(prefix, 0) == 0 && names.size() < kMaxEntries) names.push_back(std::move(name));
  }
  std::ranges::sort(names);
  return names;
}

// Parses the kernel's bit lists: 64-bit words in hexadecimal, the highest first.
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

// Checks access rights without opening, since opening a serial line may restart its board. ENOTTY:
// not a device.
int error_of(const fs::path& node, bool open) {
  struct stat about {};
  if (::stat(node.c_str(), &about) != 0) return errno;
  if (!S_ISCHR(about.st_mode)) return ENOTTY;
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

FoundDevice found(DeviceKind kind, const fs::path& node, std::string name) {
  FoundDevice device;
  device.kind = kind;
  device.path = node.string();
  device.name = std::move(name);
  device.error = error_of(node, !is_controller(device));
  return device;
}

bool is_known_bridge(const std::string& usb_id) {
  return std::ranges::find(kBridges, usb_id) != kBridges.end();
}

bool has_frames(const std::string& uevent) {
  const std::string id = value_of(uevent, "HID_ID");
  if (id.ends_with(kControllerId)) return true;
  return id.ends_with(kGamepadsId) && value_of(uevent, "HID_PHYS").ends_with(kFirstInterface);
}

// Excluded: its sticks rest where its rods are, and the controller itself is examined.
bool is_of_controller(const fs::path& input) {
  return read_text(input / "id" / "vendor") == "1209" &&
         read_text(input / "id" / "product") == "0002";
}

void find_controllers(const DoctorOptions& options, std::vector<FoundDevice>& devices) {
  const fs::path nodes(options.dev), classes = fs::path(options.sys) / "class";
  const auto identify = [&](FoundDevice& device, const char* kind, const std::string& node) {
    const UsbIdentity usb = usb_identity(kind, node, options.sys);
    device.usb_id = usb.id;
    device.serial = usb.serial;
    if (device.name.empty()) device.name = usb.product.empty() ? "serial line" : usb.product;
  };
  for (const std::string& name : entries(classes / "hidraw", "hidraw")) {
    const std::string uevent = read_text(classes / "hidraw" / name / "device" / "uevent");
    if (!has_frames(uevent)) continue;
    devices.push_back(
        found(DeviceKind::hid_controller, nodes / name, value_of(uevent, "HID_NAME")));
    identify(devices.back(), "hidraw", name);
  }
  for (const char* prefix : {"ttyACM", "ttyUSB"}) {
    for (const std::string& name : entries(nodes, prefix)) {
      devices.push_back(found(DeviceKind::serial_controller, nodes / name, ""));
      identify(devices.back(), "tty", name);
      devices.back().listens = is_known_bridge(devices.back().usb_id);
    }
  }
}

void find_inputs(const DoctorOptions& options, std::vector<FoundDevice>& devices) {
  const fs::path nodes(options.dev), classes = fs::path(options.sys) / "class";
  for (const std::string& name : entries(classes / "input", "event")) {
    const fs::path device = classes / "input" / name / "device";
    const std::string axes = read_text(device / "capabilities" / "rel");
    const bool mouse = has_bit(axes, kRelX) && has_bit(axes, kRelY);
    const bool gamepad = has_bit(read_text(device / "capabilities" / "key"), kButtonSouth);
    if ((!mouse && !gamepad) || is_of_controller(device)) continue;
    devices.push_back(found(mouse ? DeviceKind::mouse : DeviceKind::gamepad, nodes / "input" / name,
                            read_text(device / "name")));
  }
}

// A device that was found already only gets the flag.
void add_named(const DoctorAddress& address, const std::string& sys,
               std::vector<FoundDevice>& devices) {
  std::error_code unknown;
  const fs::path real = fs::weakly_canonical(address.path, unknown);
  const auto same = std::ranges::find_if(devices, [&](const FoundDevice& device) {
    return device.path == address.path || fs::weakly_canonical(device.path, unknown) == real;
  });
  if (same != devices.end()) {
    same->named = same->listens = true;
    return;
  }
  FoundDevice device = found(address.kind, address.path, "");
  device.named = true;
  if (device.kind == DeviceKind::mouse && device.error == 0) {
    const os::FileDescriptor fd(
        ::open(device.path.c_str(), O_RDONLY | O_NONBLOCK | O_NOCTTY | O_CLOEXEC));
    if (fd && !is_mouse(fd.get())) device.error = ENOTTY;
  }
  if (is_controller(device)) {
    const UsbIdentity usb = usb_identity_at(address_of(device), sys);
    device.usb_id = usb.id;
    device.serial = usb.serial;
    device.name = usb.product;
  }
  devices.push_back(std::move(device));
}

}  // namespace

tl::expected<DoctorAddress, std::string> parse_doctor_address(const std::string& text) {
  const std::size_t colon = text.find(':');
  const std::string scheme = text.substr(0, colon);
  if (scheme == "evdev") {
    const auto mouse = parse_mouse_address(text);
    if (!mouse) return tl::unexpected(mouse.error());
    return DoctorAddress{DeviceKind::mouse, mouse->path};
  }
  const bool serial = scheme == "serial";
  if (colon == std::string::npos || colon + 1 == text.size() || (!serial && scheme != "hid"))
    return tl::unexpected("\"" + text +
                          "\" is not a device: write serial:/dev/ttyACM0, hid:/dev/hidraw0 or "
                          "evdev:/dev/input/event5.");
  return DoctorAddress{serial ? DeviceKind::serial_controller : DeviceKind::hid_controller,
                       text.substr(colon + 1)};
}

std::vector<FoundDevice> find_devices(const DoctorOptions& options) {
  std::vector<FoundDevice> devices;
  find_controllers(options, devices);
  find_inputs(options, devices);
  for (const DoctorAddress& address : options.devices) add_named(address, options.sys, devices);
  return devices;
}

std::string address_of(const FoundDevice& device) {
  switch (device.kind) {
    case DeviceKind::hid_controller:
      return "hid:" + device.path;
    case DeviceKind::serial_controller:
      return "serial:" + device.path;
    case DeviceKind::mouse:
      return "evdev:" + device.path;
    case DeviceKind::gamepad:
      break;
  }
  return device.path;
}

double mean_latency_us(const SourceCounters& c) {
  return c.stamped > 0 ? static_cast<double>(c.latency_sum_us) / static_cast<double>(c.stamped) : 0;
}

double frames_per_s(const FoundDevice& device) {
  return device.seconds > 0 ? static_cast<double>(device.counters.frames) / device.seconds : 0;
}

}  // namespace cabinet
