#include "hal/usb_device.h"

#include <avr/pgmspace.h>

#include "hal/board.h"

namespace firmware {

namespace {

// One bank each: a second one would make reports older.
const uint8_t k64Bytes = _BV(EPSIZE1) | _BV(EPSIZE0) | _BV(ALLOC),
              k16Bytes = _BV(EPSIZE0) | _BV(ALLOC);
const uint8_t kInterruptEndpoint = _BV(EPTYPE1) | _BV(EPTYPE0), kToHost = _BV(EPDIR);

// Writing 0 clears a flag of UEINTX; writing 1 leaves it. An IN endpoint is an exception: there a 1
// in the bit of RXOUTI discards the data written (KILLBK).
void clear_endpoint_flags(uint8_t flags) {
  UEINTX = static_cast<uint8_t>(~flags);
}
void hand_over_report() {
  clear_endpoint_flags(_BV(TXINI) | _BV(FIFOCON) | _BV(RXOUTI));
}

// On endpoint 0: the host reads a zero-length packet.
void send_empty_packet() {
  clear_endpoint_flags(_BV(TXINI));
}

// On the endpoint selected by UENUM, which must be enabled. Resets its data toggle, unless it
// stalls.
void stall_endpoint(bool stalled) {
  UECONX = stalled ? _BV(STALLRQ) | _BV(EPEN) : _BV(STALLRQC) | _BV(RSTDT) | _BV(EPEN);
}

uint8_t read_packet(uint8_t* out) {
  const uint8_t size = UEBCLX;
  const uint8_t kept = size < wire::kDeviceCommandBytes ? size : wire::kDeviceCommandBytes;
  for (uint8_t i = 0; i < kept; ++i) out[i] = UEDATX;
  return size;
}

}  // namespace

void UsbDevice::start(const uint8_t* serial, bool gamepads) {
  requests_.set_serial(serial);
  requests_.set_gamepads(gamepads);
  gamepads_wanted_ = gamepads;
  polls_ = 0;
  UDCON = _BV(DETACH);  // a boot loader may have left it attached
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

void UsbDevice::change() {
  if (++polls_ < kPollsBeforeDetach) return;
  UDCON = _BV(DETACH);
  attached_ = false;
  polls_ = kPollsDetached;
  UDADDR = 0;
  requests_.set_gamepads(gamepads_wanted_);
  requests_.on_bus_reset();
  sending_ = nullptr;
  taking_ = false;
  configure_endpoints();
}

void UsbDevice::on_bus_reset() {
  UDINT = static_cast<uint8_t>(UDINT & ~_BV(EORSTI));
  requests_.on_bus_reset();
  sending_ = nullptr;
  taking_ = false;
  report_pending_ = false;
  UENUM = 0;
  UECONX = _BV(EPEN);
  UECFG0X = 0;  // control
  UECFG1X = k64Bytes;
}

void UsbDevice::poll() {
  if (!attached_) {
    if (polls_ != 0) {
      --polls_;
    } else {
      attach();
    }
    return;
  }
  if (gamepads_wanted_ != requests_.gamepads()) {
    change();
    if (!attached_) return;
  } else {
    polls_ = 0;
  }
  if ((UDINT & _BV(EORSTI)) != 0) on_bus_reset();
  serve_control();
  if (!configured()) return;
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
  if ((flags & _BV(RXOUTI)) != 0) {
    if (taking_) {
      take_control_packet();
    } else {  // the host's zero-length packet: it has all the data it wanted
      clear_endpoint_flags(_BV(RXOUTI));
      sending_ = nullptr;
    }
    return;
  }
  if ((flags & _BV(TXINI)) == 0) return;
  if (sending_ != nullptr) {
    send_control_packet();
  } else if (requests_.new_address() != 0) {  // the status packet was sent from the old address
    UDADDR = requests_.new_address() | _BV(ADDEN);
    requests_.address_taken();
  }
}

void UsbDevice::on_setup() {
  uint8_t bytes[8];
  for (uint8_t& byte : bytes) byte = UEDATX;
  clear_endpoint_flags(_BV(RXSTPI) | _BV(RXOUTI));
  sending_ = nullptr;
  taking_ = false;
  const UsbAnswer answer = requests_.answer(read_setup(bytes));
  switch (answer.kind) {
    case UsbAnswer::kStall:
      stall_endpoint(true);
      return;
    case UsbAnswer::kSend:
      sending_ = answer.bytes;
      left_ = answer.size;
      in_flash_ = answer.in_flash;
      end_with_empty_ = answer.end_with_empty;
      return;
    case UsbAnswer::kTake:
      taking_ = true;
      return;
    case UsbAnswer::kConfigure:
      configure_endpoints();
      break;
    case UsbAnswer::kReportHalt:
      UENUM = kReportEndpoint;
      stall_endpoint(requests_.report_halted());
      break;
    case UsbAnswer::kCommandHalt:
      UENUM = kCommandEndpoint;
      stall_endpoint(requests_.command_halted());
      break;
    case UsbAnswer::kPadHalt:
      UENUM = static_cast<uint8_t>(kPadEndpoint + answer.size);
      stall_endpoint(requests_.pad_halted(answer.size));
      break;
    case UsbAnswer::kDone:
      break;
  }
  UENUM = 0;
  send_empty_packet();
}

void UsbDevice::send_control_packet() {
  // All sent: the host's zero-length packet ends the transfer.
  if (left_ == 0 && !end_with_empty_) return;
  if (left_ == 0) end_with_empty_ = false;
  const uint8_t size = left_ < kControlBytes ? left_ : kControlBytes;
  for (uint8_t i = 0; i < size; ++i, ++sending_) {
    UEDATX = in_flash_ ? pgm_read_byte(sending_) : *sending_;
  }
  left_ = static_cast<uint8_t>(left_ - size);
  clear_endpoint_flags(_BV(TXINI));
}

void UsbDevice::take_control_packet() {
  if (command_size_ != 0) return;  // the host waits until the previous command is taken
  command_size_ = read_packet(command_);
  taking_ = false;
  clear_endpoint_flags(_BV(RXOUTI));
  send_empty_packet();
}

// Endpoint memory is allocated in the order of endpoint numbers.
void UsbDevice::configure_endpoints() {
  report_pending_ = false;
  configure_endpoint(kReportEndpoint, configured(), kToHost, k64Bytes);
  configure_endpoint(kCommandEndpoint, configured(), 0, k64Bytes);
  for (uint8_t pad = 0; pad < kPads; ++pad) {
    configure_endpoint(static_cast<uint8_t>(kPadEndpoint + pad), gamepads(), kToHost, k16Bytes);
  }
}

void UsbDevice::configure_endpoint(uint8_t number, bool on, uint8_t direction, uint8_t size) {
  UENUM = number;
  if (!on) {
    UECONX = 0;
    UECFG1X = 0;
    return;
  }
  UECONX = _BV(EPEN);
  UECFG0X = kInterruptEndpoint | direction;
  UECFG1X = size;
  UERST = static_cast<uint8_t>(1u << number);
  UERST = 0;
}

bool UsbDevice::wants_pad_report(uint8_t pad) const {
  if (!gamepads() || requests_.pad_halted(pad)) return false;
  UENUM = static_cast<uint8_t>(kPadEndpoint + pad);
  return (UEINTX & _BV(TXINI)) != 0;
}

void UsbDevice::send_pad_report(uint8_t pad, const uint8_t* report) {
  requests_.set_pad_report(pad, report);
  UENUM = static_cast<uint8_t>(kPadEndpoint + pad);
  for (uint8_t i = 0; i < kPadBytes; ++i) UEDATX = report[i];
  hand_over_report();
}

void UsbDevice::send_report(const uint8_t* report) {
  requests_.set_report(report);
  UENUM = kReportEndpoint;
  for (uint8_t i = 0; i < wire::kDeviceReportBytes; ++i) UEDATX = report[i];
  hand_over_report();
  report_pending_ = true;
}

uint8_t UsbDevice::take_command(uint8_t* out) {
  if (command_size_ != 0) {
    for (uint8_t i = 0; i < wire::kDeviceCommandBytes; ++i) out[i] = command_[i];
    const uint8_t size = command_size_;
    command_size_ = 0;
    return size;
  }
  if (!configured()) return 0;
  UENUM = kCommandEndpoint;
  if ((UEINTX & _BV(RXOUTI)) == 0) return 0;
  const uint8_t size = read_packet(out);
  clear_endpoint_flags(_BV(RXOUTI));
  clear_endpoint_flags(_BV(FIFOCON));
  return size;
}

}  // namespace firmware
