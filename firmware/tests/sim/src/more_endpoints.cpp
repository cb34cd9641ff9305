#include "more_endpoints.h"

namespace firmware_sim {

namespace {

// Registers and bits of the data sheet.
constexpr std::uint16_t kUdcon = 0xE0, kUeintx = 0xE8, kUenum = 0xE9, kUeconx = 0xEB,
                        kUecfg0x = 0xEC, kUecfg1x = 0xED, kUedatx = 0xF1;
constexpr std::uint8_t kDetach = 1;                                   // UDCON
constexpr std::uint8_t kTxini = 1, kKillbk = 4, kFifocon = 0x80;      // UEINTX
constexpr std::uint8_t kEpen = 1, kStallrqc = 0x10, kStallrq = 0x20;  // UECONX
constexpr std::uint8_t kInterruptToHost = 0xC1;                       // UECFG0X
constexpr std::uint8_t kAlloc = 2;                                    // UECFG1X

}  // namespace

MoreEndpoints::MoreEndpoints(avr_t* avr) {
  for (const std::uint16_t address :
       {kUdcon, kUeintx, kUenum, kUeconx, kUecfg0x, kUecfg1x, kUedatx}) {
    auto& io = avr->io[AVR_DATA_TO_IO(address)];
    chip_[address - kUdcon] = {io.w.c, io.w.param, io.r.c, io.r.param};
    io.w.c = on_write;
    io.w.param = this;
    if (io.r.c != nullptr) {
      io.r.c = on_read;
      io.r.param = this;
    }
  }
}

void MoreEndpoints::reset() {
  endpoints_ = {};
}

MoreEndpoints::Endpoint* MoreEndpoints::chosen(const avr_t* avr) {
  const int number = avr->data[kUenum];
  if (number < kFirst) return nullptr;
  return &endpoints_.at(static_cast<std::size_t>(number - kFirst));
}

UsbBus::Answer MoreEndpoints::read(int endpoint, std::vector<std::uint8_t>& out) {
  Endpoint& e = endpoints_.at(static_cast<std::size_t>(endpoint - kFirst));
  if (e.stalled) return UsbBus::Answer::stall;
  if (!e.enabled || !e.allocated || e.free) return UsbBus::Answer::nak;
  out = e.bank;
  e.bank.clear();
  e.free = true;
  return UsbBus::Answer::ok;
}

void MoreEndpoints::take(Endpoint& e, std::uint16_t address, std::uint8_t value) {
  switch (address) {
    case kUeconx:
      e.enabled = (value & kEpen) != 0;
      if ((value & kStallrqc) != 0) e.stalled = false;
      if ((value & kStallrq) != 0) e.stalled = true;
      break;
    case kUecfg0x:
      if (value != kInterruptToHost) violations_.push_back("an endpoint of another kind");
      break;
    case kUecfg1x:
      e.allocated = (value & kAlloc) != 0;
      e.size = std::size_t{8} << (value >> 4 & 7);
      e.free = e.allocated;
      e.bank.clear();
      break;
    case kUedatx:
      if (!e.enabled || !e.free || e.bank.size() == e.size) {
        violations_.push_back("a byte for which there is no room");
      } else {
        e.bank.push_back(value);
      }
      break;
    case kUeintx:
      if ((value & kFifocon) != 0) break;
      if ((value & kKillbk) != 0) violations_.push_back("a bank killed as it was handed over");
      e.free = false;
      break;
    default:
      break;
  }
}

void MoreEndpoints::on_write(avr_t* avr, avr_io_addr_t address, std::uint8_t value,
                             void* parameter) {
  auto& self = *static_cast<MoreEndpoints*>(parameter);
  const Chip& chip = self.chip_[address - kUdcon];
  if (address == kUdcon && (value & kDetach) != 0 && self.on_detach) self.on_detach();
  if (address == kUenum && value >= kFirst) {
    avr->data[kUenum] = value;
    return;
  }
  Endpoint* endpoint = address == kUdcon || address == kUenum ? nullptr : self.chosen(avr);
  if (endpoint != nullptr) {
    self.take(*endpoint, address, value);
  } else if (chip.write != nullptr) {
    chip.write(avr, address, value, chip.write_parameter);
  } else {
    avr->data[address] = value;
  }
}

std::uint8_t MoreEndpoints::on_read(avr_t* avr, avr_io_addr_t address, void* parameter) {
  auto& self = *static_cast<MoreEndpoints*>(parameter);
  const Chip& chip = self.chip_[address - kUdcon];
  const Endpoint* endpoint = self.chosen(avr);
  if (endpoint == nullptr) return chip.read(avr, address, chip.read_parameter);
  if (address != kUeintx) return 0;
  return endpoint->free ? kTxini | kFifocon : 0;
}

}  // namespace firmware_sim
