#include "avr_board.h"

#include <simavr/avr_extint.h>
#include <simavr/avr_ioport.h>
#include <simavr/avr_uart.h>
#include <simavr/sim_elf.h>
#include <simavr/sim_io.h>

#include <cstdarg>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <stdexcept>
#include <unordered_map>

namespace firmware_sim {

namespace {

constexpr std::uint8_t kPaint =
    0xC5;  // RAM before the firmware runs, to see how deep the stack went
constexpr std::uint32_t kDataSpace = 0x800000;  // where avr-gcc's symbols place RAM

void log_errors(avr_t*, const int level, const char* format, std::va_list arguments) {
  if (level <= LOG_ERROR) std::vfprintf(stderr, format, arguments);
}

struct Elf {
  elf_firmware_t firmware{};

  explicit Elf(const std::string& path) {
    if (elf_read_firmware(path.c_str(), &firmware) != 0) {
      throw std::runtime_error("no firmware at " + path + ": build the target firmware_elfs first");
    }
  }
  ~Elf() {
    for (std::uint32_t i = 0; i < firmware.symbolcount; ++i) std::free(firmware.symbol[i]);
    std::free(firmware.symbol);
    std::free(firmware.flash);
    std::free(firmware.eeprom);
    std::free(firmware.fuse);
    std::free(firmware.lockbits);
  }
  Elf(const Elf&) = delete;
  Elf& operator=(const Elf&) = delete;

  std::size_t address(const char* name) const {
    for (std::uint32_t i = 0; i < firmware.symbolcount; ++i) {
      if (std::strcmp(firmware.symbol[i]->symbol, name) == 0)
        return firmware.symbol[i]->addr & ~kDataSpace;
    }
    throw std::runtime_error(std::string("the firmware has no symbol ") + name);
  }
};

// simavr hands the sleep callback nothing but its avr_t.
thread_local std::unordered_map<avr_t*, std::uint64_t*> g_slept;

}  // namespace

void AvrBoard::sleep(avr_t* avr, avr_cycle_count_t cycles) {
  *g_slept.at(avr) += cycles;
}

AvrBoard::AvrBoard(const std::string& elf_path, const char* mcu, char clock_port, char data_port) {
  avr_global_logger_set(log_errors);
  Elf elf(elf_path);
  avr_ = avr_make_mcu_by_name(mcu);
  if (avr_ == nullptr) throw std::runtime_error(std::string("simavr does not know the ") + mcu);
  avr_init(avr_);
  avr_load_firmware(avr_, &elf.firmware);
  avr_->frequency = kHz;
  avr_->sleep = sleep;
  // Otherwise simavr looks at its timers after every instruction.
  avr_->run_cycle_limit = kHz / 1000;
  g_slept[avr_] = &slept_;

  ram_end_of_static_ = elf.address("_end");
  static_ram_ = ram_end_of_static_ - elf.address("__data_start");
  std::memset(avr_->data + ram_end_of_static_, kPaint, avr_->ramend - ram_end_of_static_);

  clock_ = find_port(clock_port);
  data_ = find_port(data_port);
  for (avr_ioport_t* port : {clock_, data_}) {
    port->external.pull_mask = port->external.pull_value = 0xFF;
    for (int bit = 0; bit < 8; ++bit) avr_raise_irq(port->io.irq + bit, 1);
  }
  // The external interrupts share pins with the data lines; unused, they would poll a low level.
  for (std::uint8_t number = 0; number < EXTINT_COUNT; ++number) {
    avr_extint_set_strict_lvl_trig(avr_, number, 0);
  }
}

AvrBoard::~AvrBoard() {
  g_slept.erase(avr_);
  avr_terminate(avr_);
  std::free(avr_);
}

avr_ioport_t* AvrBoard::find_port(char name) {
  for (avr_io_t* io = avr_->io_port; io != nullptr; io = io->next) {
    if (std::strcmp(io->kind, "port") != 0) continue;
    auto* port = reinterpret_cast<avr_ioport_t*>(io);
    if (port->name == name) return port;
  }
  throw std::runtime_error(std::string("no port ") + name);
}

avr_uart_t* AvrBoard::uart(char name) {
  for (avr_io_t* io = avr_->io_port; io != nullptr; io = io->next) {
    if (std::strcmp(io->kind, "uart") != 0) continue;
    auto* uart = reinterpret_cast<avr_uart_t*>(io);
    if (uart->name == name) return uart;
  }
  return nullptr;
}

std::uint8_t AvrBoard::pulled(const avr_ioport_t* port) const {
  return static_cast<std::uint8_t>(avr_->data[port->r_ddr] & ~avr_->data[port->r_port]);
}

void AvrBoard::set_line(avr_ioport_t* port, int bit, bool high) {
  // simavr falls back on pull_value whenever the firmware writes the direction of any pin.
  const unsigned mask = 1u << bit;
  const unsigned value = port->external.pull_value;
  port->external.pull_value = static_cast<unsigned char>(high ? value | mask : value & ~mask);
  if ((avr_->data[port->r_ddr] & mask) == 0) avr_raise_irq(port->io.irq + bit, high ? 1 : 0);
}

void AvrBoard::run_until(std::uint64_t cycle) {
  while (avr_->cycle < cycle) {
    const int state = avr_run(avr_);
    if (state == cpu_Done || state == cpu_Crashed) {
      throw std::runtime_error("the firmware crashed at pc " + std::to_string(avr_->pc));
    }
  }
}

std::size_t AvrBoard::unused_ram_bytes() const {
  std::size_t at = ram_end_of_static_;
  while (at < avr_->ramend && avr_->data[at] == kPaint) ++at;
  return at - ram_end_of_static_;
}

}  // namespace firmware_sim
