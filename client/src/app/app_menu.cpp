#include <algorithm>
#include <filesystem>

#include "app/app_impl.h"

namespace client {
namespace {

// Beside the program, both in the build tree and installed.
std::string catalogue_directory() {
  std::error_code error;
  const auto program = std::filesystem::read_symlink("/proc/self/exe", error);
  return (program.parent_path().parent_path() / "share" / "locale").string();
}

}  // namespace

foosball::AssistChoice assists_of(const Settings& settings) {
  return {settings.automatic_rod, settings.goalie_follows, settings.aim};
}

foosball::Tuning tuning_of(const wire::Tuning& reported) {
  foosball::Tuning tuning;
  for (std::size_t i = 0; i < reported.values.size(); ++i) {
    const foosball::TuningField& field = foosball::kTuningFields[i];
    if (foosball::in_range(field, reported.values[i])) tuning.*field.value = reported.values[i];
  }
  return tuning;
}

// Loads the language's catalogue, and the letters that it needs.
std::string App::use_texts() {
  constexpr std::array<const char*, kLanguages> kCodes{"", "en", "ko", "de"};
  language_ = kCodes[static_cast<std::size_t>(settings_.language)];
  use_language(language_, catalogue_directory());
  auto font = Font::load(options_.font_directory, catalogue_file(), names_);
  if (!font) return font.error();
  auto ui = UiBatch::create(std::move(*font));
  if (!ui) return ui.error();
  ui_ = std::move(*ui);
  if (scene_) ui_->set_pictures(scene_->portraits(), scene_->portrait_cells());
  return {};
}

void App::read_settings() {
  ReadSettings read = load_settings(settings_path());
  settings_ = read.settings;
  if (options_.view) settings_.view = *options_.view;
  std::ranges::copy(options_.names, settings_.names.begin());
  problems_ = std::move(read.problems);
  for (const std::string& problem : problems_) log_warning(problem);
}

void App::apply_settings() {
  constexpr std::array<const char*, kLanguages> kCodes{"", "en", "ko", "de"};
  if (language_ != kCodes[static_cast<std::size_t>(settings_.language)]) {
    if (const std::string error = use_texts(); !error.empty()) log_warning(error);
  }
  if (sounds_) sounds_->set_volume(settings_.volume);
  if (const auto quality = wanted_quality(); quality && *quality != scene_->quality()) {
    if (const std::string error = use_quality(*quality); !error.empty()) log_warning(error);
  }
  window_->set_keys(settings_.keys);
  if (crew_) crew_->set_assists(assists_of(settings_));
}

void App::change_settings() {
  apply_settings();
  if (const auto saved = save_settings(settings_, settings_path()); !saved)
    log_warning(saved.error());
}

SeatsView App::seats_view() const {
  SeatsView view;
  view.client = status_.welcome.client;
  view.role = status_.welcome.role;
  view.roster = roster_;
  if (sample_.any) view.scene = sample_.state;
  for (int pad = 0; pad < kPads; ++pad) {
    if (window_->input().connected(pad)) view.pads |= bit_of(pad_device(pad));
  }
  view.notices = connection_->notices();
  view.own_names = crew_names_.set_names();
  return view;
}

Menu::Context App::menu_context() {
  const bool joined = status_.link == Link::joined;
  return {settings_, seats_, joined ? crew_.get() : nullptr};
}

void App::open_menu(const InputEvents& events) {
  const auto asked = [&](Action action) { return events.presses[index_of(action)] % 2 != 0; };
  if (asked(Action::settings) || events.pad_menu) menu_.toggle(Menu::Page::settings);
  if (asked(Action::seats)) menu_.toggle(Menu::Page::seats);
  if (asked(Action::tuning)) menu_.toggle(Menu::Page::tuning);
  if (asked(Action::game)) menu_.toggle(Menu::Page::game);
  if (asked(Action::controllers)) menu_.toggle(Menu::Page::controllers);
  if (asked(Action::recordings)) return watch_recordings();
  menu_hand_.restart();
}

void App::take_menu_input(const InputEvents& events, std::int64_t now) {
  const bool waits = menu_.waits_for_key();
  // While the menu waits for a key, keys make no steps and open no page.
  const auto pressed = [&](Action action) {
    return !waits && events.presses[index_of(action)] % 2 != 0;
  };
  if (pressed(Action::seats)) return menu_.toggle(Menu::Page::seats);
  if (pressed(Action::tuning)) return menu_.toggle(Menu::Page::tuning);
  if (pressed(Action::game)) return menu_.toggle(Menu::Page::game);
  if (pressed(Action::controllers)) return menu_.toggle(Menu::Page::controllers);
  if (pressed(Action::recordings)) return watch_recordings();
  const wire::Snapshot* scene = sample_.any ? &sample_.state : nullptr;
  const MenuSteps steps = menu_hand_.steps(events, scene, viewer_team(), now);
  const Menu::Outcome outcome =
      menu_.step(waits ? MenuSteps{.back = events.back, .text = events.text} : steps,
                 events.any_key, menu_context());
  if (outcome.settings_changed) change_settings();
  if (outcome.watch_recordings) watch_recordings();
  if (!crew_) return;
  if (outcome.asked.claim) connection_->claim(crew_->session(), *outcome.asked.claim);
  if (outcome.asked.kick) connection_->kick(crew_->session(), *outcome.asked.kick);
  for (const wire::MatchRequest& request : outcome.asked.requests)
    connection_->request(crew_->session(), request);
}

// Pauses the match if the person plays in it; a pause that others must agree to is only requested.
void App::watch_recordings() {
  if (watching_) return;
  std::vector<std::string> options;
  if (options_.fullscreen) options.emplace_back("--fullscreen");
  if (options_.mute) options.emplace_back("--mute");
  auto program = WatchProgram::start(options);
  if (!program) {
    log_warning(program.error());
    show_messages({program.error()});
    return;
  }
  watching_.emplace(std::move(*program));
  log_info("showing the recordings");
  const bool playing = sample_.any && sample_.state.screen == number(wire::Screen::play);
  if (crew_ && crew_->plays() && playing && !sample_.state.paused) {
    const auto team = static_cast<std::uint8_t>(crew_->team());
    connection_->request(crew_->session(), {number(wire::RequestKind::pause), team, 1});
  }
  if (sounds_) sounds_->set_volume(0.0f);
  window_->set_visible(false);
}

void App::follow_watching() {
  const auto code = watching_ ? watching_->ended() : std::nullopt;
  if (!code) return;
  watching_.reset();
  window_->set_visible(true);
  log_info("back from the recordings");
  if (sounds_) sounds_->set_volume(settings_.volume);
  if (*code == 0) return;
  const std::string said = "space-foosball-watch ended with " + std::to_string(*code) +
                           ": what it said is in the terminal, or in the log of ./play";
  log_warning(said);
  show_messages({said});
}

// Shows the lines for a while.
void App::show_messages(std::vector<std::string> lines) {
  constexpr double kShown = 8.0;  // [s]
  messages_ = std::move(lines);
  messages_until_ = seconds_ + kShown;
}

void App::turn_view() {
  settings_.view = static_cast<View>((static_cast<int>(settings_.view) + 1) % kViews);
  change_settings();
}

void App::tune(std::int64_t now) {
  if (!crew_ || status_.link != Link::joined) return;
  const auto reported = connection_->tuning();
  menu_.tuning().update(crew_->session(),
                        reported ? std::optional(tuning_of(*reported)) : std::nullopt,
                        status_.welcome.role == number(wire::Role::host));
  for (const wire::MatchRequest& request : menu_.tuning().requests(now))
    connection_->request(crew_->session(), request);
}

void App::choose_game(std::int64_t now) {
  if (!crew_ || status_.link != Link::joined) return;
  std::string refused;
  for (const wire::Notice& notice : connection_->notices())
    if (notice.topic == wire::kGameAnswerTopic) refused = notice.text;
  menu_.game().update(crew_->session(), connection_->game(),
                      status_.welcome.role == number(wire::Role::host), refused);
  if (const auto game = menu_.game().ask(now)) connection_->choose(crew_->session(), *game);
}

void App::watch_devices(std::int64_t now) {
  if (!crew_ || status_.link != Link::joined) return;
  DevicesMenu& devices = menu_.devices();
  devices.follow(crew_->session(), status_.welcome.role == number(wire::Role::host));
  if (const auto reported = connection_->take_devices()) devices.update(*reported);
  if (menu_.shows(Menu::Page::controllers) && devices.ask(now))
    connection_->ask_devices(crew_->session());
}

void App::report_pads() {
  if (auto messages = window_->take_messages(); !messages.empty()) {
    for (const std::string& line : messages) log_info(line);
    show_messages(std::move(messages));
  }
  if (seconds_ > messages_until_) messages_.clear();
}

}  // namespace client
