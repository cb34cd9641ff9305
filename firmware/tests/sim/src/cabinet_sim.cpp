#include "firmware_sim/cabinet_sim.h"

#include <simavr/avr_uart.h>
#include <simavr/avr_usb.h>
#include <simavr/sim_io.h>

#include <stdexcept>
#include <utility>

#include "avr_board.h"
#include "usb_host.h"

namespace firmware_sim {

std::string firmware_elf(Board board) {
  return board == Board::mega32u4 ? FIRMWARE_ELF_32U4 : FIRMWARE_ELF_2560;
}

namespace {

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

UsbBus bus_of(avr_t* avr) {
  UsbBus bus;
  bus.reset = [avr] { avr_ioctl(avr, AVR_IOCTL_USB_RESET, nullptr); };
  bus.setup = [avr](std::array<std::uint8_t, 8> setup) {
    avr_io_usb packet{0, 8, setup.data()};
    return answer_of(avr_ioctl(avr, AVR_IOCTL_USB_SETUP, &packet));
  };
  bus.read = [avr](int endpoint, std::vector<std::uint8_t>& out) {
    out.resize(64);
    avr_io_usb packet{static_cast<std::uint8_t>(endpoint), 64, out.data()};
    const auto answer = answer_of(avr_ioctl(avr, AVR_IOCTL_USB_READ, &packet));
    out.resize(answer == UsbBus::Answer::ok ? packet.sz : 0);
    return answer;
  };
  bus.write_empty = [avr](int endpoint) {
    std::uint8_t nothing = 0;
    avr_io_usb packet{static_cast<std::uint8_t>(endpoint), 0, &nothing};
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

  AvrBoard board;
  std::array<Socket, kMice> sockets;
  std::unique_ptr<UsbHost> host;
  std::vector<std::uint8_t> serial;
  std::uint64_t idle_from_cycle = 0, idle_from_slept = 0;

  Impl(const std::string& elf, Board kind, const CabinetOptions& options)
      : board(elf, kind == Board::mega32u4 ? "atmega32u4" : "atmega2560",
              kind == Board::mega32u4 ? 'B' : 'A', kind == Board::mega32u4 ? 'D' : 'C') {
    avr_t* avr = board.avr();
    for (int rod = 0; rod < kMice; ++rod) {
      Socket& socket = sockets[static_cast<std::size_t>(rod)];
      socket.cabinet = this;
      socket.bit = rod;
      socket.mouse = SimMouse(options.mice[static_cast<std::size_t>(rod)]);
      avr_cycle_timer_register(avr, 1, on_mouse, &socket);
    }
    if (kind == Board::mega32u4) {
      host = std::make_unique<UsbHost>(bus_of(avr), options.host_poll_us);
      avr_irq_register_notify(avr_io_getirq(avr, AVR_IOCTL_USB_GETIRQ(), USB_IRQ_ATTACH), on_attach,
                              this);
      avr_cycle_timer_register(avr, 1, on_host, this);
    } else {
      std::uint32_t flags = 0;
      avr_ioctl(avr, AVR_IOCTL_UART_SET_FLAGS('0'), &flags);
      avr_irq_register_notify(avr_io_getirq(avr, AVR_IOCTL_UART_GETIRQ('0'), UART_IRQ_OUTPUT),
                              on_serial, this);
    }
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
  for (Impl::Socket& socket : impl_->sockets) impl_->show(socket);  // plugged or unplugged since
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
std::vector<std::uint8_t> CabinetSim::take_serial() {
  return std::exchange(impl_->serial, {});
}

bool CabinetSim::usb_configured() const {
  return impl_->usb().configured();
}
void CabinetSim::usb_reset() {
  impl_->usb().reset_port();
}
const std::vector<std::uint8_t>& CabinetSim::device_descriptor() const {
  return impl_->usb().device;
}
const std::vector<std::uint8_t>& CabinetSim::configuration_descriptor() const {
  return impl_->usb().configuration;
}
const std::vector<std::uint8_t>& CabinetSim::report_descriptor() const {
  return impl_->usb().report;
}

CabinetSim::ControlResult CabinetSim::control(const std::array<std::uint8_t, 8>& setup) {
  UsbHost& host = impl_->usb();
  host.request(setup);
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
      11;  // simavr's: start, 8 data, parity whether used or not, stop
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
