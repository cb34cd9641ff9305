#include "device_watch.h"

#include <cerrno>
#include <cstring>

namespace server {
namespace {

using cabinet::DeviceState;

std::string refusal(const std::string& name, int error) {
  const std::string what = name + " cannot be opened: " + std::strerror(error);
  switch (error) {
    case EACCES:
    case EPERM:
      return what + "; install cabinet/70-space-foosball.rules or join the device's group";
    case EBUSY:
      return what + "; end the other program that uses it";
    default:
      return what + "; plug it in anew, or give another address";
  }
}

std::string sentence(const cabinet::DeviceSource& device, DeviceState state, bool ever_live) {
  const std::string& name = device.name();
  switch (state) {
    case DeviceState::refused:
      return refusal(name, device.open_error());
    case DeviceState::missing:
      return ever_live ? name + " unplugged: its rods hold; plug it in again"
                       : name + " is not there: plug it in, or give its right address";
    case DeviceState::silent:
      return name + " is there but sends nothing: plug it in anew, and check its firmware";
    case DeviceState::garbled:
      return name + " sends what is no frame: is it the right device, with our firmware?";
    case DeviceState::over:
      return ever_live ? name + " is over: its rods hold"
                       : name + " holds no frame: give a recording of a controller";
    case DeviceState::live:
      return name + " is back";
  }
  return name;
}

}  // namespace

bool DeviceWatch::due(const Watched& watched, std::int64_t now_us) {
  if (watched.told == watched.state) return false;
  if (watched.state == DeviceState::live || watched.state == DeviceState::over) return true;
  return watched.told == DeviceState::live || now_us - watched.since_us > kPatienceUs;
}

void DeviceWatch::look(const std::vector<std::unique_ptr<cabinet::DeviceSource>>& devices,
                       std::int64_t now_us, const Tell& tell) {
  using Level = wire::Notice::Level;
  while (watched_.size() < devices.size()) watched_.push_back({DeviceState::missing, now_us, {}});
  for (std::uint32_t i = 0; i < devices.size(); ++i) {
    Watched& watched = watched_[i];
    const DeviceState state = devices[i]->state();
    // Until anything was told, the time runs from the beginning, whatever the device tries.
    if (watched.state != state && watched.told) watched.since_us = now_us;
    watched.state = state;
    if (!due(watched, now_us)) continue;
    const bool live = state == DeviceState::live;
    if (!live || watched.told) {
      tell(live ? Level::cleared : Level::warning, i,
           sentence(*devices[i], state, watched.ever_live));
    }
    watched.ever_live = watched.ever_live || live;
    watched.told = state;
  }
}

}  // namespace server
