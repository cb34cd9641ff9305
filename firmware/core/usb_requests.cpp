#include "core/usb_requests.h"

#include "wire/device_frame.h"

namespace firmware {

namespace {

enum StandardRequest : uint8_t {
  kGetStatus = 0,
  kClearFeature = 1,
  kSetFeature = 3,
  kSetAddress = 5,
  kGetDescriptor = 6,
  kGetConfiguration = 8,
  kSetConfiguration = 9,
  kGetInterface = 10,
  kSetInterface = 11,
};
enum HidRequest : uint8_t { kGetReport = 1, kGetIdle = 2, kSetReport = 9, kSetIdle = 10 };

const uint8_t kClass = 0x20, kTypeMask = 0x60, kRecipientMask = 0x1F;
const uint8_t kOfDevice = 0, kOfInterface = 1, kOfEndpoint = 2;
const uint8_t kInputReport = 1, kOutputReport = 2;
const uint8_t kStringKind = 3;

UsbAnswer without_bytes(UsbAnswer::Kind kind) {
  return {kind, nullptr, 0, false, false};
}
UsbAnswer stall() {
  return without_bytes(UsbAnswer::kStall);
}
UsbAnswer done() {
  return without_bytes(UsbAnswer::kDone);
}
UsbAnswer send(const uint8_t* bytes, uint8_t size, const UsbSetup& setup) {
  if (!setup.to_host() || setup.length == 0) return setup.to_host() ? done() : stall();
  const uint8_t sent = setup.length < size ? static_cast<uint8_t>(setup.length) : size;
  return {UsbAnswer::kSend, bytes, sent, setup.length > size && size % kControlBytes == 0, false};
}

}  // namespace

UsbSetup read_setup(const uint8_t* bytes) {
  return {bytes[0], bytes[1], wire::device_get16(bytes + 2), wire::device_get16(bytes + 4),
          wire::device_get16(bytes + 6)};
}

void UsbRequests::on_bus_reset() {
  new_address_ = 0;
  configuration_ = 0;
  report_halted_ = false;
  command_halted_ = false;
  pads_halted_ = 0;
}

UsbAnswer UsbRequests::answer(const UsbSetup& setup) {
  new_address_ = 0;
  const uint8_t kind = setup.type & kTypeMask;
  if (kind == 0) return standard(setup);
  if (kind == kClass && (setup.type & kRecipientMask) == kOfInterface &&
      has_interface(setup.index)) {
    return hid(setup);
  }
  return stall();
}

UsbAnswer UsbRequests::standard(const UsbSetup& setup) {
  switch (setup.request) {
    case kGetStatus:
      return status(setup);
    case kClearFeature:
      return feature(setup, false);
    case kSetFeature:
      return feature(setup, true);
    case kSetAddress:
      if (setup.value > 127) return stall();
      new_address_ = static_cast<uint8_t>(setup.value);
      return done();
    case kGetDescriptor:
      return descriptor(setup);
    case kGetConfiguration:
      return send_byte(configuration_, 1, setup);
    case kSetConfiguration:
      if (setup.value > 1) return stall();
      configuration_ = static_cast<uint8_t>(setup.value);
      report_halted_ = false;
      command_halted_ = false;
      pads_halted_ = 0;
      return without_bytes(UsbAnswer::kConfigure);
    case kGetInterface:
      return send_byte(0, 1, setup);
    case kSetInterface:
      return setup.value == 0 && has_interface(setup.index) ? done() : stall();
  }
  return stall();
}

UsbAnswer UsbRequests::status(const UsbSetup& setup) {
  const uint8_t recipient = setup.type & kRecipientMask;
  if (recipient > kOfEndpoint) return stall();
  if (recipient == kOfDevice) return send_byte(1, 2, setup);  // self-powered
  if (recipient == kOfInterface) {
    return has_interface(setup.index) ? send_byte(0, 2, setup) : stall();
  }
  const uint8_t pad = pad_of_endpoint(setup.index);
  const bool halted = (setup.index == (0x80 | kReportEndpoint) && report_halted_) ||
                      (setup.index == kCommandEndpoint && command_halted_) ||
                      (pad < kPads && pad_halted(pad));
  return send_byte(halted ? 1 : 0, 2, setup);
}

// Returns kPads if it is none.
uint8_t UsbRequests::pad_of_endpoint(uint16_t address) const {
  const uint16_t first = 0x80 | kPadEndpoint;
  const bool pad = gamepads_ && address >= first && address < first + kPads;
  return pad ? static_cast<uint8_t>(address - first) : kPads;
}

UsbAnswer UsbRequests::feature(const UsbSetup& setup, bool set) {
  const bool endpoint = (setup.type & kRecipientMask) == kOfEndpoint;
  if (!endpoint || setup.value != 0 || configuration_ == 0) return stall();
  if (setup.index == (0x80 | kReportEndpoint)) {
    report_halted_ = set;
    return without_bytes(UsbAnswer::kReportHalt);
  }
  if (setup.index == kCommandEndpoint) {
    command_halted_ = set;
    return without_bytes(UsbAnswer::kCommandHalt);
  }
  const uint8_t pad = pad_of_endpoint(setup.index);
  if (pad == kPads) return stall();
  const uint8_t bit = static_cast<uint8_t>(1u << pad);
  pads_halted_ = static_cast<uint8_t>(set ? pads_halted_ | bit : pads_halted_ & ~bit);
  return {UsbAnswer::kPadHalt, nullptr, pad, false, false};
}

UsbAnswer UsbRequests::descriptor(const UsbSetup& setup) {
  if (serial_ != nullptr && setup.value == (kStringKind << 8 | kSerialString)) {
    return send(serial_, serial_[0], setup);
  }
  const Descriptor found = find_descriptor(setup.value, setup.index, gamepads_);
  if (found.flash == nullptr) return stall();
  UsbAnswer answer = send(found.flash, found.size, setup);
  answer.in_flash = true;
  return answer;
}

UsbAnswer UsbRequests::hid(const UsbSetup& setup) {
  const uint8_t kind = static_cast<uint8_t>(setup.value >> 8);
  switch (setup.request) {
    case kGetReport:
      return kind == kInputReport ? get_report(setup) : stall();
    case kSetReport:
      if (kind != kOutputReport || setup.to_host() || setup.length == 0 || setup.index != 0 ||
          setup.length > wire::kDeviceReportBytes) {
        return stall();
      }
      return {UsbAnswer::kTake, nullptr, static_cast<uint8_t>(setup.length), false, false};
    case kGetIdle:
      return send_byte(idle_[setup.index], 1, setup);
    // Accepted, but reports are sent whenever available, regardless of the idle rate.
    case kSetIdle:
      idle_[setup.index] = static_cast<uint8_t>(setup.value >> 8);
      return done();
  }
  return stall();
}

UsbAnswer UsbRequests::get_report(const UsbSetup& setup) {
  const uint8_t* report = setup.index == 0 ? report_ : pad_reports_[setup.index - 1];
  if (report == nullptr) return stall();
  return send(report, setup.index == 0 ? wire::kDeviceReportBytes : kPadBytes, setup);
}

UsbAnswer UsbRequests::send_byte(uint8_t value, uint8_t size, const UsbSetup& setup) {
  small_[0] = value;
  small_[1] = 0;
  return send(small_, size, setup);
}

}  // namespace firmware
