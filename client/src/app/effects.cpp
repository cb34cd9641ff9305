#include "app/effects.h"

#include <algorithm>

#include "render/palette.h"
#include "wire/enums.h"

namespace client {
namespace {

using Kind = wire::EventKind;

constexpr float kAudible = 0.004f;  // [N s]: less is rolling, not hitting
constexpr float kStrong = 0.20f;    // [N s]: a hard shot

const glm::vec3 kWoodDust{0.9f, 1.1f, 1.3f};

}  // namespace

void show_events(std::span<const wire::EventSnapshot> events, Particles& particles,
                 SoundPlayer* sounds) {
  for (const wire::EventSnapshot& event : events) {
    const glm::vec3 at{event.point[0], event.point[1], event.point[2]};
    const glm::vec3 team = kTeamColour[event.team == 1 ? 1 : 0];
    const float strength = std::clamp(event.value / kStrong, 0.0f, 1.0f);
    const auto play = [&](Sound sound, float volume) {
      if (sounds != nullptr) sounds->play(sound, volume, at);
    };
    switch (static_cast<Kind>(event.kind)) {
      case Kind::man_hit:
        if (event.value < kAudible) break;
        particles.spark(at, glm::vec3(0), 1.2f * team + glm::vec3(1.1f, 0.95f, 0.75f), strength);
        play(Sound::kick, volume_of_impulse(event.value));
        break;
      case Kind::wall_hit:
        if (event.value < kAudible) break;
        if (strength > 0.1f) particles.spark(at, glm::vec3(0), kWoodDust, 0.5f * strength);
        play(Sound::wall, volume_of_impulse(event.value));
        break;
      case Kind::field_hit:
        if (event.value > kAudible) play(Sound::field, 0.6f * volume_of_impulse(event.value));
        break;
      case Kind::goal:
        particles.celebrate(at, team);
        play(Sound::goal, 0.9f);
        break;
      case Kind::serve:
        play(Sound::serve, 0.5f);
        break;
      case Kind::match_won:
        play(Sound::whistle, 0.6f);
        break;
      case Kind::dead_ball:
      case Kind::ball_out:
      case Kind::screen:
        break;
    }
  }
}

}  // namespace client
