#include "film.h"

#include <utility>

namespace video {

tl::expected<std::unique_ptr<Film>, draw::WindowError> Film::open(
    const FilmOptions& options, const foosball::Characters& characters) {
  const auto failed = [](std::string sentence) {
    return tl::unexpected(draw::WindowError{std::move(sentence)});
  };
  auto window = draw::Window::open({.size = options.size,
                                    .title = "Space Foosball, a video",
                                    .otherwise = "use ./play --replay FILE --video FILE",
                                    .visible = false});
  if (!window) return tl::unexpected(window.error());
  if (window->size() != options.size)
    return failed("This display has no room for pictures of that size: choose a smaller --size.");
  auto scene = client::Scene::create(options.quality);
  if (!scene) return failed(scene.error());
  auto font = client::Font::load();
  if (!font) return failed(font.error());
  auto ui = client::UiBatch::create(std::move(*font));
  if (!ui) return failed(ui.error());
  return std::unique_ptr<Film>(
      new Film(options, std::move(*window), std::move(*scene), std::move(*ui), characters));
}

Film::Film(const FilmOptions& options, draw::Window window, std::unique_ptr<client::Scene> scene,
           client::UiBatch ui, const foosball::Characters& characters)
    : options_(options),
      characters_(characters),
      window_(std::move(window)),
      scene_(std::move(scene)),
      ui_(std::move(ui)) {
  scene_->set_characters(characters_);
  ui_.set_pictures(scene_->portraits(), scene_->portrait_cells());
}

void Staging::advance(const wire::Snapshot& state, std::span<const wire::EventSnapshot> events,
                      float dt, client::SoundPlayer* sounds) {
  story_.update(events, state, dt);
  effects_.show(events, state, story_, particles_, sounds, state.paused ? 0.0f : dt);
  if (!state.paused) particles_.step(dt);
  motion_.step(&state, team_, dt);
}

void Staging::jump(const client::MatchStory& story) {
  story_ = story;
  particles_ = {};
  effects_ = {};
  effects_.set_characters(characters_);
}

draw::Image Film::frame(const wire::Snapshot& state, Staging& staging, float time) {
  client::SceneView view;
  view.time = time;
  view.camera = staging.camera(options_.size);
  scene_->draw(state, view, staging.particles(), options_.size);
  client::HudState hud;
  hud.state = &state;
  hud.characters = &characters_;
  hud.camera = view.camera;
  client::set_story(hud, staging.story());
  client::draw_hud(ui_, hud, options_.size);
  return draw::read_pixels(options_.size);
}

}  // namespace video
