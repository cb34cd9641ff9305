#include "usb_host.h"

#include <algorithm>
#include <utility>

namespace firmware_sim {

namespace {
constexpr std::uint32_t kStageUs = 60;  // between the stages of a control transfer
// Unlike the chip, simavr accepts data over a setup packet that the firmware has not read yet.
constexpr std::uint32_t kSetupReadUs = 1000;
constexpr std::uint32_t kResetUs = 10'000;
constexpr std::size_t kControlBytes = 64;
constexpr int kCommandEndpoint = 2;
constexpr std::array<std::uint8_t, 8> kGetDevice64{0x80, 6, 0, 1, 0, 0, 64, 0};
constexpr std::array<std::uint8_t, 8> kGetDevice{0x80, 6, 0, 1, 0, 0, 18, 0};
constexpr std::array<std::uint8_t, 8> kGetConfigurationHead{0x80, 6, 0, 2, 0, 0, 9, 0};
constexpr std::array<std::uint8_t, 8> kGetConfiguration{0x80, 6, 0, 2, 0, 0, 255, 0};
constexpr std::array<std::uint8_t, 8> kGetName{0x80, 6, 2, 3, 9, 4, 255, 0};
constexpr std::array<std::uint8_t, 8> kGetSerial{0x80, 6, 3, 3, 9, 4, 255, 0};
constexpr std::array<std::uint8_t, 8> kSetAddress{0, 5, 5, 0, 0, 0, 0, 0};
constexpr std::array<std::uint8_t, 8> kSetConfiguration{0, 9, 1, 0, 0, 0, 0, 0};
constexpr std::uint8_t kInterfaceDescriptor = 4, kEndpointDescriptor = 5;
}  // namespace

void UsbHost::attached(std::uint64_t now_us) {
  if (unplugged_) return;
  attached_ = true;
  next_poll_us_ = now_us;
  reset_port();
}

void UsbHost::detached() {
  attached_ = false;
  configured_ = false;
  transfers_.clear();
}

void UsbHost::unplug() {
  unplugged_ = true;
  detached();
}

void UsbHost::reset_port() {
  configured_ = false;
  transfers_.clear();
  reset_due_ = true;
}

void UsbHost::enumerate() {
  using Result = CabinetSim::ControlResult;
  add(kGetDevice64);
  add(kSetAddress);
  add(kGetDevice, [this](Result result) { device = std::move(result.data); });
  add(kGetConfigurationHead);
  add(kGetConfiguration, [this](Result result) { take_configuration(std::move(result)); });
}

void UsbHost::take_configuration(CabinetSim::ControlResult got) {
  using Result = CabinetSim::ControlResult;
  configuration = std::move(got.data);
  in_endpoints_.clear();
  for (std::size_t at = 0; at + 4 < configuration.size() && configuration[at] > 1;
       at += configuration[at]) {
    const std::uint8_t kind = configuration[at + 1], address = configuration[at + 2];
    if (kind == kInterfaceDescriptor) in_endpoints_.push_back(0);
    const bool to_host = kind == kEndpointDescriptor && (address & 0x80) != 0;
    if (to_host && !in_endpoints_.empty()) in_endpoints_.back() = address & 0x0F;
  }
  add(kGetName);
  add(kGetSerial, [this](Result result) { serial = std::move(result.data); });
  add(kSetConfiguration);
  report.assign(in_endpoints_.size(), {});
  for (std::uint8_t number = 0; number < in_endpoints_.size(); ++number) {
    add({0x21, 10, 0, 0, number, 0, 0, 0});  // SET_IDLE
    add({0x81, 6, 0, 0x22, number, 0, 255, 0}, [this, number](Result result) {
      report[number] = std::move(result.data);
      configured_ = number + 1u == in_endpoints_.size();
      enumerations_ += configured_ ? 1 : 0;
    });
  }
}

void UsbHost::request(const Setup& setup, std::vector<std::uint8_t> data) {
  const auto keep = [this](CabinetSim::ControlResult result) { result_ = std::move(result); };
  add(setup, keep, std::move(data));
}

void UsbHost::add(const Setup& setup, Done done, std::vector<std::uint8_t> data) {
  Transfer transfer;
  transfer.setup = setup;
  transfer.data = std::move(data);
  transfer.done = std::move(done);
  transfers_.push_back(std::move(transfer));
}

std::uint32_t UsbHost::run(std::uint64_t now_us) {
  if (!attached_) return 1000;
  if (reset_due_) {
    reset_due_ = false;
    bus_.reset();
    enumerate();
    return kResetUs;
  }
  if (configured_ && now_us >= next_poll_us_) {
    next_poll_us_ = std::max(next_poll_us_ + poll_us_, now_us);
    if (reads_frames_) poll_report(now_us);
    poll_pads(now_us);
    send_report(now_us);
  }
  if (!transfers_.empty()) {
    const bool data_follows =
        transfers_.front().stage == Stage::setup && !transfers_.front().data.empty();
    step_transfer();
    return data_follows ? kSetupReadUs : kStageUs;
  }
  return static_cast<std::uint32_t>(std::max<std::uint64_t>(next_poll_us_, now_us + 1) - now_us);
}

void UsbHost::poll_report(std::uint64_t now_us) {
  std::vector<std::uint8_t> bytes;
  if (bus_.read(1, bytes) != UsbBus::Answer::ok || bytes.size() != 64) return;
  Report taken;
  taken.time_us = now_us;
  std::copy(bytes.begin(), bytes.end(), taken.bytes.begin());
  reports_.push_back(taken);
}

void UsbHost::poll_pads(std::uint64_t now_us) {
  for (std::size_t number = 1; number < in_endpoints_.size(); ++number) {
    std::vector<std::uint8_t> bytes;
    if (bus_.read(in_endpoints_[number], bytes) != UsbBus::Answer::ok) continue;
    pad_reports_.push_back({now_us, static_cast<int>(number), std::move(bytes)});
  }
}

void UsbHost::send_report(std::uint64_t now_us) {
  if (outgoing_.empty()) return;
  if (bus_.write(kCommandEndpoint, outgoing_.front()) != UsbBus::Answer::ok) return;
  outgoing_.pop_front();
  last_sent_us_ = now_us;
}

void UsbHost::step_transfer() {
  using Answer = UsbBus::Answer;
  Transfer& transfer = transfers_.front();
  const std::size_t asked = static_cast<std::size_t>(transfer.setup[6] | transfer.setup[7] << 8);
  const bool to_host = (transfer.setup[0] & 0x80) != 0 && asked > 0;
  std::vector<std::uint8_t> bytes;
  Answer answer = Answer::nak;
  switch (transfer.stage) {
    case Stage::setup:
      if (bus_.setup(transfer.setup) == Answer::ok) {
        transfer.stage = to_host                 ? Stage::data_in
                         : transfer.data.empty() ? Stage::status_in
                                                 : Stage::data_out;
      }
      return;
    case Stage::data_in: {
      answer = bus_.read(0, bytes);
      if (answer != Answer::ok) break;
      std::vector<std::uint8_t>& data = transfer.result.data;
      data.insert(data.end(), bytes.begin(), bytes.end());
      if (bytes.size() < kControlBytes || data.size() >= asked) transfer.stage = Stage::status_out;
      return;
    }
    case Stage::data_out:
      answer = bus_.write(0, transfer.data);
      if (answer != Answer::ok) break;
      transfer.stage = Stage::status_in;
      return;
    case Stage::status_in:
      answer = bus_.read(0, bytes);
      if (answer == Answer::ok) return end_transfer(false);
      break;
    case Stage::status_out:
      answer = bus_.write(0, {});
      if (answer == Answer::ok) return end_transfer(false);
      break;
  }
  if (answer == Answer::stall) end_transfer(true);
}

void UsbHost::end_transfer(bool stalled) {
  Transfer transfer = std::move(transfers_.front());
  transfers_.pop_front();
  transfer.result.stalled = stalled;
  if (transfer.done) transfer.done(std::move(transfer.result));
}

}  // namespace firmware_sim
