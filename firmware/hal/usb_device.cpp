#include "hal/usb_device.h"

#include <avr/pgmspace.h>

#include "core/usb_descriptors.h"
#include "hal/board.h"

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
enum HidRequest : uint8_t { kGetReport = 1, kGetIdle = 2, kSetIdle = 10 };

const uint8_t kToHost = 0x80, kClass = 0x20, kTypeMask = 0x60, kRecipientMask = 0x1F;
const uint8_t kOfDevice = 0, kOfInterface = 1, kOfEndpoint = 2;
const uint8_t kInputReport = 1;

// Flags of UEINTX are cleared by writing 0; writing 1 leaves them.
void clear_endpoint_flags(uint8_t flags) {
  UEINTX = static_cast<uint8_t>(~flags);
}

}  // namespace

void UsbDevice::start() {
  UDCON = _BV(DETACH);  // a boot loader may have been on the bus
  USBCON = 0;
  UHWCON = _BV(UVREGE);
  USBCON = _BV(USBE) | _BV(FRZCLK);
  PLLCSR = _BV(PINDIV) | _BV(PLLE);  // 16 MHz crystal to 48 MHz
}

void UsbDevice::attach() {
  if ((PLLCSR & _BV(PLOCK)) == 0) return;
  USBCON = _BV(USBE) | _BV(OTGPADE);
  UDCON = 0;  // full speed, pull-up on
  attached_ = true;
}

void UsbDevice::on_bus_reset() {
  UDINT = static_cast<uint8_t>(UDINT & ~_BV(EORSTI));
  configuration_ = 0;
  new_address_ = 0;
  replying_ = false;
  halted_ = false;
  report_pending_ = false;
  UENUM = 0;
  UECONX = _BV(EPEN);
  UECFG0X = 0;                                         // control
  UECFG1X = _BV(EPSIZE1) | _BV(EPSIZE0) | _BV(ALLOC);  // 64 bytes, one bank
}

void UsbDevice::poll() {
  if (!attached_) {
    attach();
    return;
  }
  if ((UDINT & _BV(EORSTI)) != 0) on_bus_reset();
  serve_control();
  if (configuration_ == 0) return;
  UENUM = kReportEndpoint;
  if ((UEINTX & _BV(TXINI)) != 0) report_pending_ = false;
}

void UsbDevice::serve_control() {
  UENUM = 0;
  const uint8_t flags = UEINTX;
  if ((flags & _BV(RXSTPI)) != 0) {
    on_setup();
    return;
  }
  if ((flags & _BV(RXOUTI)) != 0) {  // the host's empty packet: it has what it wanted
    clear_endpoint_flags(_BV(RXOUTI));
    replying_ = false;
    return;
  }
  if ((flags & _BV(TXINI)) == 0) return;
  if (replying_) {
    send_control_packet();
  } else if (new_address_ != 0) {  // the status packet went out under the old address
    UDADDR = new_address_ | _BV(ADDEN);
    new_address_ = 0;
  }
}

void UsbDevice::on_setup() {
  Setup setup;
  setup.type = UEDATX;
  setup.request = UEDATX;
  setup.value = UEDATX;
  setup.value |= static_cast<uint16_t>(UEDATX) << 8;
  setup.index = UEDATX;
  setup.index |= static_cast<uint16_t>(UEDATX) << 8;
  setup.length = UEDATX;
  setup.length |= static_cast<uint16_t>(UEDATX) << 8;
  clear_endpoint_flags(_BV(RXSTPI) | _BV(RXOUTI));
  replying_ = false;
  new_address_ = 0;
  if (!answer(setup)) {
    UENUM = 0;
    UECONX = _BV(STALLRQ) | _BV(EPEN);
    return;
  }
  UENUM = 0;
  if (!replying_) clear_endpoint_flags(_BV(TXINI));  // status: an empty packet
}

bool UsbDevice::answer(const Setup& setup) {
  const uint8_t kind = setup.type & kTypeMask;
  if (kind == 0) return answer_standard(setup);
  if (kind == kClass && (setup.type & kRecipientMask) == kOfInterface && setup.index == 0) {
    return answer_hid(setup);
  }
  return false;
}

bool UsbDevice::answer_standard(const Setup& setup) {
  const uint8_t recipient = setup.type & kRecipientMask;
  const bool to_host = (setup.type & kToHost) != 0;
  const bool report_endpoint = recipient == kOfEndpoint && setup.index == (0x80 | kReportEndpoint);
  switch (setup.request) {
    case kGetStatus:
      if (!to_host || recipient > kOfEndpoint) return false;
      reply_byte(recipient == kOfDevice ? 1 : (report_endpoint && halted_ ? 1 : 0), 0, 2,
                 setup.length);
      return true;
    case kClearFeature:
    case kSetFeature: {
      if (!report_endpoint || setup.value != 0 || configuration_ == 0) return false;
      halted_ = setup.request == kSetFeature;
      UENUM = kReportEndpoint;
      UECONX = halted_ ? _BV(STALLRQ) | _BV(EPEN) : _BV(STALLRQC) | _BV(RSTDT) | _BV(EPEN);
      return true;
    }
    case kSetAddress:
      if (setup.value > 127) return false;
      new_address_ = static_cast<uint8_t>(setup.value);
      if (new_address_ == 0) UDADDR = 0;
      return true;
    case kGetDescriptor: {
      const Descriptor found = find_descriptor(setup.value, setup.index);
      if (!to_host || found.flash == nullptr) return false;
      reply(found.flash, found.size, true, setup.length);
      return true;
    }
    case kGetConfiguration:
      reply_byte(configuration_, 0, 1, setup.length);
      return true;
    case kSetConfiguration:
      if (setup.value > 1) return false;
      configure(static_cast<uint8_t>(setup.value));
      return true;
    case kGetInterface:
      reply_byte(0, 0, 1, setup.length);
      return true;
    case kSetInterface:
      return setup.value == 0 && setup.index == 0;
  }
  return false;
}

bool UsbDevice::answer_hid(const Setup& setup) {
  switch (setup.request) {
    case kGetReport:
      if ((setup.value >> 8) != kInputReport || last_report_ == nullptr) return false;
      reply(last_report_, wire::kDeviceReportBytes, false, setup.length);
      return true;
    case kGetIdle:
      reply_byte(idle_, 0, 1, setup.length);
      return true;
    case kSetIdle:  // accepted; a report goes out every millisecond whatever is asked
      idle_ = static_cast<uint8_t>(setup.value >> 8);
      return true;
  }
  return false;
}

void UsbDevice::reply_byte(uint8_t value, uint8_t second, uint8_t size, uint16_t asked) {
  small_[0] = value;
  small_[1] = second;
  reply(small_, size, false, asked);
}

void UsbDevice::reply(const uint8_t* bytes, uint8_t size, bool in_flash, uint16_t asked) {
  reply_ = bytes;
  reply_left_ = asked < size ? static_cast<uint8_t>(asked) : size;
  reply_in_flash_ = in_flash;
  end_with_empty_ = asked > size && size % kControlBytes == 0;
  replying_ = asked != 0;
}

void UsbDevice::send_control_packet() {
  if (reply_left_ == 0 && !end_with_empty_) return;  // all sent: the host's empty packet ends it
  if (reply_left_ == 0) end_with_empty_ = false;
  const uint8_t size = reply_left_ < kControlBytes ? reply_left_ : kControlBytes;
  for (uint8_t i = 0; i < size; ++i, ++reply_) {
    UEDATX = reply_in_flash_ ? pgm_read_byte(reply_) : *reply_;
  }
  reply_left_ = static_cast<uint8_t>(reply_left_ - size);
  clear_endpoint_flags(_BV(TXINI));
}

void UsbDevice::configure(uint8_t configuration) {
  configuration_ = configuration;
  halted_ = false;
  report_pending_ = false;
  UENUM = kReportEndpoint;
  if (configuration == 0) {
    UECONX = 0;
    UECFG1X = 0;
    return;
  }
  UECONX = _BV(EPEN);
  UECFG0X = _BV(EPTYPE1) | _BV(EPTYPE0) | _BV(EPDIR);  // interrupt, to the host
  UECFG1X = _BV(EPSIZE1) | _BV(EPSIZE0) | _BV(ALLOC);  // 64 bytes, one bank: two would age a report
  UERST = _BV(kReportEndpoint);
  UERST = 0;
}

void UsbDevice::send_report(const uint8_t* report) {
  UENUM = kReportEndpoint;
  last_report_ = report;
  for (uint8_t i = 0; i < wire::kDeviceReportBytes; ++i) UEDATX = report[i];
  clear_endpoint_flags(_BV(TXINI));
  clear_endpoint_flags(_BV(FIFOCON));
  report_pending_ = true;
}

}  // namespace firmware
