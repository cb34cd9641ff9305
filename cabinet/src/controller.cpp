#include "cabinet/controller.h"

#include <filesystem>
#include <fstream>

#include "os/user_folder.h"

namespace cabinet {
namespace {

namespace fs = std::filesystem;

// From the device to the USB device that it is a part of: interface and, with hidraw, HID device
// lie between, with serial lines behind a bridge their port.
constexpr int kMostLevels = 6;
constexpr std::size_t kMostSerial = 64;

std::string first_line(const fs::path& path) {
  std::ifstream file(path);
  std::string line;
  std::getline(file, line);
  if (line.size() > kMostSerial) line.resize(kMostSerial);
  return line;
}

}  // namespace

std::string controller_serial(const std::string& address, const std::string& sys) {
  const auto colon = address.find(':');
  if (colon == std::string::npos) return {};
  const std::string scheme = address.substr(0, colon);
  const char* kind = scheme == "serial" ? "tty" : scheme == "hid" ? "hidraw" : nullptr;
  if (kind == nullptr) return {};
  std::error_code error;
  // /dev/serial/by-id/... is a link to the device.
  const fs::path real = fs::weakly_canonical(address.substr(colon + 1), error);
  fs::path at = fs::canonical(fs::path(sys) / "class" / kind / real.filename() / "device", error);
  if (error) return {};
  for (int level = 0; level < kMostLevels && at.has_relative_path(); ++level) {
    if (fs::exists(at / "serial", error)) return first_line(at / "serial");
    at = at.parent_path();
  }
  return {};
}

std::string calibration_file(const std::string& folder, const std::string& serial) {
  std::string name;
  for (const char c : serial) {
    const bool plain = (c >= '0' && c <= '9') || (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z');
    name += plain || c == '-' ? c : '_';
  }
  return folder + "/" + (name.empty() ? "unnumbered" : name) + ".json";
}

std::string calibrations_folder() {
  const std::string data = os::data_folder();
  return data.empty() ? "" : data + "/space-foosball/calibrations";
}

}  // namespace cabinet
