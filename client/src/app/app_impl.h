// The renderer's session: the window, the connection, the people at it, and what is drawn for them.
// One thread. Implemented in app.cpp (the loop, input, drawing), app_menu.cpp (settings and the
// menu's pages) and app_survey.cpp (the questionnaire).
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "app/app.h"
#include "app/effects.h"
#include "app/frame_meter.h"
#include "app/log.h"
#include "app/view_motion.h"
#include "app/watch_program.h"
#include "app/window.h"
#include "client/crew.h"
#include "client/crew_names.h"
#include "client/menu.h"
#include "client/qr_code.h"
#include "client/rod_prediction.h"
#include "client/survey.h"
#include "core/pad_haptics.h"
#include "core/replay_reel.h"
#include "draw/image.h"
#include "os/clock.h"
#include "render/hud.h"
#include "render/scene.h"
#include "render/translate.h"

namespace client {

foosball::AssistChoice assists_of(const Settings& settings);
// Validates the server's tuning: a value out of range keeps its default.
foosball::Tuning tuning_of(const wire::Tuning& reported);

class App {
 public:
  App(const Options& options, std::unique_ptr<Connection> connection)
      : options_(options), connection_(std::move(connection)) {}
  // Returns an empty string, or the error to print; exit_code is then set.
  std::string start(int& exit_code);
  int loop();

 private:
  std::string use_quality(draw::Quality quality);
  std::string use_texts();
  std::optional<draw::Quality> wanted_quality() const;
  void read_settings();
  void apply_settings();
  void change_settings();
  void take_menu_input(const InputEvents& events, std::int64_t now);
  void open_menu(const InputEvents& events);
  SeatsView seats_view() const;
  Menu::Context menu_context();
  void watch_recordings();
  void follow_watching();
  void turn_view();
  void receive(std::int64_t now);
  void follow_connection();
  void follow_roster();
  void learn_names();
  void send_names();
  int viewer_team() const;
  void use_characters();
  void log_when_synchronised(std::int64_t now);
  void await_first_snapshot();
  void take_input(std::int64_t now);
  std::vector<SurveyPerson> survey_people(std::uint8_t rods) const;
  void follow_survey(std::int64_t now);
  void follow_report();
  bool take_survey_input(std::int64_t now);
  void drive_rods(bool menu, std::int64_t now);
  void tune(std::int64_t now);
  void choose_game(std::int64_t now);
  void watch_devices(std::int64_t now);
  void report_pads();
  void show_messages(std::vector<std::string> lines);
  void shake_pads();
  void follow_phones();
  void predict(std::int64_t now);
  void draw(float dt);
  std::uint8_t active_rods() const;
  std::array<float, 8> rod_shift() const;
  HudState hud(const Camera& camera);
  std::array<std::string, 8> rod_names() const;
  void judge_quality();
  std::string take_screenshot();
  void print_statistics(double seconds) const;
  // The scene is of the joined match. A scene of an earlier match is drawn, but not acted upon.
  bool scene_is_current() const;
  bool match_is_over() const;
  bool leaving(double seconds) const;

  const Options& options_;
  std::optional<Window> window_;
  std::unique_ptr<Scene> scene_;
  std::optional<UiBatch> ui_;
  std::unique_ptr<SoundPlayer> sounds_;
  std::unique_ptr<Connection> connection_;
  std::unique_ptr<Crew> crew_;  // of the joined match
  CrewNames crew_names_;
  std::unique_ptr<RodPrediction> prediction_;
  Particles particles_;
  Effects effects_;
  PadHaptics haptics_;
  std::string phones_;  // where phones join, as the server sent it
  QrCode phones_code_;
  MatchStory story_;
  std::vector<wire::EventSnapshot> events_;  // reached by the drawn scene, not shown yet
  ViewMotion motion_;
  FrameMeter meter_;
  SceneSample sample_;
  wire::Snapshot drawn_;  // the sample, with this client's rods at their predicted poses
  bool show_help_ = false;
  Settings settings_;
  std::optional<WatchProgram> watching_;  // while it runs, this window is hidden
  Menu menu_{tuning_directory()};
  SeatsView seats_;  // the data of the page of seats
  MenuHand menu_hand_;
  Survey survey_;
  std::uint32_t surveyed_ = 0;  // the last match that the questionnaire asked about
  std::optional<wire::Report> report_;
  std::uint32_t report_before_ = 0;    // the last report while the match was played
  std::vector<std::string> problems_;  // of the settings file
  std::string language_;               // in use
  std::string names_;                  // of people; the font has their letters
  std::vector<std::string> messages_;
  double messages_until_ = 0.0;  // [s]
  ReplayReel reel_;
  bool replay_ = false;
  ConnectionStatus status_;
  wire::Roster roster_;
  foosball::Tuning tuning_;                                 // of the match, once known
  std::shared_ptr<const foosball::Characters> characters_;  // in use; null: the built-in ones
  std::uint64_t joins_seen_ = 0;
  Link link_seen_ = Link::connecting;
  std::int64_t awaiting_since_ = 0;  // start of joining without a scene of the match yet; else 0
  glm::ivec2 size_{1, 1};
  double seconds_ = 0.0;
};

}  // namespace client
