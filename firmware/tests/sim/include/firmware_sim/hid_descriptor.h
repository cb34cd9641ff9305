// Parses a HID report descriptor as a host does (USB-IF, HID 1.11, 6.2.2), and maps a gamepad's
// usages as Linux does (drivers/hid/hid-input.c). Written from these sources, not from the
// firmware.
#pragma once

#include <linux/input-event-codes.h>

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <stdexcept>
#include <vector>

namespace hid {

struct Field {
  std::uint32_t application = 0;  // page << 16 | usage; the next field too
  std::uint32_t usage = 0;
  unsigned report_id = 0;
  std::size_t bit = 0;  // offset in the report, after its ID if it has one
  unsigned bits = 0;
  int minimum = 0, maximum = 0;
  bool constant = false, relative = false;
};

struct Description {
  std::vector<std::uint32_t> applications;
  std::vector<Field> inputs;
  std::size_t input_bits = 0;
};

constexpr std::uint32_t kGamePad = 0x10005, kButtonPage = 9, kDesktopPage = 1;

// Throws std::runtime_error if it is not a valid descriptor. Supports at most one report ID.
inline Description parse(std::span<const std::uint8_t> bytes) {
  Description out;
  std::uint32_t page = 0, size = 0, count = 0, first = 0, last = 0, application = 0;
  int minimum = 0, maximum = 0;
  unsigned report_id = 0;
  std::vector<std::uint32_t> usages;
  int depth = 0;
  for (std::size_t at = 0; at < bytes.size();) {
    const unsigned prefix = bytes[at++], length = (prefix & 3) == 3 ? 4 : prefix & 3;
    if (at + length > bytes.size()) throw std::runtime_error("an item is cut off");
    std::uint32_t value = 0;
    for (unsigned i = 0; i < length; ++i) value |= std::uint32_t{bytes[at + i]} << 8 * i;
    int number = static_cast<int>(value);
    if (length == 1) number = static_cast<std::int8_t>(value);
    if (length == 2) number = static_cast<std::int16_t>(value);
    at += length;
    const auto whole_usage = [&] { return length == 4 ? value : page << 16 | value; };
    switch (prefix & 0xFC) {
      case 0x04:
        page = value;
        break;
      case 0x14:
        minimum = number;
        break;
      case 0x24:
        maximum = number;
        break;
      case 0x74:
        size = value;
        break;
      case 0x84:
        report_id = value;
        break;
      case 0x94:
        count = value;
        break;
      case 0x08:
        usages.push_back(whole_usage());
        break;
      case 0x18:
        first = whole_usage();
        break;
      case 0x28:
        last = whole_usage();
        for (std::uint32_t usage = first; usage <= last; ++usage) usages.push_back(usage);
        break;
      case 0xA0:
        ++depth;
        if (value == 1) {
          application = usages.empty() ? 0 : usages.back();
          out.applications.push_back(application);
        }
        usages.clear();
        break;
      case 0xC0:
        --depth;
        break;
      case 0x80:
        for (std::uint32_t i = 0; i < count; ++i) {
          const std::uint32_t usage =
              usages.empty() ? 0 : usages[i < usages.size() ? i : usages.size() - 1];
          out.inputs.push_back({application, usage, report_id, out.input_bits, size, minimum,
                                maximum, (value & 1) != 0, (value & 4) != 0});
          out.input_bits += size;
        }
        usages.clear();
        break;
      case 0x90:
        usages.clear();
        break;
      default:
        throw std::runtime_error("an item that no gamepad needs");
    }
  }
  if (depth != 0) throw std::runtime_error("a collection has no end");
  return out;
}

inline int value_of(const Field& field, std::span<const std::uint8_t> report) {
  std::uint32_t value = 0;
  for (unsigned i = 0; i < field.bits; ++i) {
    const std::size_t bit = field.bit + i;
    if (bit / 8 >= report.size()) throw std::runtime_error("the report is cut off");
    value |= static_cast<std::uint32_t>(report[bit / 8] >> bit % 8 & 1) << i;
  }
  const bool negative = field.minimum < 0 && (value >> (field.bits - 1) & 1) != 0;
  if (negative) value |= ~std::uint32_t{0} << field.bits;
  return static_cast<int>(value);
}

struct LinuxCode {
  int type = 0, code = 0;
};

// As hidinput_configure_usage(): absolute axes of the desktop page by the usage's last digit;
// buttons of a gamepad application from BTN_GAMEPAD on.
inline std::optional<LinuxCode> linux_code(const Field& field) {
  const std::uint32_t page = field.usage >> 16, usage = field.usage & 0xFFFF;
  if (field.constant || field.relative) return std::nullopt;
  if (page == kDesktopPage && usage >= 0x30 && usage <= 0x35)
    return LinuxCode{EV_ABS, static_cast<int>(usage & 0xF)};
  if (page == kButtonPage && field.application == kGamePad && usage >= 1 && usage <= 16)
    return LinuxCode{EV_KEY, static_cast<int>(BTN_GAMEPAD + usage - 1)};
  return std::nullopt;
}

}  // namespace hid
