#include "app/app_impl.h"

#include <algorithm>
#include <csignal>
#include <cstdio>
#include <fstream>
#include <glm/geometric.hpp>

namespace client {
namespace {

volatile std::sig_atomic_t asked_to_leave = 0;

constexpr double kHiddenFrame = 0.02;  // [s] between two polls while recordings are watched
constexpr std::int64_t kProblemsShownUs = 12'000'000;  // for problems of the settings file

bool asks_for_menu(const InputEvents& events) {
  bool asks = events.pad_menu;
  for (const Action action : {Action::settings, Action::seats, Action::tuning, Action::recordings,
                              Action::game, Action::controllers})
    asks = asks || events.presses[index_of(action)] % 2 != 0;
  return asks;
}

}  // namespace

std::string App::start(int& exit_code) {
  exit_code = 4;
  auto window = Window::open({.size = options_.size,
                              .fullscreen = options_.fullscreen,
                              .title = "Space Foosball",
                              .otherwise = "play with ./play --headless"},
                             options_.cabinet_gamepads);
  if (!window) return window.error().sentence;
  window_ = std::move(*window);
  exit_code = 1;
  read_settings();
  if (const std::string error = use_texts(); !error.empty()) return error;
  const draw::Quality guess =
      window_->draws_in_software() ? draw::Quality::low : draw::Quality::high;
  log_info("drawing with " + window_->renderer());
  if (std::string error = use_quality(wanted_quality().value_or(guess)); !error.empty())
    return error;
  window_->set_keys(settings_.keys);
  if (!options_.mute) {
    if (auto sounds = SoundPlayer::open()) {
      sounds_ = std::move(*sounds);
      sounds_->set_volume(settings_.volume);
    } else {
      log_warning(sounds.error());
    }
  }
  awaiting_since_ = os::monotonic_us();
  connection_->join_as(name_of_person(settings_, 0));
  connection_->start();
  if (connection_->status().small_receive_buffer) {
    log_warning(
        "The system grants a smaller receive buffer than 4 MiB: a stall of the window may lose "
        "snapshots (raise net.core.rmem_max to 4194304).");
  }
  exit_code = 0;
  return {};
}

std::string App::use_quality(draw::Quality quality) {
  auto scene = Scene::create(quality);
  if (!scene) return scene.error();
  scene_ = std::move(*scene);
  if (characters_) scene_->set_characters(*characters_);
  ui_->set_pictures(scene_->portraits(), scene_->portrait_cells());
  log_info(std::string("quality ") + (quality == draw::Quality::high ? "high" : "low"));
  return {};
}

// The command line takes precedence over the settings; none: chosen by what the machine can draw.
std::optional<draw::Quality> App::wanted_quality() const {
  if (options_.quality) return options_.quality;
  switch (settings_.quality) {
    case QualityChoice::low:
      return draw::Quality::low;
    case QualityChoice::high:
      return draw::Quality::high;
    case QualityChoice::automatic:
      break;
  }
  return std::nullopt;
}

void App::follow_connection() {
  status_ = connection_->status();
  if (status_.link != link_seen_) {
    link_seen_ = status_.link;
    if (status_.link == Link::joined)
      log_info("joined the physics server at " + connection_->address());
    if (status_.link == Link::lost && !match_is_over())
      log_warning("physics server lost (" + status_.detail + "): waiting at " +
                  connection_->address());
    if (status_.link == Link::refused)
      log_warning("the physics server rejected this client: " + status_.detail);
  }
  if (status_.characters != characters_) use_characters();
  if (status_.joins == joins_seen_) return;
  joins_seen_ = status_.joins;
  if (awaiting_since_ == 0) awaiting_since_ = os::monotonic_us();
  surveyed_ = report_before_ = 0;
  // Joined again: the rods are where the server has them, so the crew starts afresh too.
  const wire::Welcome& welcome = status_.welcome;
  const auto layout = static_cast<foosball::Layout>(welcome.layout);
  crew_ = std::make_unique<Crew>(
      welcome.session, welcome.team < foosball::kTeams ? welcome.team : 0, layout, welcome.rods);
  crew_->set_assists(assists_of(settings_));
  crew_names_.joined();
  prediction_ = std::make_unique<RodPrediction>(layout);
  use_characters();
}

void App::use_characters() {
  if (status_.characters != characters_) {
    characters_ = status_.characters;
    scene_->set_characters(*characters_);
    ui_->set_pictures(scene_->portraits(), scene_->portrait_cells());
    effects_.set_characters(*characters_);
  }
  if (crew_) crew_->set_characters(*characters_);
  if (prediction_) prediction_->set_characters(*characters_);
}

// During a match rods may be given to others, and the team may change.
void App::follow_roster() {
  if (!crew_ || status_.link != Link::joined) return;
  roster_ = connection_->roster();
  learn_names();
  const auto own = std::ranges::find(roster_.seats, status_.welcome.client, &wire::Seat::client);
  if (own != roster_.seats.end())
    crew_->grant(own->team < foosball::kTeams ? own->team : crew_->team(), own->rods);
  if (const auto tuning = connection_->tuning()) {
    tuning_ = tuning_of(*tuning);
    prediction_->set_tuning(tuning_);
  }
}

// A name may have letters that no sentence of the language has.
void App::learn_names() {
  constexpr std::size_t kMax = 4096;  // bytes: the names of many strangers must not fill the atlas
  std::string names = names_;
  for (const wire::Seat& seat : roster_.seats) names += seat.name;
  for (const std::string& player : roster_.players) names += player;
  for (const std::string& name : settings_.names) names += name;
  if (names.size() > kMax || hangul_of(names) == hangul_of(names_)) return;
  names_ = names;
  if (const std::string error = use_texts(); !error.empty()) log_warning(error);
}

// During a match the names stay: a player who changes the name would have left it.
void App::send_names() {
  const auto screen = static_cast<wire::Screen>(sample_.state.screen);
  const bool in_match = sample_.any && !sample_.state.attract &&
                        (screen == wire::Screen::play || screen == wire::Screen::ceremony);
  if (!crew_ || status_.link != Link::joined) return;
  if (const auto names = crew_names_.update(*crew_, settings_, in_match))
    connection_->name(crew_->session(), *names);
}

// The team whose side the picture is seen from; -1: this client only watches.
int App::viewer_team() const {
  return crew_ && crew_->plays() ? crew_->team() : -1;
}

void App::log_when_synchronised(std::int64_t now) {
  if (awaiting_since_ == 0 || status_.link != Link::joined) return;
  log_info("synchronised with the match after " + std::to_string((now - awaiting_since_) / 1000) +
           " ms");
  awaiting_since_ = 0;
}

void App::receive(std::int64_t now) {
  follow_connection();
  follow_roster();
  follow_phones();
  SceneSample sample = connection_->sample(now);
  if (sample.any) sample_ = std::move(sample);  // else the last scene stays
  send_names();
  const auto events = connection_->take_events();
  events_.insert(events_.end(), events.begin(), events.end());
}

void App::take_input(std::int64_t now) {
  window_->poll();
  InputEvents events = window_->input().take(kAllDevices);
  seats_ = seats_view();
  const bool menu = menu_.open();  // the rods stay as they are
  if (menu) {
    take_menu_input(events, now);
    events = {};
  } else if (take_survey_input(now)) {
    events.back = false;
  } else if (asks_for_menu(events)) {
    open_menu(events);
  } else if (events.back) {
    window_->close();
  }
  tune(now);
  choose_game(now);
  watch_devices(now);
  if (events.toggle_help) show_help_ = !show_help_;
  if (events.presses[index_of(Action::camera)] % 2 != 0) turn_view();
  if (replay_ && (events.push || events.pad_push)) reel_.skip();
  if (crew_) drive_rods(menu, now);
  window_->forget_input();
  report_pads();
}

void App::drive_rods(bool menu, std::int64_t now) {
  const DeviceSet answer = survey_.devices(now);
  const auto take = [&](DeviceSet devices) {
    devices = static_cast<DeviceSet>(devices & ~answer);
    return menu || devices == 0 ? InputEvents{} : window_->input().take(devices);
  };
  crew_->update(take, sample_.any ? &sample_.state : nullptr, now);
  settings_.automatic_rod = crew_->automatic();
  if (!crew_->begun() || !crew_->plays()) return;
  connection_->drive(crew_->session(), crew_->rods());
  for (const wire::MatchRequest& request : crew_->requests())
    connection_->request(crew_->session(), request);
}

void App::follow_phones() {
  std::string phones = connection_->phones();
  if (phones == phones_) return;
  phones_ = std::move(phones);
  phones_code_ = qr_code_of(phones_);
}

// Each pad that has a rod of its own, or that belongs to the first person.
void App::shake_pads() {
  if (!settings_.vibration || !crew_ || !crew_->plays() || !sample_.any || !characters_) return;
  for (const cabinet::HapticPulse& pulse : haptics_.feel(
           events_, sample_.state, *characters_, tuning_, crew_->granted(), os::monotonic_us())) {
    const DeviceSet devices = crew_->devices_of(crew_->player_of(pulse.rod));
    for (int pad = 0; pad < kPads; ++pad)
      if ((devices & bit_of(pad_device(pad))) != 0) window_->rumble(pad, pulse.strength, pulse.ms);
  }
}

// Runs last before drawing, so that this frame shows the latest input.
void App::predict(std::int64_t now) {
  if (!sample_.any) return;
  drawn_ = sample_.state;
  if (!prediction_ || !crew_->begun() || !scene_is_current()) return;
  prediction_->update(crew_->rods(), sample_.state, now);
  prediction_->apply(drawn_);
}

// The rods that people here drive; none during the goal's replay.
std::uint8_t App::active_rods() const {
  return crew_ && crew_->plays() && !replay_ ? crew_->active_rods() : std::uint8_t{0};
}

// The offsets of the handles apply only if the screen lies in the table.
std::array<float, 8> App::rod_shift() const {
  return settings_.view == View::above ? settings_.handle_offset : std::array<float, 8>{};
}

// The players' names at the handles, if there are several players.
std::array<std::string, 8> App::rod_names() const {
  std::array<std::string, 8> names;
  const auto screen = static_cast<wire::Screen>(drawn_.screen);
  const bool shown = screen == wire::Screen::play || screen == wire::Screen::logo || menu_.open();
  if (!crew_ || !sample_.any || !shown || replay_) return names;
  const auto all = names_at_rods(seats_, *crew_);
  for (std::size_t rod = 0; rod < names.size(); ++rod) {
    const RodName& name = all[rod];
    names[rod] = name.translate && !name.text.empty() ? tr(name.text.c_str()) : name.text;
    if (name.number > 0) names[rod].append(1, ' ').append(std::to_string(name.number));
  }
  return names;
}

HudState App::hud(const Camera& camera) {
  HudState hud;
  hud.state = sample_.any ? &drawn_ : nullptr;
  hud.camera = camera;
  if (characters_) hud.characters = characters_.get();
  hud.viewer_team = viewer_team();
  hud.mouse_free = !window_->captured();
  hud.show_help = show_help_;
  hud.automatic_rod = settings_.automatic_rod && hud.viewer_team >= 0;
  hud.active_rods = active_rods();
  hud.view = settings_.view;
  hud.rods = settings_.rods;
  hud.text_scale = settings_.text_scale;
  hud.still = settings_.reduced_flashes;
  hud.replay = replay_;
  hud.rod_shift = rod_shift();
  set_story(hud, story_);
  hud.menu = menu_.page(menu_context());
  const bool logo = sample_.any && drawn_.screen == number(wire::Screen::logo);
  const bool asks = menu_.shows(Menu::Page::seats) || (logo && !menu_.open());
  if (asks && phones_code_.size > 0) hud.phones = &phones_code_;
  hud.rod_names = rod_names();
  if (report_) hud.fame = report_->fame;
  if (report_ && report_->match != report_before_) hud.report = &*report_;
  hud.survey = survey_.panels(os::monotonic_us());
  if (1e6 * seconds_ < kProblemsShownUs) hud.notices = problems_;
  hud.fps = options_.show_fps ? static_cast<float>(meter_.rate()) : 0.0f;
  for (const wire::Notice& notice : connection_->notices()) hud.notices.push_back(notice.text);
  hud.notices.insert(hud.notices.end(), messages_.begin(), messages_.end());
  const auto message = [this](const char* text) {
    return std::string(text) + " " + connection_->address();
  };
  switch (status_.link) {
    case Link::joined:
      if (!scene_is_current())
        hud.connection_message = message(tr("Waiting for the first snapshot from"));
      hud.starving = sample_.starving;
      break;
    case Link::connecting:
      hud.connection_message = message(tr("Waiting for the physics server at"));
      hud.connection_detail = status_.detail;
      break;
    case Link::lost:
      if (match_is_over()) break;
      hud.connection_message = message(tr("Physics server lost: waiting at"));
      hud.connection_detail = status_.detail;
      break;
    case Link::refused:
      hud.connection_message = message(tr("Rejected by the physics server at"));
      hud.connection_detail = status_.detail;
      break;
  }
  return hud;
}

void App::draw(float dt) {
  size_ = glm::max(window_->size(), 1);
  SceneView view;
  view.time = static_cast<float>(seconds_);
  view.active_rods = active_rods();
  view.rods = settings_.rods;
  view.reduced_flashes = settings_.reduced_flashes;
  view.distinct_teams = settings_.distinct_teams;
  view.rod_shift = rod_shift();
  const float shake = settings_.reduced_shake ? 0.0f : effects_.shake();
  motion_.step(sample_.any ? &drawn_ : nullptr, std::max(viewer_team(), 0), dt, shake);
  view.camera = motion_.camera(settings_.view, size_);
  particles_.set_reduced(settings_.reduced_flashes);
  shift_scene(drawn_, view.rod_shift);
  static const wire::Snapshot kNothing;
  const wire::Snapshot& state = sample_.any ? drawn_ : kNothing;
  const bool moves = !state.paused && status_.link == Link::joined;
  if (sample_.any) {
    if (moves) shake_pads();
    story_.update(events_, state, dt);
    effects_.show(events_, state, story_, particles_, sounds_.get(), moves ? dt : 0.0f);
  }
  events_.clear();
  if (!state.paused) particles_.step(dt);
  if (sounds_) sounds_->set_listener(view.camera.eye, glm::vec3(0));
  scene_->draw(state, view, particles_, size_);
  draw_hud(*ui_, hud(view.camera), size_);
}

void App::judge_quality() {
  if (wanted_quality() || scene_->quality() == draw::Quality::low || !meter_.too_slow()) return;
  log_info("high quality is too slow here");
  meter_.restart_judgement();
  if (const std::string error = use_quality(draw::Quality::low); !error.empty()) {
    log_warning(error);
    window_->close();
  }
}

// A picture is worth a slow frame: it is drawn in high quality, unless another was requested.
std::string App::take_screenshot() {
  const draw::Quality usual = scene_->quality();
  const bool better = !wanted_quality() && usual != draw::Quality::high;
  if (better) {
    if (std::string error = use_quality(draw::Quality::high); !error.empty()) return error;
    draw(0.0f);
  }
  const auto wrote = draw::write_png(draw::read_pixels(size_), options_.screenshot);
  if (wrote) log_info("picture written to " + options_.screenshot);
  const std::string error = better ? use_quality(usual) : std::string();
  return wrote ? error : wrote.error();
}

bool App::scene_is_current() const {
  return sample_.any && sample_.state.session == status_.welcome.session;
}

bool App::match_is_over() const {
  return options_.until_server_ends && status_.link == Link::lost && status_.server_ended;
}

bool App::leaving(double seconds) const {
  const bool time_over = options_.seconds && seconds >= *options_.seconds;
  return window_->should_close() || asked_to_leave != 0 ||
         (!watching_ && (match_is_over() || time_over));
}

// The first frame may take long to draw, because the driver compiles shaders. It should show the
// match already, if the server answers at once.
void App::await_first_snapshot() {
  constexpr double kPatience = 0.25;  // [s]; a server on this machine answers within 10 ms
  constexpr double kLook = 0.002;
  for (double waited = 0.0; waited < kPatience && !sample_.any; waited += kLook) {
    window_->wait(kLook);
    receive(os::monotonic_us());
  }
}

int App::loop() {
  await_first_snapshot();
  const std::int64_t began = os::monotonic_us();
  std::int64_t before = began;
  bool shot = options_.screenshot.empty();
  std::string failure;
  double drawing = 0.0;         // [s], without the time for a screenshot
  std::int64_t picture_us = 0;  // not counted for the frame rate
  for (bool last = false; !last;) {
    const std::int64_t now = os::monotonic_us();
    const float dt = std::min(1e-6f * static_cast<float>(now - before), 0.1f);
    before = now;
    seconds_ = 1e-6 * static_cast<double>(now - began);
    meter_.begin(now);
    receive(now);
    const std::int64_t input_us = os::monotonic_us();
    take_input(input_us);
    predict(input_us);
    replay_ = reel_.follow(drawn_, input_us);
    follow_survey(input_us);
    follow_report();
    follow_watching();
    if (watching_) {
      window_->wait(kHiddenFrame);
    } else {
      draw(dt);
    }
    last = leaving(seconds_);
    if (!shot && (last || (options_.screenshot_at && seconds_ >= *options_.screenshot_at))) {
      shot = true;
      const std::int64_t pause = os::monotonic_us();
      failure = take_screenshot();
      picture_us = os::monotonic_us() - pause;
    }
    drawing = 1e-6 * static_cast<double>(os::monotonic_us() - began - picture_us);
    if (!watching_) window_->swap();
    if (scene_is_current() && !sample_.starving) log_when_synchronised(os::monotonic_us());
    meter_.end(os::monotonic_us());
    judge_quality();
  }
  print_statistics(drawing);
  connection_.reset();  // sends Bye
  if (!failure.empty()) std::fprintf(stderr, "%s\n", failure.c_str());
  return failure.empty() ? 0 : 1;
}

void App::print_statistics(double seconds) const {
  const SnapshotCounters c = connection_->counters();
  const double rate = seconds > 0 ? static_cast<double>(meter_.frames()) / seconds : 0;
  char text[640];
  std::snprintf(
      text, sizeof text,
      "{\n  \"frames\": %llu,\n  \"frames_per_second\": %.1f,\n  \"quality\": \"%s\",\n"
      "  \"snapshots_received\": %llu,\n  \"snapshots_lost\": %llu,\n  \"snapshots_bad\": %llu,\n"
      "  \"snapshots_old\": %llu,\n  \"snapshots_foreign\": %llu,\n  \"snapshots_reordered\": "
      "%llu,\n"
      "  \"interpolation_delay_us\": %lld,\n  \"inputs_sent\": %llu,\n  \"joins\": %llu,\n  "
      "\"seconds\": %.2f\n}\n",
      static_cast<unsigned long long>(meter_.frames()), rate,
      scene_->quality() == draw::Quality::high ? "high" : "low",
      static_cast<unsigned long long>(c.received), static_cast<unsigned long long>(c.lost),
      static_cast<unsigned long long>(c.bad), static_cast<unsigned long long>(c.old),
      static_cast<unsigned long long>(c.foreign), static_cast<unsigned long long>(c.reordered),
      static_cast<long long>(connection_->delay_us()),
      static_cast<unsigned long long>(connection_->inputs_sent()),
      static_cast<unsigned long long>(joins_seen_), seconds);
  std::printf(
      "frames %llu (%.1f/s), snapshots %llu received, %llu lost, %llu bad, %llu old, %llu foreign, "
      "interpolation delay %.2f ms\n",
      static_cast<unsigned long long>(meter_.frames()), rate,
      static_cast<unsigned long long>(c.received), static_cast<unsigned long long>(c.lost),
      static_cast<unsigned long long>(c.bad), static_cast<unsigned long long>(c.old),
      static_cast<unsigned long long>(c.foreign),
      1e-3 * static_cast<double>(connection_->delay_us()));
  if (options_.stats_file.empty()) return;
  std::ofstream file(options_.stats_file);
  file << text;
  if (!file)
    log_warning("Cannot write the statistics to " + options_.stats_file +
                ": choose a directory that can be written to.");
}

int run(const Options& options) {
  // Before the window and the signal handlers: resolving a name may take long, and Ctrl-C must end
  // it.
  auto connection = Connection::open(options.connection);
  if (!connection) {
    std::fprintf(stderr, "%s\n", connection.error().c_str());
    return 1;
  }
  for (const int signal : {SIGINT, SIGTERM}) std::signal(signal, [](int) { asked_to_leave = 1; });
  App app(options, std::move(*connection));
  int exit_code = 0;
  if (const std::string error = app.start(exit_code); !error.empty()) {
    std::fprintf(stderr, "%s\n", error.c_str());
    return exit_code;
  }
  return app.loop();
}

}  // namespace client
