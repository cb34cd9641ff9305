#include "app/effects.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/vec2.hpp>

#include "foosball/table.h"
#include "render/palette.h"
#include "wire/enums.h"

namespace client {
namespace {

using Kind = wire::EventKind;

constexpr float kBright = 0.55f;   // strength from which a hit sounds like a shot
constexpr float kCalmingS = 4.0f;  // decay of the crowd's excitement to 1 / e [s]
constexpr float kShakeS = 0.18f;   // to 1 / e [s]
constexpr float kCrowdAtRest = 0.06f;

std::size_t side(int team) {
  return team == 1 ? 1 : 0;
}

glm::vec3 vec(const std::array<float, 3>& a) {
  return {a[0], a[1], a[2]};
}

// A team's crowd stands behind its own goal.
glm::vec3 crowd_of(int team) {
  return {team == 1 ? 0.9f : -0.9f, 0.0f, 0.4f};
}

// A higher voice raises the pitch of kicks, but less than its own: plastic still sounds like
// plastic.
float kick_pitch(const foosball::CharacterVoice& voice) {
  return std::clamp(std::sqrt(static_cast<float>(voice.pitch) / 240.0f), 0.6f, 1.8f);
}

}  // namespace

float strength_of_impulse(float impulse) {
  if (!(impulse > kSoftestImpulse)) return 0.0f;
  return std::min(std::log(impulse / kSoftestImpulse) / std::log(kHardestImpulse / kSoftestImpulse),
                  1.0f);
}

const foosball::CharacterVoice& Effects::voice_of(const wire::Snapshot& scene, int team) const {
  return foosball::nearest(characters_, scene.character[side(team)]).voice;
}

// Flute and reed at once, weighted by the timbre.
void Effects::shout(const foosball::CharacterVoice& voice, float volume, const glm::vec3& at,
                    SoundPlayer& sounds) const {
  const float pitch = static_cast<float>(voice.pitch) / kVoicePitch;
  const auto reed = static_cast<float>(voice.timbre);
  if (reed < 1.0f) sounds.play(Sound::flute, volume * std::sqrt(1.0f - reed), at, pitch);
  if (reed > 0.0f) sounds.play(Sound::reed, volume * std::sqrt(reed), at, pitch);
}

void Effects::hit(const wire::EventSnapshot& event, const wire::Snapshot& scene,
                  Particles& particles, SoundPlayer* sounds) {
  if (event.value < kSoftestImpulse) return;  // rolling contact, no hit
  const glm::vec3 at = vec(event.point);
  const float strength = strength_of_impulse(event.value), volume = volume_of_impulse(event.value);
  // The sparks fly in the direction of the ball.
  const glm::vec3 velocity = vec(scene.ball.linear_velocity);
  const float speed = glm::length(velocity);
  const glm::vec3 towards = speed > 0.5f ? 0.6f * velocity / speed : glm::vec3(0);
  // Sparks grow faster than loudness, with the square, so that light touches stay small.
  const float sparks = strength * strength;
  const auto sound = [&](Sound which, float pitch = 1.0f) {
    if (sounds != nullptr) sounds->play(which, volume, at, pitch);
  };
  switch (static_cast<Kind>(event.kind)) {
    case Kind::man_hit: {
      particles.spark(Material::man, at, towards, kTeamColour[side(event.team)], sparks);
      const foosball::CharacterVoice& voice = voice_of(scene, event.team);
      sound(strength > kBright ? Sound::shot : Sound::kick, kick_pitch(voice));
      if (strength > 0.85f) {
        shake_ = std::max(shake_, 0.35f * strength);
        if (sounds != nullptr) shout(voice, 0.35f * strength, at, *sounds);
      }
      break;
    }
    case Kind::wall_hit:
      if (strength > 0.2f) particles.spark(Material::wall, at, towards, glm::vec3(0), sparks);
      sound(Sound::wall);
      break;
    case Kind::field_hit:
      if (strength > 0.15f) particles.spark(Material::field, at, towards, glm::vec3(0), sparks);
      sound(Sound::field);
      break;
    default:
      break;
  }
}

void Effects::react(const MatchStory& story, const wire::Snapshot& scene, Particles& particles,
                    SoundPlayer* sounds) {
  for (const StoryMoment& moment : story.moments()) {
    const bool goal = moment.moment == Moment::goal || moment.moment == Moment::own_goal;
    excitement_ = std::min(excitement_ + (goal ? 1.0f : 0.35f * moment.strength), 1.0f);
    if (goal) {
      const glm::vec3 at = vec(scene.ball.position);
      particles.celebrate({at.x, at.y, 0.06f}, kTeamColour[side(moment.team)], moment.strength);
      shake_ = 1.0f;
    }
    if (sounds == nullptr) continue;
    const glm::vec3 crowd = crowd_of(moment.team);
    const foosball::CharacterVoice& voice = voice_of(scene, moment.team);
    switch (moment.moment) {
      case Moment::shot:
        sounds->play(Sound::gasp, 0.10f + 0.25f * moment.strength, crowd);
        break;
      case Moment::save:
        sounds->play(Sound::cheer, 0.15f + 0.25f * moment.strength, crowd, 1.15f);
        shout(voice, 0.4f, vec(scene.ball.position), *sounds);
        break;
      case Moment::goal:
        sounds->play(Sound::goal, 0.8f, vec(scene.ball.position));
        sounds->play(Sound::cheer, 0.9f, crowd, moment.team == 0 ? 1.0f : 1.08f);
        shout(voice, 0.7f, crowd, *sounds);
        break;
      case Moment::own_goal:
        sounds->play(Sound::groan, 0.9f, crowd_of(1 - moment.team));
        sounds->play(Sound::cheer, 0.4f, crowd);
        break;
    }
  }
}

void Effects::follow_ball(const wire::Snapshot& scene, const MatchStory& story,
                          Particles& particles, SoundPlayer* sounds, float dt) {
  const auto& table = foosball::table_spec(static_cast<foosball::Layout>(scene.layout));
  const auto radius = static_cast<float>(table.ball_radius);
  const glm::vec3 at = vec(scene.ball.position), velocity = vec(scene.ball.linear_velocity);
  const bool moves = scene.ball_in_play && dt > 0.0f;
  if (moves) {
    const int team = story.last_touch_team();
    const glm::vec3 colour = team < 0 ? glm::vec3(0.35f, 0.42f, 0.45f) : kTeamColour[side(team)];
    particles.streak(at, velocity, radius, colour, dt);
    particles.dust(at, velocity, radius, dt);
  }
  if (sounds == nullptr) return;
  const bool on_field = moves && at.z < 1.3f * radius;
  const auto [volume, pitch] = rolling_sound(on_field ? glm::length(glm::vec2(velocity)) : 0.0f);
  sounds->set_loop(Sound::roll, volume, at, pitch);
}

// The fastest rod is audible in its bearings.
void Effects::follow_rods(const wire::Snapshot& scene, SoundPlayer* sounds) const {
  if (sounds == nullptr) return;
  const auto& table = foosball::table_spec(static_cast<foosball::Layout>(scene.layout));
  std::size_t fastest = 0;
  for (std::size_t i = 1; i < scene.rods.size(); ++i) {
    if (std::abs(scene.rods[i].slide_rate) > std::abs(scene.rods[fastest].slide_rate)) fastest = i;
  }
  const float speed = scene.paused ? 0.0f : std::abs(scene.rods[fastest].slide_rate);
  const float share = std::clamp((speed - 0.08f) / 2.5f, 0.0f, 1.0f);
  sounds->set_loop(Sound::slide, 0.22f * std::sqrt(share),
                   {static_cast<float>(table.rods[fastest].x), 0.0f, 0.1f}, 0.75f + 0.6f * share);
}

void Effects::show(std::span<const wire::EventSnapshot> events, const wire::Snapshot& scene,
                   const MatchStory& story, Particles& particles, SoundPlayer* sounds, float dt) {
  for (const wire::EventSnapshot& event : events) {
    hit(event, scene, particles, sounds);
    if (sounds == nullptr) continue;
    const glm::vec3 at = vec(event.point);
    if (static_cast<Kind>(event.kind) == Kind::serve) sounds->play(Sound::serve, 0.35f, at);
    const auto kind = static_cast<Kind>(event.kind);
    if (kind == Kind::match_won || kind == Kind::set_won) sounds->play(Sound::whistle, 0.6f, at);
  }
  react(story, scene, particles, sounds);
  follow_ball(scene, story, particles, sounds, dt);
  follow_rods(scene, sounds);
  excitement_ *= std::exp(-dt / kCalmingS);
  shake_ *= std::exp(-dt / kShakeS);
  if (shake_ < 0.01f) shake_ = 0.0f;
  if (sounds == nullptr) return;
  const bool watched = scene.screen == number(wire::Screen::play) ||
                       scene.screen == number(wire::Screen::ceremony) ||
                       scene.screen == number(wire::Screen::end);
  sounds->set_loop(Sound::crowd, watched ? kCrowdAtRest + 0.45f * excitement_ : 0.0f,
                   {0.0f, 0.0f, 0.6f}, 0.95f + 0.15f * excitement_);
}

}  // namespace client
