#include "client/devices_menu.h"

#include <algorithm>

#include "wire/enums.h"

#define N_(english) english  // for xgettext: render/translate.h

namespace client {
namespace {

const char* name_of(std::uint8_t state) {
  constexpr std::array<const char*, wire::kDeviceStateCount> kNames{
      N_("not connected"), N_("cannot be opened"), N_("sends nothing"), N_("sends no frame"),
      N_("live"),          N_("recording is over")};
  return state < kNames.size() ? kNames[state] : "";
}

// A restarted server counts from 0.
bool goes_on(const wire::DeviceReport& before, const wire::DeviceReport& now) {
  return before.name == now.name && before.frames <= now.frames && before.lost <= now.lost &&
         before.stamped <= now.stamped && before.latency_sum_us <= now.latency_sum_us;
}

void add(DeviceView& view, const wire::DeviceReport& now, std::int64_t time_us) {
  constexpr std::int64_t kSecondUs = 1'000'000;
  const bool backwards = !view.totals.empty() && view.totals.back().time_us >= time_us;
  if (backwards || !goes_on(view.now, now)) view = {};
  view.now = now;
  view.totals.push_back({time_us, now.frames, now.lost, now.stamped, now.latency_sum_us});
  while (view.totals.size() > 2 && view.totals[1].time_us <= time_us - kSecondUs)
    view.totals.pop_front();
  const DeviceView::Totals &from = view.totals.front(), &to = view.totals.back();
  const double seconds = 1e-6 * static_cast<double>(to.time_us - from.time_us);
  view.frames_per_second =
      seconds > 0.0 ? static_cast<double>(to.frames - from.frames) / seconds : 0.0;
  view.lost = to.lost - from.lost;
  const auto stamped = static_cast<double>(to.stamped - from.stamped);
  view.latency_ms =
      stamped > 0.0 ? 1e-3 * static_cast<double>(to.latency_sum_us - from.latency_sum_us) / stamped
                    : -1.0;
  const double at = 1e-6 * static_cast<double>(time_us);
  for (std::size_t rod = 0; rod < view.traces.size(); ++rod) {
    auto& trace = view.traces[rod];
    trace.push_back({at, static_cast<double>(now.rods[rod].slide_counts),
                     static_cast<double>(now.rods[rod].spin_counts)});
    while (trace.front().seconds < at - DeviceView::kTraceSeconds) trace.pop_front();
  }
}

}  // namespace

bool DevicesMenu::ask(std::int64_t now_us) {
  const std::int64_t since = now_us - asked_us_;
  if (!host_ || since < (waits_ ? kPatienceUs : kAskEveryUs)) return false;
  asked_us_ = now_us;
  waits_ = true;
  return true;
}

void DevicesMenu::update(const wire::Devices& reported) {
  waits_ = false;
  answered_ = true;
  devices_.resize(reported.devices.size());
  for (std::size_t i = 0; i < reported.devices.size(); ++i) {
    if (!devices_[i]) devices_[i] = std::make_shared<DeviceView>();
    add(*devices_[i], reported.devices[i], reported.time_us);
  }
}

void DevicesMenu::follow(std::uint64_t session, bool host) {
  if (session == session_ && host == host_) return;
  *this = {};
  session_ = session;
  host_ = host;
}

MenuPage DevicesMenu::page(int row) const {
  MenuPage page;
  for (const auto& device : devices_) {
    page.rows.push_back({.label = device->now.name,
                         .value = name_of(device->now.state),
                         .translate_label = false,
                         .fixed = true});
  }
  if (devices_.empty()) {
    page.note = !host_      ? N_("Only the host sees the controllers of the server's machine.")
                : answered_ ? N_("No controller or mouse moves a rod at the server's machine: "
                                 "start it with --device, and see ./play --doctor.")
                            : N_("Waiting for the server.");
    return page;
  }
  const auto chosen = static_cast<std::size_t>(std::max(row, 0));
  page.device = devices_[std::min(chosen, devices_.size() - 1)];
  return page;
}

}  // namespace client
