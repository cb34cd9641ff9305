// The picture of a match at given moments of the match's time: what the game's window would show,
// drawn frame by frame without a clock.
#pragma once

#include <memory>
#include <span>
#include <string>
#include <tl/expected.hpp>

#include "app/effects.h"
#include "app/view_motion.h"
#include "core/match_story.h"
#include "draw/image.h"
#include "draw/window.h"
#include "render/hud.h"
#include "render/scene.h"

namespace video {

// The presentation of a match beside its bodies: camera, sparks, sounds.
class Staging {
 public:
  Staging(int team, const foosball::Characters& characters, client::View view = client::View::seat)
      : team_(team), view_(view), characters_(characters) {
    effects_.set_characters(characters_);
  }

  // Advances by dt [s] to this state; events: those in between. sounds: null for none.
  void advance(const wire::Snapshot& state, std::span<const wire::EventSnapshot> events, float dt,
               client::SoundPlayer* sounds);
  client::Camera camera(const glm::ivec2& size) const { return camera(view_, size); }
  client::Camera camera(client::View view, const glm::ivec2& size) const {
    return motion_.camera(view, size);
  }
  // Jumps to another moment; story: what a person has seen of the match by then.
  void jump(const client::MatchStory& story);
  client::Particles& particles() { return particles_; }
  const client::MatchStory& story() const { return story_; }

 private:
  int team_;
  client::View view_;
  foosball::Characters characters_;
  client::MatchStory story_;
  client::Effects effects_;
  client::Particles particles_;
  client::ViewMotion motion_;
};

struct FilmOptions {
  glm::ivec2 size{1280, 720};
  draw::Quality quality = draw::Quality::high;
};

class Film {
 public:
  // Opens an invisible window. The error is a sentence.
  static tl::expected<std::unique_ptr<Film>, draw::WindowError> open(
      const FilmOptions& options, const foosball::Characters& characters);

  // time [s] since the film began.
  draw::Image frame(const wire::Snapshot& state, Staging& staging, float time);

 private:
  Film(const FilmOptions& options, draw::Window window, std::unique_ptr<client::Scene> scene,
       client::UiBatch ui, const foosball::Characters& characters);

  FilmOptions options_;
  foosball::Characters characters_;
  draw::Window window_;  // first: destroyed after what is drawn with it
  std::unique_ptr<client::Scene> scene_;
  client::UiBatch ui_;
};

}  // namespace video
