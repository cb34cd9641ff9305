#include "device_watch.h"

#include <cerrno>
#include <cstring>
#include <utility>

namespace server {
namespace {

using cabinet::DeviceState;
using wire::make_sentence;
using wire::Sentence;
using wire::SentenceId;

Sentence refusal(const std::string& name, int error) {
  const std::string why = std::strerror(error);
  switch (error) {
    case EACCES:
    case EPERM:
      return make_sentence<SentenceId::device_not_allowed>(name, why);
    case EBUSY:
      return make_sentence<SentenceId::device_busy>(name, why);
    default:
      return make_sentence<SentenceId::device_refused>(name, why);
  }
}

Sentence sentence(const cabinet::Device& device, DeviceState state, bool ever_live) {
  const std::string& name = device.name();
  switch (state) {
    case DeviceState::refused:
      return refusal(name, device.open_error());
    case DeviceState::missing:
      return ever_live ? make_sentence<SentenceId::device_unplugged>(name)
                       : make_sentence<SentenceId::device_missing>(name);
    case DeviceState::silent:
      return make_sentence<SentenceId::device_silent>(name);
    case DeviceState::garbled:
      return make_sentence<SentenceId::device_garbled>(name);
    case DeviceState::over:
      return ever_live ? make_sentence<SentenceId::device_over>(name)
                       : make_sentence<SentenceId::device_without_frames>(name);
    case DeviceState::live:
      break;
  }
  return {};
}

}  // namespace

bool DeviceWatch::due(const Watched& watched, std::int64_t now_us) {
  if (watched.reported == watched.state) return false;
  if (watched.state == DeviceState::live || watched.state == DeviceState::over) return true;
  return watched.reported == DeviceState::live || now_us - watched.since_us > kPatienceUs;
}

void DeviceWatch::look(const std::vector<std::unique_ptr<cabinet::Device>>& devices,
                       std::int64_t now_us, const Report& report) {
  while (watched_.size() < devices.size()) watched_.push_back({DeviceState::missing, now_us, {}});
  for (std::uint32_t i = 0; i < devices.size(); ++i) {
    Watched& watched = watched_[i];
    const DeviceState state = devices[i]->state();
    // Before the first report, the time runs from the beginning, through all changes of state.
    if (watched.state != state && watched.reported) watched.since_us = now_us;
    watched.state = state;
    if (!due(watched, now_us)) continue;
    const bool live = state == DeviceState::live;
    if (!live || watched.reported)
      report(i, sentence(*devices[i], state, watched.ever_live), devices[i]->name() + " is back");
    watched.ever_live = watched.ever_live || live;
    watched.reported = state;
  }
}

void DeviceWatch::look_at_sensors(const std::vector<std::unique_ptr<cabinet::Device>>& devices,
                                  std::int64_t now_us, const Report& report) {
  saturations_.resize(devices.size());
  for (std::uint32_t i = 0; i < devices.size(); ++i) {
    Saturation& known = saturations_[i];
    const std::uint64_t overflows = devices[i]->counters().overflows;
    const std::string& name = devices[i]->name();
    if (overflows != std::exchange(known.overflows, overflows)) {
      known.last_us = now_us;
      if (!std::exchange(known.reported, true))
        report(i, make_sentence<SentenceId::device_too_fast>(name), {});
    } else if (known.reported && now_us - known.last_us > kSaturationShownUs) {
      known.reported = false;
      report(i, {}, name + ": its sensors follow again");
    }
  }
}

}  // namespace server
