#include "scripted_scene.h"

#include <cmath>

namespace client {

void place_men(wire::Snapshot& state) {
  const foosball::TableSpec& table =
      foosball::table_spec(static_cast<foosball::Layout>(state.layout));
  state.men.clear();
  for (std::size_t r = 0; r < state.rods.size(); ++r) {
    const wire::RodSnapshot& rod = state.rods[r];
    for (int m = 0; m < table.rods[r].men; ++m) {
      wire::ManState man;
      man.rod = static_cast<std::uint8_t>(r);
      man.man = static_cast<std::uint8_t>(m);
      const auto y = static_cast<float>(foosball::man_offset(table.rods[r], m)) + rod.slide;
      man.body.position = {static_cast<float>(table.rods[r].x), y,
                           static_cast<float>(table.rod_height)};
      man.body.orientation = {0, std::sin(0.5f * rod.angle), 0, std::cos(0.5f * rod.angle)};
      man.body.linear_velocity = {0, rod.slide_rate, 0};
      man.body.angular_velocity = {0, rod.angle_rate, 0};
      state.men.push_back(man);
    }
  }
}

wire::Snapshot scripted_play(double seconds, foosball::Layout layout) {
  const foosball::TableSpec& table = foosball::table_spec(layout);
  wire::Snapshot state;
  state.session = kScriptedSession;
  state.tick = static_cast<std::uint64_t>(std::llround(seconds / foosball::kTick));
  state.sequence = state.tick + 1;
  state.layout = static_cast<std::uint8_t>(layout);
  state.screen = 2;
  state.ball_in_play = true;
  state.score = {3, 2};
  state.character = {0, 2};
  state.play_seconds = static_cast<float>(seconds) + 97.0f;
  state.screen_seconds = static_cast<float>(seconds);
  const auto radius = static_cast<float>(table.ball_radius);
  const auto t = static_cast<float>(seconds);
  const float x = 0.52f * std::sin(1.9f * t + 0.4f), y = 0.27f * std::sin(3.1f * t + 0.2f);
  const float hop = 0.09f * std::max(0.0f, std::sin(2.3f * t));
  state.ball.position = {x, y, radius + hop};
  state.ball.linear_velocity = {0.52f * 1.9f * std::cos(1.9f * t + 0.4f),
                                0.27f * 3.1f * std::cos(3.1f * t + 0.2f), 0};
  const float roll = 3.0f * t;
  state.ball.orientation = {0.6f * std::sin(roll), 0.8f * std::sin(roll), 0, std::cos(roll)};
  for (std::size_t r = 0; r < state.rods.size(); ++r) {
    const foosball::RodSpec& spec = table.rods[r];
    const float phase = 0.9f * static_cast<float>(r);
    wire::RodSnapshot& rod = state.rods[r];
    rod.slide = static_cast<float>(spec.slide_limit) * 0.7f * std::sin(1.3f * t + phase);
    rod.angle = (spec.team == 0 ? -1.0f : 1.0f) * 0.65f * std::sin(2.7f * t + 1.7f * phase);
    rod.status = 1;
    rod.source = spec.team == 0 ? 2 : 3;
  }
  place_men(state);
  return state;
}

wire::Devices scripted_devices(double seconds) {
  const auto frames = static_cast<std::uint64_t>(1000.0 * seconds);
  const auto report = [&](const char* name, wire::DeviceState state) {
    wire::DeviceReport device;
    device.name = name;
    device.state = number(state);
    return device;
  };
  wire::DeviceReport cabinet =
      report("cabinet at hid:/dev/space-foosball", wire::DeviceState::live);
  cabinet.frames = cabinet.stamped = frames;
  cabinet.latency_sum_us = 430 * frames;
  cabinet.latency_max_us = 1870;
  cabinet.lost = 3;
  cabinet.line_errors = 12;
  for (std::size_t i = 0; i < cabinet.rods.size(); ++i) {
    const double phase = 0.8 * static_cast<double>(i), t = seconds;
    wire::DeviceRod& rod = cabinet.rods[i];
    rod.status = number(i == 6 ? wire::RodStatus::held : wire::RodStatus::live);
    rod.slide = static_cast<float>(i == 6 ? 0.02 : 0.1 * std::sin(1.3 * t + phase));
    rod.angle = static_cast<float>(i == 6 ? 1.0 : 4.0 * std::sin(2.1 * t + 2.0 * phase));
    rod.slide_counts = std::llround(39.37e3 * static_cast<double>(rod.slide));
    rod.spin_counts = std::llround(315.0 * static_cast<double>(rod.angle));
  }
  wire::DeviceReport mouse = report("mouse at evdev:/dev/input/event5", wire::DeviceState::live);
  mouse.rods[3].status = number(wire::RodStatus::live);
  return {std::llround(1e6 * seconds),
          {cabinet, report("cabinet at serial:/dev/ttyACM0", wire::DeviceState::missing), mouse}};
}

}  // namespace client
