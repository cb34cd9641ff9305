#include "avr_board.h"

#include <simavr/avr_eeprom.h>
#include <simavr/avr_extint.h>
#include <simavr/avr_ioport.h>
#include <simavr/avr_uart.h>
#include <simavr/sim_elf.h>
#include <simavr/sim_io.h>

#include <algorithm>
#include <cstdarg>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <stdexcept>
#include <unordered_map>

namespace firmware_sim {

namespace {

constexpr std::uint8_t kPaint = 0xC5;  // fills RAM before the start, to measure the stack depth
constexpr std::uint32_t kDataSpace = 0x800000;  // address of RAM in avr-gcc's symbols

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

// simavr passes only its avr_t to these callbacks.
thread_local std::unordered_map<avr_t*, AvrBoard*> g_boards;

// The same in both chips.
constexpr std::uint16_t kEepromControl = 0x3F, kFlashControl = 0x57;
constexpr std::uint8_t kEepromWrite = 2, kEepromMasterWrite = 4;  // bits of the first
constexpr std::uint8_t kReadSignature = 0x21;                     // value of the second
constexpr std::uint64_t kEepromUs = 3400;
constexpr std::uint8_t kReceived = 0x80;  // in the status of the serial line
constexpr std::uint16_t kWatchdogControl = 0x60;
constexpr std::uint8_t kWatchdogInterrupts = 0x40;  // in kWatchdogControl
constexpr std::uint8_t kWatchdogVector = 12;
constexpr std::uint64_t kWatchdogServedUs = 10'000;
constexpr std::array<std::uint8_t, 2> kJumpToItself{0xFF, 0xCF};

}  // namespace

void AvrBoard::sleep(avr_t* avr, avr_cycle_count_t cycles) {
  g_boards.at(avr)->slept_ += cycles;
}

void AvrBoard::reset(avr_t* avr) {
  AvrBoard& board = *g_boards.at(avr);
  board.was_reset_ = true;
  board.chip_reset_(avr);
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
  // Otherwise simavr checks its timers after every instruction.
  avr_->run_cycle_limit = kHz / 1000;
  g_boards[avr_] = this;
  chip_reset_ = avr_->reset;
  avr_->reset = reset;

  ram_end_of_static_ = elf.address("_end");
  static_ram_ = ram_end_of_static_ - elf.address("__data_start");
  std::memset(avr_->data + ram_end_of_static_, kPaint, avr_->ramend - ram_end_of_static_);

  clock_ = find_port(clock_port);
  data_ = find_port(data_port);
  for (avr_ioport_t* port : {clock_, data_}) pull_up(port, 0xFF);
  // The external interrupts share pins with the data lines; unused, they would poll a low level.
  for (std::uint8_t number = 0; number < EXTINT_COUNT; ++number) {
    avr_extint_set_strict_lvl_trig(avr_, number, 0);
  }
  avr_register_io_write(avr_, kEepromControl, on_eeprom, this);
  avr_register_io_write(avr_, kFlashControl, on_flash_control, this);
  uart_ = uart('0');
  if (uart_ != nullptr) {
    auto& reading = avr_->io[AVR_DATA_TO_IO(uart_->r_ucsra)].r;
    chip_reads_serial_status_ = reading.c;
    reading.c = on_serial_status_read;
    reading.param = this;
  }
  avr_irq_register_notify(avr_get_interrupt_irq(avr_, kWatchdogVector) + AVR_INT_IRQ_PENDING,
                          on_watchdog_interrupt, this);
}

AvrBoard::~AvrBoard() {
  g_boards.erase(avr_);
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
std::uint8_t AvrBoard::driven_high(const avr_ioport_t* port) const {
  return static_cast<std::uint8_t>(avr_->data[port->r_ddr] & avr_->data[port->r_port]);
}

void AvrBoard::pull_up(avr_ioport_t* port, std::uint8_t mask) {
  port->external.pull_mask = port->external.pull_value = mask;
  for (int bit = 0; bit < 8; ++bit) {
    if ((mask & 1u << bit) != 0) avr_raise_irq(port->io.irq + bit, 1);
  }
}

void AvrBoard::set_line(avr_ioport_t* port, int bit, bool high) {
  // simavr uses pull_value whenever the firmware writes the direction of any pin.
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
    if (was_reset_) after_reset();
  }
}

void AvrBoard::stick(bool interrupts_off) {
  stuck_at_ = avr_->pc;
  for (std::size_t i = 0; i < kJumpToItself.size(); ++i) {
    flash_where_stuck_[i] = avr_->flash[avr_->pc + i];
    avr_->flash[avr_->pc + i] = kJumpToItself[i];
  }
  avr_->state = cpu_Running;
  if (interrupts_off) avr_->sreg[S_I] = 0;
}

void AvrBoard::after_reset() {
  was_reset_ = false;
  ++resets_;
  if (stuck_at_) {
    for (std::size_t i = 0; i < flash_where_stuck_.size(); ++i) {
      avr_->flash[*stuck_at_ + i] = flash_where_stuck_[i];
    }
    stuck_at_.reset();
  }
  eeprom_busy_ = false;
  // simavr also clears the values read from pins.
  for (avr_io_t* io = avr_->io_port; io != nullptr; io = io->next) {
    if (std::strcmp(io->kind, "port") != 0) continue;
    const auto* port = reinterpret_cast<const avr_ioport_t*>(io);
    avr_->data[port->r_pin] = static_cast<std::uint8_t>(port->external.pull_value);
  }
  if (on_reset) on_reset();
}

void AvrBoard::set_eeprom(const std::vector<std::uint8_t>& bytes) {
  auto copy = bytes;
  avr_eeprom_desc_t about{copy.data(), 0, static_cast<std::uint32_t>(copy.size())};
  avr_ioctl(avr_, AVR_IOCTL_EEPROM_SET, &about);
}

std::vector<std::uint8_t> AvrBoard::eeprom() const {
  std::vector<std::uint8_t> bytes(static_cast<std::size_t>(avr_->e2end) + 1);
  avr_eeprom_desc_t about{bytes.data(), 0, static_cast<std::uint32_t>(bytes.size())};
  avr_ioctl(avr_, AVR_IOCTL_EEPROM_GET, &about);
  return bytes;
}

// simavr writes a byte at once. This runs after it and keeps the chip busy for the real write time.
void AvrBoard::on_eeprom(avr_t* avr, avr_io_addr_t, std::uint8_t value, void* parameter) {
  auto& board = *static_cast<AvrBoard*>(parameter);
  if (board.eeprom_busy_) {
    board.eeprom_misused_ = true;
  } else if ((value & (kEepromWrite | kEepromMasterWrite)) == (kEepromWrite | kEepromMasterWrite)) {
    board.eeprom_busy_ = true;
    ++board.eeprom_writes_;
    avr_cycle_timer_register(avr, kEepromUs * kCyclesPerUs, on_eeprom_written, parameter);
  }
  if (board.eeprom_busy_) avr->data[kEepromControl] |= kEepromWrite;
}

avr_cycle_count_t AvrBoard::on_eeprom_written(avr_t* avr, avr_cycle_count_t, void* parameter) {
  static_cast<AvrBoard*>(parameter)->eeprom_busy_ = false;
  avr->data[kEepromControl] &= static_cast<std::uint8_t>(~kEepromWrite);
  return 0;
}

// If a watchdog interrupt is not served before the next time-out, the chip resets; simavr would
// repeat the interrupt forever.
void AvrBoard::on_watchdog_interrupt(avr_irq_t*, std::uint32_t value, void* parameter) {
  if (value == 0) return;
  avr_cycle_timer_register(static_cast<AvrBoard*>(parameter)->avr_,
                           kWatchdogServedUs * kCyclesPerUs, on_watchdog_not_served, parameter);
}

avr_cycle_count_t AvrBoard::on_watchdog_not_served(avr_t* avr, avr_cycle_count_t, void*) {
  avr->data[kWatchdogControl] &= static_cast<std::uint8_t>(~kWatchdogInterrupts);
  return 0;
}

// Received bytes can be read at once; simavr would delay each by its time on the line after the
// previous read.
std::uint8_t AvrBoard::on_serial_status_read(avr_t* avr, avr_io_addr_t address, void* parameter) {
  auto& board = *static_cast<AvrBoard*>(parameter);
  (void)board.chip_reads_serial_status_(avr, address, board.uart_);
  const bool waits = board.uart_->input.read != board.uart_->input.write;
  std::uint8_t& status = avr->data[address];
  status = static_cast<std::uint8_t>(waits ? status | kReceived : status & ~kReceived);
  return status;
}

// The signature row replaces flash for the next load from it, which must come within three cycles.
void AvrBoard::on_flash_control(avr_t* avr, avr_io_addr_t, std::uint8_t value, void* parameter) {
  auto& board = *static_cast<AvrBoard*>(parameter);
  if (value != kReadSignature || board.flash_behind_signature_) return;
  std::array<std::uint8_t, 32> behind{};
  std::copy_n(avr->flash, behind.size(), behind.begin());
  board.flash_behind_signature_ = behind;
  std::copy(board.signature_row.begin(), board.signature_row.end(), avr->flash);
  avr_cycle_timer_register(avr, 4, on_signature_read, parameter);
}

avr_cycle_count_t AvrBoard::on_signature_read(avr_t* avr, avr_cycle_count_t, void* parameter) {
  auto& board = *static_cast<AvrBoard*>(parameter);
  std::copy(board.flash_behind_signature_->begin(), board.flash_behind_signature_->end(),
            avr->flash);
  board.flash_behind_signature_.reset();
  return 0;
}

std::size_t AvrBoard::unused_ram_bytes() const {
  std::size_t at = ram_end_of_static_;
  while (at < avr_->ramend && avr_->data[at] == kPaint) ++at;
  return at - ram_end_of_static_;
}

}  // namespace firmware_sim
