// A person's settings for this renderer, and their file: lines of "name = value".
//
// A line that cannot be parsed is reported with its number and what to write instead; all other
// lines are used. Before a file with such lines is overwritten, it is copied beside it (".bad"), so
// that nothing a person wrote is lost.
#pragma once

#include <array>
#include <string>
#include <string_view>
#include <tl/expected.hpp>
#include <vector>

#include "client/controls.h"
#include "foosball/table.h"

namespace client {

enum class View : std::uint8_t { seat, above, follow, spectator };
inline constexpr int kViews = 4;
enum class QualityChoice : std::uint8_t { automatic, low, high };
enum class Language : std::uint8_t { automatic, english, korean, german };
inline constexpr int kLanguages = 4;
// Whether rods are drawn: where the table has rods (the men of the paper's layout hang on none),
// always, never.
enum class RodsShown : std::uint8_t { as_on_the_table, on, off };
inline constexpr int kRodsShown = 3;
// People at one window who may have a name; further people are numbered.
inline constexpr std::size_t kNamedPeople = 4;
constexpr bool rods_are_drawn(RodsShown rods, foosball::Layout layout) {
  return rods == RodsShown::as_on_the_table ? !foosball::hinged_men(layout) : rods == RodsShown::on;
}

// Key codes of the window library (GLFW: US layout); 0: none. Two for each action.
using KeyBindings = std::array<std::array<int, 2>, kActions>;
KeyBindings default_keys();

struct Settings {
  float volume = 0.8f;  // 0..1, of all sounds
  QualityChoice quality = QualityChoice::automatic;
  float text_scale = 1.0f;       // kTextScale[0]..kTextScale[1]
  bool reduced_flashes = false;  // no bursts of light, no pulses
  bool reduced_shake = false;    // the camera does not shake
  bool distinct_teams = false;   // teams differ in pattern and shape; colour-blind-safe colours
  Language language = Language::automatic;
  View view = View::seat;
  RodsShown rods = RodsShown::as_on_the_table;
  bool automatic_rod = false;  // assists, each independent
  bool goalie_follows = false;
  bool aim = false;
  bool vibration = true;       // a gamepad rumbles when a man of its rods hits the ball
  bool questionnaire = true;   // ask after a match
  bool record_matches = true;  // read by the program that starts the server, such as ./play
  // Offset along the table of each handle outside the screen from its drawn rod [m]: for the view
  // from above on a cabinet. At most kHandleOffset in either direction.
  std::array<float, 8> handle_offset{};
  KeyBindings keys = default_keys();
  // Names of the people at this window, used in results; empty: "player", "player 2" ...
  std::array<std::string, kNamedPeople> names;

  bool operator==(const Settings&) const = default;
};
inline constexpr std::array<float, 2> kTextScale{0.8f, 1.6f};
inline constexpr float kHandleOffset = 0.060f;  // [m]

struct ReadSettings {
  Settings settings;
  std::vector<std::string> problems;  // one sentence each: the line, the problem, what to write
};
// Name of the person with this index, from 0.
std::string name_of_person(const Settings& settings, std::size_t place);

ReadSettings parse_settings(std::string_view text);
std::string format_settings(const Settings& settings);

// Names as in the file and on the settings screen: "slide_away"; "Up". Empty: no such key.
const char* name_of(Action action);
std::string name_of_key(int key);
int key_of_name(std::string_view name);  // 0: no such key

// $XDG_CONFIG_HOME/space-foosball/client.conf, or ~/.config/...; empty if neither variable is set.
std::string settings_path();
// A missing file is no problem: it gives the defaults.
ReadSettings load_settings(const std::string& path);
// Writes a file beside the old one and renames it over the old one. The error is a sentence.
tl::expected<void, std::string> save_settings(const Settings& settings, const std::string& path);

}  // namespace client
