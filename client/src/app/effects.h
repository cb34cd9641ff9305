// Effects of a match: sparks, streaks, dust; sounds of hits, rolling, the crowd and the men's
// shouts.
#pragma once

#include <span>

#include "core/match_story.h"
#include "foosball/character.h"
#include "render/particles.h"
#include "sound/player.h"
#include "wire/snapshot.h"

namespace client {

// Visual strength of a hit, 0..1, from its impulse [N s]: logarithmic over the range of play, as
// volume_of_impulse() is for the sound.
float strength_of_impulse(float impulse);

class Effects {
 public:
  // sounds: null if there is no sound. dt [s]; 0 while the match is stopped.
  void show(std::span<const wire::EventSnapshot> events, const wire::Snapshot& scene,
            const MatchStory& story, Particles& particles, SoundPlayer* sounds, float dt);
  // Sets the match's characters; the built-in ones until this is called.
  void set_characters(const foosball::Characters& characters) { characters_ = characters; }
  // Camera shake that is left from a goal or a hard hit, 0..1.
  float shake() const { return shake_; }

 private:
  void hit(const wire::EventSnapshot& event, const wire::Snapshot& scene, Particles& particles,
           SoundPlayer* sounds);
  void react(const MatchStory& story, const wire::Snapshot& scene, Particles& particles,
             SoundPlayer* sounds);
  void follow_ball(const wire::Snapshot& scene, const MatchStory& story, Particles& particles,
                   SoundPlayer* sounds, float dt);
  void follow_rods(const wire::Snapshot& scene, SoundPlayer* sounds) const;

  const foosball::CharacterVoice& voice_of(const wire::Snapshot& scene, int team) const;
  void shout(const foosball::CharacterVoice& voice, float volume, const glm::vec3& at,
             SoundPlayer& sounds) const;

  foosball::Characters characters_ = foosball::built_in_characters();
  float excitement_ = 0.0f;  // of the crowd, 0..1
  float shake_ = 0.0f;
};

}  // namespace client
