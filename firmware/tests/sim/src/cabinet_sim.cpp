#include "firmware_sim/cabinet_sim.h"

#include <simavr/avr_ioport.h>
#include <simavr/avr_uart.h>
#include <simavr/avr_usb.h>
#include <simavr/sim_io.h>

#include <algorithm>
#include <deque>
#include <stdexcept>
#include <utility>

#include "avr_board.h"
#include "more_endpoints.h"
#include "two_wire.h"
#include "usb_host.h"

namespace firmware_sim {

std::string firmware_elf(Board board) {
  return board == Board::mega32u4 ? FIRMWARE_ELF_32U4 : FIRMWARE_ELF_2560;
}

namespace {

// Pins of firmware/hal/board.h, and register addresses of the LED's timer.
struct BoardPins {
  const char* mcu;
  char clock_port, data_port;
  char i2c_port;
  int i2c_clock, i2c_data;
  char motors_port;
  int motors_bit;
  std::uint16_t led_control, led_width;
};
constexpr BoardPins kMega32u4{"atmega32u4", 'B', 'D', 'F', 1, 0, 'C', 6, 0xC0, 0xCF};
constexpr BoardPins kMega2560{"atmega2560", 'A', 'C', 'D', 0, 1, 'D', 2, 0x44, 0x47};
constexpr std::uint8_t kLedConnected = 0x80;  // in led_control
constexpr std::uint64_t kSerialByteUs = 11;   // simavr's byte has 11 bits

const BoardPins& pins_of(Board board) {
  return board == Board::mega32u4 ? kMega32u4 : kMega2560;
}

constexpr std::uint64_t ns_of(std::uint64_t cycle) {
  return cycle * 125 / 2;
}
constexpr std::uint64_t cycle_after(std::uint64_t ns) {
  return (ns * 2 + 124) / 125;
}
static_assert(AvrBoard::kHz == 16'000'000, "62.5 ns a cycle");

UsbBus::Answer answer_of(int result) {
  if (result == AVR_IOCTL_USB_STALL) return UsbBus::Answer::stall;
  return result == AVR_IOCTL_USB_OK ? UsbBus::Answer::ok : UsbBus::Answer::nak;
}

UsbBus bus_of(avr_t* avr, MoreEndpoints& more) {
  UsbBus bus;
  bus.reset = [avr, &more] {
    more.reset();
    avr_ioctl(avr, AVR_IOCTL_USB_RESET, nullptr);
  };
  bus.setup = [avr](std::array<std::uint8_t, 8> setup) {
    avr_io_usb packet{0, 8, setup.data()};
    return answer_of(avr_ioctl(avr, AVR_IOCTL_USB_SETUP, &packet));
  };
  bus.read = [avr, &more](int endpoint, std::vector<std::uint8_t>& out) {
    if (endpoint >= MoreEndpoints::kFirst) return more.read(endpoint, out);
    out.resize(64);
    avr_io_usb packet{static_cast<std::uint8_t>(endpoint), 64, out.data()};
    const auto answer = answer_of(avr_ioctl(avr, AVR_IOCTL_USB_READ, &packet));
    out.resize(answer == UsbBus::Answer::ok ? packet.sz : 0);
    return answer;
  };
  bus.write = [avr](int endpoint, std::span<const std::uint8_t> bytes) {
    std::array<std::uint8_t, 64> copy{};
    std::copy(bytes.begin(), bytes.end(), copy.begin());
    avr_io_usb packet{static_cast<std::uint8_t>(endpoint), static_cast<std::uint32_t>(bytes.size()),
                      copy.data()};
    return answer_of(avr_ioctl(avr, AVR_IOCTL_USB_WRITE, &packet));
  };
  return bus;
}

}  // namespace

struct CabinetSim::Impl {
  struct Socket {  // a mouse and its two pins
    Impl* cabinet = nullptr;
    int bit = 0;
    SimMouse mouse;
    bool clock_high = true, data_high = true;
  };

  const BoardPins& pins;
  AvrBoard board;
  std::array<Socket, kMice> sockets;
  avr_ioport_t* i2c;
  avr_ioport_t* motors_port;
  MotorBus motors;
  TwoWire two_wire;
  bool drove_high = false;
  std::unique_ptr<MoreEndpoints> more_endpoints;
  std::unique_ptr<UsbHost> host;
  std::vector<std::uint8_t> serial;
  std::deque<std::uint8_t> to_serial;
  std::uint64_t last_serial_us = 0;
  int overruns = 0;
  std::uint64_t idle_from_cycle = 0, idle_from_slept = 0;

  Impl(const std::string& elf, Board kind, const CabinetOptions& options)
      : pins(pins_of(kind)),
        board(elf, pins.mcu, pins.clock_port, pins.data_port),
        i2c(board.find_port(pins.i2c_port)),
        motors_port(board.find_port(pins.motors_port)),
        two_wire(board.avr(), {[this] { drive_motors_as_they_are(); },
                               [this] { return !two_wire.clock_low() && !motors.pulls_clock(); },
                               [this] { return !two_wire.data_low() && !motors.pulls_data(); }}) {
    avr_t* avr = board.avr();
    for (int rod = 0; rod < kMice; ++rod) {
      Socket& socket = sockets[static_cast<std::size_t>(rod)];
      socket.cabinet = this;
      socket.bit = rod;
      socket.mouse = SimMouse(options.mice[static_cast<std::size_t>(rod)]);
    }
    board.pull_up(i2c, static_cast<std::uint8_t>(1u << pins.i2c_clock | 1u << pins.i2c_data));
    avr_irq_register_notify(i2c->io.irq + IOPORT_IRQ_DIRECTION_ALL, on_i2c_direction, this);
    avr_irq_register_notify(i2c->io.irq + IOPORT_IRQ_REG_PORT, on_i2c_port, this);
    if (!options.eeprom.empty()) board.set_eeprom(options.eeprom);
    std::copy(options.unique_id.begin(), options.unique_id.end(),
              board.signature_row.begin() + 0x0E);
    board.on_reset = [this] {
      if (host) {
        host->detached();
        more_endpoints->reset();
      }
      if (two_wire.present()) two_wire.reset();
      begin_timers();
    };
    if (kind == Board::mega32u4) {
      more_endpoints = std::make_unique<MoreEndpoints>(avr);
      more_endpoints->on_detach = [this] { host->detached(); };
      host = std::make_unique<UsbHost>(bus_of(avr, *more_endpoints), options.host_poll_us);
      avr_irq_register_notify(avr_io_getirq(avr, AVR_IOCTL_USB_GETIRQ(), USB_IRQ_ATTACH), on_attach,
                              this);
    } else {
      std::uint32_t flags = 0;
      avr_ioctl(avr, AVR_IOCTL_UART_SET_FLAGS('0'), &flags);
      avr_irq_register_notify(avr_io_getirq(avr, AVR_IOCTL_UART_GETIRQ('0'), UART_IRQ_OUTPUT),
                              on_serial, this);
    }
    begin_timers();
  }

  void begin_timers() {
    avr_t* avr = board.avr();
    for (Socket& socket : sockets) avr_cycle_timer_register(avr, 1, on_mouse, &socket);
    if (host) avr_cycle_timer_register(avr, 1, on_host, this);
    if (!to_serial.empty()) avr_cycle_timer_register(avr, 1, on_send_serial, this);
  }

  std::uint64_t now_us() const { return board.cycle() / AvrBoard::kCyclesPerUs; }

  void show(Socket& socket) {
    const bool clock_high = !socket.mouse.clock_low(), data_high = !socket.mouse.data_low();
    if (std::exchange(socket.data_high, data_high) != data_high)
      board.set_data(socket.bit, data_high);
    if (std::exchange(socket.clock_high, clock_high) != clock_high)
      board.set_clock(socket.bit, clock_high);
  }

  static avr_cycle_count_t on_mouse(avr_t* avr, avr_cycle_count_t, void* parameter) {
    auto& socket = *static_cast<Socket*>(parameter);
    Impl& cabinet = *socket.cabinet;
    const std::uint64_t now_ns = ns_of(avr->cycle);
    const unsigned mask = 1u << socket.bit;
    while (socket.mouse.next_event_ns() <= now_ns) {
      socket.mouse.step(now_ns, (cabinet.board.clock_pulled() & mask) != 0,
                        (cabinet.board.data_pulled() & mask) != 0);
    }
    cabinet.show(socket);
    return cycle_after(socket.mouse.next_event_ns());
  }

  static avr_cycle_count_t on_host(avr_t* avr, avr_cycle_count_t, void* parameter) {
    auto& cabinet = *static_cast<Impl*>(parameter);
    return avr->cycle + cabinet.host->run(cabinet.now_us()) * AvrBoard::kCyclesPerUs;
  }

  static void on_attach(avr_irq_t*, std::uint32_t value, void* parameter) {
    auto& cabinet = *static_cast<Impl*>(parameter);
    if (value != 0) cabinet.host->attached(cabinet.now_us());
  }

  static void on_serial(avr_irq_t*, std::uint32_t value, void* parameter) {
    static_cast<Impl*>(parameter)->serial.push_back(static_cast<std::uint8_t>(value));
  }

  static avr_cycle_count_t on_send_serial(avr_t* avr, avr_cycle_count_t, void* parameter) {
    auto& cabinet = *static_cast<Impl*>(parameter);
    // The chip buffers two bytes besides the one being received.
    const auto& waiting = cabinet.board.uart('0')->input;
    if ((waiting.write + uart_fifo_fifo_size - waiting.read) % uart_fifo_fifo_size > 2) {
      ++cabinet.overruns;
    } else {
      avr_raise_irq(avr_io_getirq(avr, AVR_IOCTL_UART_GETIRQ('0'), UART_IRQ_INPUT),
                    cabinet.to_serial.front());
    }
    cabinet.to_serial.pop_front();
    cabinet.last_serial_us = cabinet.now_us() + kSerialByteUs;
    return cabinet.to_serial.empty() ? 0 : avr->cycle + kSerialByteUs * AvrBoard::kCyclesPerUs;
  }

  // ---- the motors' bus
  static void on_i2c_direction(avr_irq_t*, std::uint32_t value, void* parameter) {
    auto& cabinet = *static_cast<Impl*>(parameter);
    cabinet.drive_motors(value, cabinet.board.memory(cabinet.i2c->r_port));
  }
  static void on_i2c_port(avr_irq_t*, std::uint32_t value, void* parameter) {
    auto& cabinet = *static_cast<Impl*>(parameter);
    cabinet.drive_motors(cabinet.board.memory(cabinet.i2c->r_ddr), value);
  }
  static avr_cycle_count_t on_motors(avr_t*, avr_cycle_count_t, void* parameter) {
    static_cast<Impl*>(parameter)->drive_motors_as_they_are();
    return 0;
  }
  void drive_motors_as_they_are() {
    drive_motors(board.memory(i2c->r_ddr), board.memory(i2c->r_port));
  }
  void drive_motors(unsigned direction, unsigned port) {
    const unsigned lines = 1u << pins.i2c_clock | 1u << pins.i2c_data;
    if ((direction & port & lines) != 0) drove_high = true;
    const unsigned low = direction & ~port;
    motors.drive(ns_of(board.cycle()), (low >> pins.i2c_clock & 1) != 0 || two_wire.clock_low(),
                 (low >> pins.i2c_data & 1) != 0 || two_wire.data_low());
    board.set_line(i2c, pins.i2c_clock, !motors.pulls_clock());
    board.set_line(i2c, pins.i2c_data, !motors.pulls_data());
    if (const auto event = motors.next_event_ns()) {
      avr_cycle_timer_register(board.avr(), cycle_after(*event) - board.cycle(), on_motors, this);
    }
  }

  UsbHost& usb() const {
    if (!host) throw std::runtime_error("this board has no USB device");
    return *host;
  }
};

CabinetSim::CabinetSim(const std::string& elf, Board board, const CabinetOptions& options)
    : impl_(std::make_unique<Impl>(elf, board, options)) {}
CabinetSim::CabinetSim(Board board, const CabinetOptions& options)
    : CabinetSim(firmware_elf(board), board, options) {}
CabinetSim::~CabinetSim() = default;

void CabinetSim::advance_us(std::uint64_t us) {
  // May have been plugged or unplugged.
  for (Impl::Socket& socket : impl_->sockets) impl_->show(socket);
  Impl::on_motors(nullptr, 0, impl_.get());  // may have been held or released
  impl_->board.run_until((now_us() + us) * AvrBoard::kCyclesPerUs);
}

std::uint64_t CabinetSim::now_us() const {
  return impl_->now_us();
}

SimMouse& CabinetSim::mouse(int rod) {
  return impl_->sockets.at(static_cast<std::size_t>(rod)).mouse;
}

bool CabinetSim::all_enabled() const {
  for (const Impl::Socket& socket : impl_->sockets) {
    if (socket.mouse.plugged() && !socket.mouse.enabled()) return false;
  }
  return true;
}

std::vector<Report> CabinetSim::take_reports() {
  return impl_->usb().take_reports();
}
std::vector<PadReport> CabinetSim::take_pad_reports() {
  return impl_->usb().take_pad_reports();
}
std::vector<std::uint8_t> CabinetSim::take_serial() {
  return std::exchange(impl_->serial, {});
}

void CabinetSim::send(std::span<const std::uint8_t> bytes) {
  if (impl_->host) {
    impl_->host->send({bytes.begin(), bytes.end()});
    return;
  }
  const bool idle = impl_->to_serial.empty();
  impl_->to_serial.insert(impl_->to_serial.end(), bytes.begin(), bytes.end());
  if (idle) avr_cycle_timer_register(impl_->board.avr(), 1, Impl::on_send_serial, impl_.get());
}
bool CabinetSim::all_sent() const {
  return impl_->host ? impl_->host->unsent() == 0
                     : impl_->to_serial.empty() && now_us() >= impl_->last_serial_us;
}
std::uint64_t CabinetSim::last_sent_us() const {
  return impl_->host ? impl_->host->last_sent_us() : impl_->last_serial_us;
}
int CabinetSim::serial_overruns() const {
  return impl_->overruns;
}

MotorBus& CabinetSim::motors() {
  return impl_->motors;
}
bool CabinetSim::motors_enabled() const {
  return (impl_->board.driven_high(impl_->motors_port) >> impl_->pins.motors_bit & 1) != 0;
}
bool CabinetSim::drove_high() const {
  return impl_->drove_high;
}
std::uint8_t CabinetSim::led() const {
  const AvrBoard& board = impl_->board;
  const bool connected = (board.memory(impl_->pins.led_control) & kLedConnected) != 0;
  return connected ? board.memory(impl_->pins.led_width) : 0;
}

std::vector<std::uint8_t> CabinetSim::eeprom() const {
  return impl_->board.eeprom();
}
std::uint64_t CabinetSim::eeprom_writes() const {
  return impl_->board.eeprom_writes();
}
bool CabinetSim::eeprom_misused() const {
  return impl_->board.eeprom_misused();
}
void CabinetSim::stick_program(bool interrupts_off) {
  impl_->board.stick(interrupts_off);
}
int CabinetSim::resets() const {
  return impl_->board.resets();
}

bool CabinetSim::usb_configured() const {
  return impl_->usb().configured();
}
void CabinetSim::usb_reset() {
  impl_->usb().reset_port();
}
void CabinetSim::usb_unplug() {
  impl_->usb().unplug();
}
const std::vector<std::uint8_t>& CabinetSim::device_descriptor() const {
  return impl_->usb().device;
}
const std::vector<std::uint8_t>& CabinetSim::configuration_descriptor() const {
  return impl_->usb().configuration;
}
const std::vector<std::uint8_t>& CabinetSim::report_descriptor(int interface) const {
  return impl_->usb().report.at(static_cast<std::size_t>(interface));
}
int CabinetSim::usb_interfaces() const {
  return static_cast<int>(impl_->usb().report.size());
}
int CabinetSim::usb_enumerations() const {
  return impl_->usb().enumerations();
}
void CabinetSim::usb_read_frames(bool on) {
  impl_->usb().read_frames(on);
}
const std::vector<std::string>& CabinetSim::usb_violations() const {
  impl_->usb();
  return impl_->more_endpoints->violations();
}

const std::vector<std::uint8_t>& CabinetSim::serial_descriptor() const {
  return impl_->usb().serial;
}

CabinetSim::ControlResult CabinetSim::control(const std::array<std::uint8_t, 8>& setup,
                                              std::vector<std::uint8_t> data) {
  UsbHost& host = impl_->usb();
  host.request(setup, std::move(data));
  for (int ms = 0; ms < 50; ++ms) {
    advance_us(1000);
    if (auto result = host.take_result()) return *std::move(result);
  }
  throw std::runtime_error("the device did not answer a control transfer");
}

std::uint32_t CabinetSim::serial_baud() const {
  const avr_uart_t* uart = impl_->board.uart('0');
  if (uart == nullptr || uart->cycles_per_byte == 0) return 0;
  constexpr std::uint64_t kBitsCounted =
      11;  // simavr's count: start, 8 data, parity whether used or not, stop
  return static_cast<std::uint32_t>(AvrBoard::kHz * kBitsCounted / uart->cycles_per_byte);
}

double CabinetSim::idle_share() const {
  const auto slept = static_cast<double>(impl_->board.slept_cycles() - impl_->idle_from_slept);
  return slept / static_cast<double>(impl_->board.cycle() - impl_->idle_from_cycle);
}
void CabinetSim::reset_idle() {
  impl_->idle_from_slept = impl_->board.slept_cycles();
  impl_->idle_from_cycle = impl_->board.cycle();
}
std::size_t CabinetSim::static_ram_bytes() const {
  return impl_->board.static_ram_bytes();
}
std::size_t CabinetSim::unused_ram_bytes() const {
  return impl_->board.unused_ram_bytes();
}

}  // namespace firmware_sim
