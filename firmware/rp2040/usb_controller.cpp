#include "rp2040/usb_controller.h"

#include "core/saturating.h"
#include "rp2040/system.h"

namespace rp2040 {

namespace {

using firmware::UsbAnswer;
using firmware::UsbSetup;

// Dual-port memory shared by program and controller.
constexpr uint32_t kReportControl = kUsbMemory + 0x08, kCommandControl = kUsbMemory + 0x0C,
                   kControlIn = kUsbMemory + 0x80, kControlOut = kUsbMemory + 0x84,
                   kReportIn = kUsbMemory + 0x88, kCommandOut = kUsbMemory + 0x8C,
                   kControlBuffer = 0x100, kReportBuffer = 0x180, kCommandBuffer = 0x1C0,
                   kPadBuffer = 0x200;  // of the first gamepad; the others follow at 64 bytes each
constexpr uint32_t kMemoryBytes = 4096;

// Bits of an endpoint control register.
constexpr uint32_t kEndpointOn = bit(31), kInterruptEachBuffer = bit(29), kInterruptType = 3 << 26;
// Bits of a buffer control register.
constexpr uint32_t kFull = bit(15), kData1 = bit(13), kStall = bit(11), kAvailable = bit(10);

constexpr uint32_t kSetupReceived = bit(17), kBusReset = bit(19);  // SIE_STATUS
constexpr uint32_t kControlInDone = bit(0), kControlOutDone = bit(1), kReportDone = bit(2),
                   kCommandDone = bit(3);  // BUFF_STATUS
constexpr uint32_t pad_control(uint8_t pad) {
  return kUsbMemory + 8 * (firmware::kPadEndpoint + pad);
}
constexpr uint32_t pad_in(uint8_t pad) {
  return kUsbMemory + 0x80 + 8 * (firmware::kPadEndpoint + pad);
}
constexpr uint32_t pad_buffer(uint8_t pad) {
  return kPadBuffer + 64u * pad;
}
constexpr uint32_t pad_done(uint8_t pad) {  // BUFF_STATUS
  return bit(2 * (firmware::kPadEndpoint + pad));
}
constexpr uint32_t kPullUp = bit(16);  // SIE_CTRL

volatile uint32_t* memory(uint32_t offset) {
  return &reg(kUsbMemory + offset);
}

// The controller runs on its own clock: "available" must be set some of its cycles after the rest.
void give_buffer(uint32_t control, uint32_t value) {
  reg(control) = value;
  wait_cycles(12);
  reg(control) = value | kAvailable;
}

void copy_to(uint32_t offset, const uint8_t* bytes, uint32_t size) {
  volatile uint32_t* to = memory(offset);
  for (uint32_t i = 0; i < size; i += 4) {
    uint32_t word = 0;
    for (uint32_t k = 0; k < 4 && i + k < size; ++k) {
      word |= static_cast<uint32_t>(bytes[i + k]) << (8 * k);
    }
    *to++ = word;
  }
}

}  // namespace

void UsbController::start(const uint8_t* serial, bool gamepads) {
  requests_.set_serial(serial);
  requests_.set_gamepads(gamepads);
  gamepads_wanted_ = gamepads;
  for (uint32_t i = 0; i < kMemoryBytes; i += 4) *memory(i) = 0;
  reg(kUsbMuxing) = bit(0) | bit(3);  // the controller's own PHY, connected by software
  reg(kUsbPower) = bit(2) | bit(3);   // forces VBUS detection: no pin senses VBUS
  reg(kUsbMainCtrl) = 1;
  reg(kUsbSieCtrl) = bit(29);                             // interrupt for each buffer of endpoint 0
  reg(kUsbInterruptEnable) = bit(4) | bit(12) | bit(16);  // buffers, bus reset, setup
  reg(kNvicEnable) = bit(kIrqUsb);
  set_bits(kUsbSieCtrl, kPullUp);  // attach
  attached_ = true;
}

void UsbController::poll() {
  const uint32_t now_us = micros();
  if (attached_ && gamepads_wanted_ == requests_.gamepads()) {
    since_us_ = now_us;
  } else if (attached_) {
    if (now_us - since_us_ < kUsBeforeDetach) return;
    since_us_ = now_us;
    detach();
  } else if (now_us - since_us_ >= kUsDetached) {
    set_bits(kUsbSieCtrl, kPullUp);
    attached_ = true;
  }
}

void UsbController::detach() {
  hold_interrupts();
  clear_bits(kUsbSieCtrl, kPullUp);
  attached_ = false;
  requests_.set_gamepads(gamepads_wanted_);
  on_bus_reset();
  allow_interrupts();
}

void UsbController::on_interrupt() {
  const uint32_t status = reg(kUsbSieStatus);
  // The report first: the time when it was taken is measured.
  const uint32_t buffers = reg(kUsbBuffStatus);
  if ((buffers & kReportDone) != 0) {
    taken_us_ = micros();
    reg(kUsbBuffStatus) = kReportDone;
    report_taken_ = true;
    report_pending_ = false;
  }
  // Before code that may halt or restart them.
  for (uint8_t pad = 0; pad < firmware::kPads; ++pad) {
    if ((buffers & pad_done(pad)) == 0) continue;
    reg(kUsbBuffStatus) = pad_done(pad);
    pads_ready_ = static_cast<uint8_t>(pads_ready_ | 1u << pad);
  }
  if ((status & kBusReset) != 0) on_bus_reset();
  if ((buffers & kControlInDone) != 0) {
    reg(kUsbBuffStatus) = kControlInDone;
    on_control_sent();
  }
  if ((buffers & kControlOutDone) != 0) {
    reg(kUsbBuffStatus) = kControlOutDone;
    on_control_received();
  }
  if ((status & kSetupReceived) != 0) on_setup();
  if ((buffers & kCommandDone) != 0) {
    reg(kUsbBuffStatus) = kCommandDone;
    on_command();
  }
}

void UsbController::on_bus_reset() {
  reg(kUsbAddress) = 0;
  requests_.on_bus_reset();
  sending_ = nullptr;
  taking_ = false;
  restart_all();
  reg(kUsbSieStatus) = kBusReset;
}

void UsbController::restart_all() {
  restart_reports();
  restart_commands();
  for (uint8_t pad = 0; pad < firmware::kPads; ++pad) restart_pad(pad);
}

void UsbController::on_setup() {
  uint8_t bytes[8];
  for (uint32_t i = 0; i < 8; ++i) {
    bytes[i] = static_cast<uint8_t>(*memory(i & ~3u) >> (8 * (i & 3)));
  }
  reg(kUsbSieStatus) = kSetupReceived;
  sending_ = nullptr;
  taking_ = false;
  control_data1_ = true;
  const UsbAnswer answer = requests_.answer(firmware::read_setup(bytes));
  switch (answer.kind) {
    case UsbAnswer::kStall:
      reg(kUsbStallArm) = 3;  // both directions; the next setup packet clears it
      reg(kControlIn) = kStall;
      reg(kControlOut) = kStall;
      break;
    case UsbAnswer::kConfigure:
      restart_all();
      give_buffer(kControlIn, kFull | kData1);
      break;
    case UsbAnswer::kReportHalt:
      restart_reports();
      give_buffer(kControlIn, kFull | kData1);
      break;
    case UsbAnswer::kCommandHalt:
      restart_commands();
      give_buffer(kControlIn, kFull | kData1);
      break;
    case UsbAnswer::kPadHalt:
      restart_pad(answer.size);
      give_buffer(kControlIn, kFull | kData1);
      break;
    case UsbAnswer::kDone:
      give_buffer(kControlIn, kFull | kData1);
      break;
    case UsbAnswer::kTake:
      taking_ = true;
      give_buffer(kControlOut, kData1 | firmware::kControlBytes);
      break;
    case UsbAnswer::kSend:
      sending_ = answer.bytes;
      left_ = answer.size;
      end_with_empty_ = answer.end_with_empty;
      send_control_packet();
      break;
  }
}

void UsbController::send_control_packet() {
  const uint8_t size = left_ < firmware::kControlBytes ? left_ : firmware::kControlBytes;
  copy_to(kControlBuffer, sending_, size);
  sending_ += size;
  left_ = static_cast<uint8_t>(left_ - size);
  give_buffer(kControlIn, kFull | (control_data1_ ? kData1 : 0) | size);
  control_data1_ = !control_data1_;
}

void UsbController::on_control_sent() {
  if (requests_.new_address() != 0) {  // the status packet was sent from the old address
    reg(kUsbAddress) = requests_.new_address();
    requests_.address_taken();
  }
  if (sending_ == nullptr) return;
  if (left_ != 0 || end_with_empty_) {
    if (left_ == 0) end_with_empty_ = false;
    send_control_packet();
    return;
  }
  sending_ = nullptr;
  give_buffer(kControlOut, kData1);  // the host's zero-length status packet
}

void UsbController::on_control_received() {
  if (!taking_) return;
  taking_ = false;
  keep_command(memory(kControlBuffer), static_cast<uint8_t>(reg(kControlOut) & 0x7F));
  give_buffer(kControlIn, kFull | kData1);
}

void UsbController::on_command() {
  keep_command(memory(kCommandBuffer), static_cast<uint8_t>(reg(kCommandOut) & 0x7F));
  command_data1_ = !command_data1_;
  give_buffer(kCommandOut, (command_data1_ ? kData1 : 0) | wire::kDeviceReportBytes);
}

void UsbController::keep_command(const volatile uint32_t* from, uint8_t size) {
  const uint8_t next = static_cast<uint8_t>((command_head_ + 1) % kCommands);
  if (size == 0 || size > wire::kDeviceReportBytes) return;
  if (next == command_tail_) {
    dropped_ = firmware::add_saturating(dropped_, 1);
    return;
  }
  for (uint8_t i = 0; 4 * i < size; ++i) commands_[command_head_][i] = from[i];
  command_bytes_[command_head_] = size;
  keep_order();
  command_head_ = next;
}

uint8_t UsbController::take_command(uint8_t* out) {
  const uint8_t tail = command_tail_;
  if (tail == command_head_) return 0;
  keep_order();
  const uint8_t size = command_bytes_[tail];
  for (uint8_t i = 0; i < size; ++i) {
    out[i] = static_cast<uint8_t>(commands_[tail][i / 4] >> (8 * (i % 4)));
  }
  keep_order();
  command_tail_ = static_cast<uint8_t>((tail + 1) % kCommands);
  return size;
}

uint8_t UsbController::take_dropped() {
  hold_interrupts();
  const uint8_t dropped = dropped_;
  dropped_ = 0;
  allow_interrupts();
  return dropped;
}

namespace {

// Discards data waiting to be sent. done: its bit in BUFF_STATUS.
void abort_buffer(uint32_t control, uint32_t done) {
  if ((reg(control) & kAvailable) == 0) return;
  set_bits(kUsbAbort, done);
  for (uint32_t tries = 0; tries < 1000 && (reg(kUsbAbortDone) & done) == 0; ++tries) {
  }
}
// Call when the buffer control has its new value.
void end_abort(uint32_t done) {
  reg(kUsbAbortDone) = done;
  clear_bits(kUsbAbort, done);
}

}  // namespace

// Restarts with DATA0 and an empty buffer.
void UsbController::restart_reports() {
  abort_buffer(kReportIn, kReportDone);
  report_data1_ = false;
  report_pending_ = false;
  configured_ = requests_.configured();
  halted_ = requests_.report_halted();
  reg(kReportControl) =
      (configured_ ? kEndpointOn | kInterruptEachBuffer | kInterruptType : 0) | kReportBuffer;
  reg(kReportIn) = halted_ ? kStall : 0;
  end_abort(kReportDone);
}

void UsbController::restart_pad(uint8_t pad) {
  const bool on = requests_.configured() && requests_.gamepads();
  const bool halted = requests_.pad_halted(pad);
  const uint8_t mask = static_cast<uint8_t>(1u << pad);
  abort_buffer(pad_in(pad), pad_done(pad));
  pads_data1_ = static_cast<uint8_t>(pads_data1_ & ~mask);
  pads_ready_ = static_cast<uint8_t>(on && !halted ? pads_ready_ | mask : pads_ready_ & ~mask);
  reg(pad_control(pad)) =
      (on ? kEndpointOn | kInterruptEachBuffer | kInterruptType : 0) | pad_buffer(pad);
  reg(pad_in(pad)) = on && halted ? kStall : 0;
  end_abort(pad_done(pad));
}

// Restarts with DATA0.
void UsbController::restart_commands() {
  command_data1_ = false;
  reg(kCommandControl) =
      (requests_.configured() ? kEndpointOn | kInterruptEachBuffer | kInterruptType : 0) |
      kCommandBuffer;
  if (!requests_.configured() || requests_.command_halted()) {
    reg(kCommandOut) = requests_.command_halted() ? kStall : 0;
  } else {
    give_buffer(kCommandOut, wire::kDeviceReportBytes);
  }
}

void UsbController::send_report(const uint8_t* report) {
  const uint32_t* words = reinterpret_cast<const uint32_t*>(report);
  requests_.set_report(report);
  hold_interrupts();
  if (wants_report()) {
    volatile uint32_t* to = memory(kReportBuffer);
    for (uint32_t i = 0; i < wire::kDeviceReportBytes / 4; ++i) to[i] = words[i];
    give_buffer(kReportIn, kFull | (report_data1_ ? kData1 : 0) | wire::kDeviceReportBytes);
    report_data1_ = !report_data1_;
    report_pending_ = true;
  }
  allow_interrupts();
}

bool UsbController::wants_pad_report(uint8_t pad) const {
  return (pads_ready_ >> pad & 1) != 0;
}

void UsbController::send_pad_report(uint8_t pad, const uint8_t* report) {
  const uint8_t mask = static_cast<uint8_t>(1u << pad);
  requests_.set_pad_report(pad, report);
  hold_interrupts();
  if (wants_pad_report(pad)) {
    copy_to(pad_buffer(pad), report, firmware::kPadBytes);
    give_buffer(pad_in(pad),
                kFull | ((pads_data1_ & mask) != 0 ? kData1 : 0) | firmware::kPadBytes);
    pads_data1_ = static_cast<uint8_t>(pads_data1_ ^ mask);
    pads_ready_ = static_cast<uint8_t>(pads_ready_ & ~mask);
  }
  allow_interrupts();
}

bool UsbController::take_report_time(uint32_t& at_us) {
  hold_interrupts();
  const bool taken = report_taken_;
  at_us = taken_us_;
  report_taken_ = false;
  allow_interrupts();
  return taken;
}

}  // namespace rp2040
