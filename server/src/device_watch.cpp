#include "device_watch.h"

namespace server {

void DeviceWatch::look(const std::vector<std::unique_ptr<cabinet::DeviceSource>>& devices,
                       std::int64_t now_us, const Tell& tell) {
  using Level = wire::Notice::Level;
  while (watched_.size() < devices.size()) watched_.push_back({State::awaited, now_us});
  for (std::uint32_t i = 0; i < devices.size(); ++i) {
    Watched& watched = watched_[i];
    const std::string& name = devices[i]->name();
    const bool connected = devices[i]->connected();
    if (connected && watched.state != State::present) {
      if (watched.state == State::gone) tell(Level::cleared, i, name + " is back");
      watched.state = State::present;
    } else if (!connected && watched.state == State::present) {
      tell(Level::warning, i, name + " unplugged: its rods hold");
      watched.state = State::gone;
    } else if (watched.state == State::awaited && now_us - watched.since_us > kPatienceUs) {
      tell(Level::warning, i, name + " is not there: plug it in");
      watched.state = State::gone;
    }
  }
}

}  // namespace server
