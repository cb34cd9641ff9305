// For work on the renderer: draws scripted moments without a server and writes them as PNG.
//   client_preview DIRECTORY [low|high] [WxH] [en|de|ko] [NAME] [TEXT_SCALE]
// NAME: only the moments whose name begins with it; all if it is empty.
#include <GLES3/gl3.h>

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <ctime>
#include <string>
#include <string_view>

#include "app/window.h"
#include "client/menu.h"
#include "draw/image.h"
#include "render/hud.h"
#include "render/scene.h"
#include "render/translate.h"
#include "scripted_scene.h"

namespace client {
namespace {

struct Shot {
  const char* name;
  double seconds;
  std::uint8_t screen;
  int team;
  View view = View::seat;
};
constexpr Shot kShots[] = {{"logo", 0.4, 0, 0},
                           {"selection", 1.0, 1, 0},
                           {"crews-1", 1.0, 1, 0},
                           {"crews-2", 1.0, 1, 1},
                           {"crews-3", 1.0, 1, 0},
                           {"play-1", 0.35, 2, 0},
                           {"play-2", 1.62, 2, 1},
                           {"play-3", 2.4, 2, 0},
                           {"ceremony", 0.7, 3, 0},
                           {"end", 1.0, 4, 0},
                           {"lost", 3.0, 2, 0},
                           {"held", 4.1, 2, 0},
                           {"pause", 3.3, 2, 0},
                           {"help", 4.6, 2, 1},
                           {"settings", 4.6, 2, 0},
                           {"names", 4.6, 2, 0},
                           {"training", 2.4, 2, 0},
                           {"paper", 1.62, 2, 0},
                           {"mouse-free", 0.35, 2, 0},
                           {"selection-mouse-free", 1.0, 1, 0},
                           {"above-mouse-free", 1.62, 2, 0, View::above},
                           {"above-pause", 3.3, 2, 0, View::above},
                           {"above-logo", 0.4, 0, 0, View::above},
                           {"above-selection", 1.0, 1, 0, View::above},
                           {"above-play", 1.62, 2, 0, View::above},
                           {"above-ceremony", 0.9, 3, 1, View::above},
                           {"above-end", 1.0, 4, 0, View::above},
                           {"above-settings", 4.6, 2, 0, View::above},
                           {"above-hidden-rods", 2.4, 2, 0, View::above},
                           {"follow", 2.4, 2, 0, View::follow},
                           {"spectator", 0.35, 2, -1, View::spectator},
                           {"distinct", 2.4, 2, 0},
                           {"distinct-2", 1.62, 2, 1},
                           {"distinct-above", 1.62, 2, 0, View::above},
                           {"distinct-follow", 0.9, 2, 1, View::follow},
                           {"seats", 4.6, 2, 0},
                           {"above-seats", 4.6, 2, 0, View::above},
                           {"tuning", 4.6, 2, 0},
                           {"tuning-read-only", 4.6, 2, 0},
                           {"game", 4.6, 2, 0},
                           {"game-challenge", 0.4, 0, 0},
                           {"game-ladder", 0.4, 0, 0, View::above},
                           {"game-read-only", 4.6, 2, 0},
                           {"controllers", 4.6, 2, 0},
                           {"two-a-side", 2.4, 2, 0},
                           {"goalie-in-hand", 0.9, 2, 0},
                           {"attack-in-hand", 1.62, 2, 0},
                           {"above-goalie-in-hand", 0.9, 2, 0, View::above},
                           {"follow-goalie-in-hand", 0.9, 2, 1, View::follow},
                           {"drawn", 1.0, 4, 0},
                           {"fame", 0.4, 0, 0},
                           {"watching-fame", 0.4, 0, -1},
                           {"above-fame", 8.4, 0, 0, View::above},
                           {"survey-consent", 1.0, 4, 0},
                           {"survey-statement", 0.4, 0, 0},
                           {"survey-four", 0.4, 0, 0},
                           {"survey-thanks", 0.4, 0, 1},
                           {"above-survey", 0.4, 0, 0, View::above},
                           {"above-survey-end", 1.0, 4, 0, View::above},
                           {"rules-possession", 0.35, 2, 0},
                           {"rules-possession-itsf", 1.62, 2, 1},
                           {"rules-foul-and-serve", 2.4, 2, 0},
                           {"rules-golden-goal", 2.4, 2, 0},
                           {"rules-time", 0.7, 3, 0},
                           {"rules-set", 0.7, 3, 0},
                           {"rules-sets-end", 1.0, 4, 0},
                           {"rules-above-possession", 1.62, 2, 0, View::above},
                           {"rules-above-time", 0.9, 3, 0, View::above},
                           {"ladder-selection", 1.0, 1, 0},
                           {"ladder-play", 2.4, 2, 0},
                           {"ladder-above-play", 2.4, 2, 0, View::above},
                           {"ladder-end", 1.0, 4, 0},
                           {"ladder-top-end", 1.0, 4, 0},
                           {"challenge-play", 2.4, 2, 0},
                           {"training-play", 2.4, 2, 0}};

// Sets the state of the rules at this moment.
void decide(const std::string& shot, wire::Snapshot& state, HudState& hud) {
  const auto has = [&shot](const char* word) { return shot.find(word) != std::string::npos; };
  if (shot.starts_with("rules")) state.sets = {1, 0};
  if (has("possession")) {
    state.rule_set = number(has("itsf") ? wire::RuleSet::itsf : wire::RuleSet::arcade);
    state.possession_team = 1;
    state.possession_seconds = has("itsf") ? 2.0f : 7.2f;
    const auto& table = foosball::table_spec(foosball::Layout::tournament);
    state.ball.position[0] = static_cast<float>(table.rods[4].x) - 0.02f;
  }
  if (has("foul-and-serve")) {
    state.fouled = true;
    state.last_foul = number(wire::Foul::possession);
    state.next_server = 1;
    state.ball_in_play = false;
  }
  if (has("golden")) {
    state.timed = state.golden_goal = true;
    state.score = {2, 2};
  }
  if (has("time")) {
    state.ball_visible = false;
    state.sets = {2, 0};
  }
  hud.set_over = has("rules-set") || has("time");
  if (has("sets-end")) {
    state.sets = {3, 1};
    state.score = {5, 3};
    hud.sets = {{5, 4}, {2, 5}, {5, 1}, {5, 3}};
  }
  if (shot.starts_with("ladder")) {
    state.mode = number(wire::Mode::ladder);
    state.rung = has("top") ? 4 : 2;
    state.computer = {false, true};
    state.sets = {static_cast<std::uint8_t>(state.screen == 4 ? 1 : 0), 0};
  }
  if (shot.starts_with("challenge")) {
    state.mode = number(wire::Mode::challenge);
    state.timed = true;
    state.seconds_left = 71.4f;
  }
  if (shot.starts_with("training")) {
    state.mode = number(wire::Mode::training);
    state.last_shot = {0, 5, 1, 7.4f, 0.21f};
  }
}

// A controller whose rods move, an absent one, and a mouse.
MenuPage controllers_page() {
  Menu menu("/nowhere");
  menu.toggle(Menu::Page::controllers);
  menu.devices().follow(1, true);
  for (int i = 0; i < 240; ++i) menu.devices().update(scripted_devices(0.05 * i));
  static Settings settings;
  static const SeatsView nobody;
  return menu.page({settings, nobody, nullptr});
}

// As seen by a person who shares the table with others.
MenuPage menu_page(Menu::Page page, int row, bool host = true,
                   std::uint8_t game_mode = number(wire::Mode::match)) {
  static SeatsView seats;
  seats.client = 1;
  seats.role = number(host ? wire::Role::host : wire::Role::player);
  seats.scene = scripted_play(0.0);
  seats.scene.screen = number(wire::Screen::play);
  seats.scene.time_outs_left = {2, 1};
  seats.roster.seats = {{1, "me", 0, 0b00101011, 2, false},
                        {2, "Annemarie", 1, 0b11000000, 1, true},
                        {3, "지훈", 1, 0b00010000, 1, false},
                        {4, "an onlooker", wire::kWatchOnly, 0, 0, false}};
  seats.notices = {{wire::Notice::Level::info, wire::vote_topic(wire::RequestKind::restart, 0),
                    "Annemarie asks for a restart: 1 of 2 votes. Ask for it too to agree"}};
  static Crew crew(1, 0, foosball::Layout::tournament, 0b00101011);
  crew.give(0, static_cast<int>(Device::pad_1));
  static Settings settings;
  Menu menu("/nowhere");
  foosball::Tuning tuning;
  tuning.hop_gain = 3.2;
  menu.tuning().update(1, tuning, host);
  wire::Game game;
  game.mode = game_mode;
  game.goals = 5;
  game.sets = 1;
  game.level = game_mode == number(wire::Mode::ladder) ? 0 : 4;
  game.style = game_mode == number(wire::Mode::challenge) ? 4 : 0;
  game.waits = game_mode == number(wire::Mode::match) && host;
  menu.game().update(1, game, host, "");
  const Menu::Context context{settings, seats, &crew};
  menu.toggle(page);
  menu.step({.down = row - 1}, 0, context);
  return menu.page(context);
}

std::vector<SurveyPanel> survey_panels(const std::string& shot) {
  using Kind = SurveyPanel::Kind;
  const SurveyPanel consent{.text = "Six short questions about this match?"};
  SurveyPanel statement{.kind = Kind::statement,
                        .team = 1,
                        .text = "I could always see where the ball was, and how high.",
                        .question = 4,
                        .chosen = 2};
  if (shot == "survey-consent") return {consent};
  if (shot == "survey-statement") return {statement};
  if (shot == "survey-thanks") return {{.kind = Kind::thanks, .team = 1, .text = "Thank you!"}};
  SurveyPanel other = consent;
  if (shot.starts_with("above")) {
    statement.cabinet = other.cabinet = true;
    statement.standing = 0.6f;
    return {other, statement};
  }
  if (shot != "survey-four") return {};
  other.name = statement.name = "gamepad";
  other.number = 1;
  statement.number = 2;
  return {other, statement, statement, other};
}

Camera camera_of(const Shot& shot, const wire::Snapshot& state, const glm::ivec2& size) {
  CameraView view{.team = std::max(shot.team, 0), .closeness = shot.screen == 1 ? 0.62f : 0.0f};
  const auto& ball = state.ball.position;
  switch (shot.view) {
    case View::above:
      return above_camera(foosball::table_spec(foosball::Layout::tournament), view.team, size);
    case View::follow:
      return follow_camera(view, {ball[0], ball[1], ball[2]}, size);
    case View::spectator:
      return spectator_camera(view, size);
    case View::seat:
      break;
  }
  return player_camera(view, size);
}

int run(const std::string& directory, draw::Quality quality, const glm::ivec2& size,
        const std::string& language, const std::string& only, float text_scale) {
  auto window = Window::open({.size = size, .title = "preview"});
  if (!window) {
    std::fprintf(stderr, "%s\n", window.error().sentence.c_str());
    return 4;
  }
  const auto cpu = [] { return static_cast<double>(std::clock()) / CLOCKS_PER_SEC; };
  const double begin = cpu();
  auto scene = Scene::create(quality);
  glFinish();
  const double scene_done = cpu();
  use_language(language, PREVIEW_CATALOGUES);
  auto font = Font::load({}, catalogue_file(), "지훈");
  const double font_done = cpu();
  auto ui = font ? UiBatch::create(std::move(*font)) : tl::unexpected(font.error());
  if (!scene || !ui) {
    std::fprintf(stderr, "%s%s\n", scene ? "" : scene.error().c_str(),
                 ui ? "" : ui.error().c_str());
    return 1;
  }
  ui->set_pictures((*scene)->portraits(), (*scene)->portrait_cells());
  glFinish();
  std::printf("set up: scene %.0f ms, font %.0f ms of CPU time\n", 1e3 * (scene_done - begin),
              1e3 * (font_done - scene_done));
  for (const Shot& shot : kShots) {
    if (!std::string_view(shot.name).starts_with(only)) continue;
    const bool paper = std::string_view(shot.name).starts_with("paper");
    wire::Snapshot state =
        scripted_play(shot.seconds, paper ? foosball::Layout::paper : foosball::Layout::tournament);
    state.screen = shot.screen;
    state.ball_in_play = shot.screen == 2;
    state.confirmed = {true, false};
    if (std::string_view(shot.name).starts_with("crews-")) {  // two of the six each
      const auto pair = static_cast<std::uint8_t>(shot.name[6] - '1');
      state.character = {static_cast<std::uint8_t>(2 * pair),
                         static_cast<std::uint8_t>(2 * pair + 1)};
    }
    if (std::strcmp(shot.name, "play-3") == 0) {
      state.rule_set = number(wire::RuleSet::itsf);
      state.sets = {1, 0};
      state.fouled = true;
      state.last_foul = number(wire::Foul::spin);
      state.last_foul_team = 1;
    }
    if (std::strcmp(shot.name, "held") == 0) state.rods[3].status = state.rods[5].status = 2;
    if (shot.screen >= 3) {
      state.ball_visible = true;
      state.ball.position = {0.66f, 0.03f, 0.0173f};
      state.ball.linear_velocity = {0, 0, 0};
    }
    const std::string name = shot.name;
    SceneView view;
    view.camera = camera_of(shot, state, size);
    if (shot.screen == 2 && shot.team >= 0) view.active_rods = shot.team == 0 ? 1u << 3 : 1u << 4;
    if (name.ends_with("goalie-in-hand")) view.active_rods = shot.team == 0 ? 1u : 1u << 7;
    if (name == "attack-in-hand") view.active_rods = 1u << 5;
    view.time = 1.0f;
    if (name == "above-hidden-rods") view.rods = RodsShown::off;
    view.distinct_teams = name.starts_with("distinct");
    HudState hud;
    hud.state = &state;
    hud.text_scale = text_scale;
    hud.mouse_free = hud.starving = name.ends_with("mouse-free");
    hud.camera = view.camera;
    hud.viewer_team = shot.team;
    hud.active_rods = view.active_rods;
    hud.view = shot.view;
    hud.rods = view.rods;
    hud.goal = {.team = 0, .scorer_rod = 5, .scorer_man = 1, .own_goal = false, .speed = 7.4f};
    if (name == "above-ceremony")
      hud.goal = {.team = 0, .scorer_rod = 6, .scorer_man = 0, .own_goal = true, .speed = 2.1f};
    hud.since_foul = 1.0f;
    decide(name, state, hud);
    hud.replay = name == "ceremony";
    hud.statistics = {TeamStatistics{14, 6, 0, 9.3f, 71.0f}, TeamStatistics{9, 11, 1, 7.8f, 54.0f}};
    if (name.ends_with("settings")) {
      hud.menu = menu_page(Menu::Page::settings, 5);
    }
    if (name.find("survey") != std::string::npos) hud.survey = survey_panels(name);
    static const wire::Report report{4,
                                     {{{14, 9, 6, 23, 0, 71.0f, 1561.0f, 14.0f, 9.3f},
                                       {9, 4, 11, 17, 1, 54.0f, 1533.0f, -14.0f, 7.8f}}},
                                     {{"Annemarie", 1604.0f, 31, 22, 14.2f, 240, 151},
                                      {"지훈", 1561.0f, 18, 11, 9.3f, 120, 60},
                                      {"computer 4:gambler", 1533.0f, 12, 6, 12.1f, 70, 41},
                                      {"player", 1488.0f, 9, 4},
                                      {"computer 2", 1420.0f, 40, 11}}};
    if (name.ends_with("end") || name == "survey-consent") hud.report = &report;
    if (name.ends_with("fame")) hud.fame = report.fame;
    if (name == "drawn") state.score = {2, 2};
    if (name == "names") hud.menu = menu_page(Menu::Page::settings, 14);
    if (name == "training") {
      state.mode = number(wire::Mode::training);
      state.feed_rod = 3;
      state.feed_man = 4;
      state.last_shot = {0, 3, 1, 8.6f, -0.31f};
    }
    if (name == "seats" || name == "above-seats") hud.menu = menu_page(Menu::Page::seats, 4);
    if (name == "tuning") hud.menu = menu_page(Menu::Page::tuning, 12);
    if (name == "tuning-read-only") hud.menu = menu_page(Menu::Page::tuning, 1, false);
    if (name == "game") hud.menu = menu_page(Menu::Page::game, 3);
    if (name == "game-challenge")
      hud.menu = menu_page(Menu::Page::game, 1, true, number(wire::Mode::challenge));
    if (name == "game-ladder")
      hud.menu = menu_page(Menu::Page::game, 1, true, number(wire::Mode::ladder));
    if (name == "controllers") hud.menu = controllers_page();
    if (name == "game-read-only") hud.menu = menu_page(Menu::Page::game, 1, false);
    if (name == "two-a-side") {
      view.active_rods = hud.active_rods = 0b00011010;
      hud.rod_names = {"gamepad 1", "gamepad 1", "gamepad 2",     "mouse",
                       "gamepad 2", "mouse",     "Annemarie ...", "Annemarie ..."};
    }
    if (std::strcmp(shot.name, "lost") == 0) {
      hud.connection_message =
          std::string(tr("Physics server lost: waiting at")) + " 127.0.0.1:4750";
      hud.connection_detail = "The scene stands as it was last heard.";
    }
    state.paused = name.ends_with("pause");
    hud.show_help = std::strcmp(shot.name, "help") == 0;
    if (std::strcmp(shot.name, "held") == 0) hud.notices = {"cabinet unplugged: rods 4, 6 hold"};
    Particles particles;
    if (shot.screen == 2) {
      const auto& b = state.ball;
      const auto radius =
          static_cast<float>(foosball::table_spec(foosball::Layout::tournament).ball_radius);
      for (int i = 0; i < 4; ++i) {
        particles.streak({b.position[0], b.position[1], b.position[2]}, {6, 3, 0}, radius,
                         {0.86f, 0.23f, 0.025f}, 0.016f);
        particles.step(0.016f);
      }
      particles.spark(Material::man, {b.position[0], b.position[1], b.position[2]}, {1, 0, 0},
                      {0.86f, 0.23f, 0.025f}, 0.7f);
      particles.step(0.05f);
    }
    if (shot.screen == 3) {
      particles.celebrate({-0.6f, 0, 0.06f}, {0.9f, 0.4f, 0.1f}, 1.0f);
      for (int i = 0; i < 30; ++i) particles.step(0.016f);
    }
    // CPU time of all threads: the cost of software OpenGL, independent of the machine's load.
    double best = 1e9;
    for (int i = 0; i < 4; ++i) {
      const double start = cpu();
      (*scene)->draw(state, view, particles, size);
      draw_hud(*ui, hud, size);
      glFinish();
      best = std::min(best, cpu() - start);
    }
    const auto wrote =
        draw::write_png(draw::read_pixels(size), directory + "/" + shot.name + ".png");
    std::printf("%s: %.1f ms of CPU time%s\n", shot.name, 1e3 * best,
                wrote ? "" : wrote.error().c_str());
    window->swap();
  }
  return 0;
}

}  // namespace
}  // namespace client

int main(int argc, char** argv) {
  const draw::Quality quality =
      argc > 2 && std::strcmp(argv[2], "low") == 0 ? draw::Quality::low : draw::Quality::high;
  glm::ivec2 size{1280, 720};
  if (argc > 3) std::sscanf(argv[3], "%dx%d", &size.x, &size.y);
  return client::run(argc > 1 ? argv[1] : ".", quality, size, argc > 4 ? argv[4] : "en",
                     argc > 5 ? argv[5] : "",
                     argc > 6 ? static_cast<float>(std::atof(argv[6])) : 1.0f);
}
