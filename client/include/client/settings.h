// What a person sets for this renderer, and the file it is kept in: lines of "name = value".
//
// A line that cannot be read is reported with its number and what to write instead; all other lines
// count. Before a file with such lines is written anew, it is kept beside it (".bad"), so that
// nothing a person wrote is lost.
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
// Rods in the picture: where the table has rods (men of the paper's layout hang from none), always,
// never.
enum class RodsShown : std::uint8_t { as_on_the_table, on, off };
inline constexpr int kRodsShown = 3;
// People at one window that may have a name; any others are numbered.
inline constexpr std::size_t kNamedPeople = 4;
constexpr bool rods_are_drawn(RodsShown rods, foosball::Layout layout) {
  return rods == RodsShown::as_on_the_table ? !foosball::hinged_men(layout) : rods == RodsShown::on;
}

// Keys by the window library's number (GLFW: US layout); 0: none. Two for each action.
using KeyBindings = std::array<std::array<int, 2>, kActions>;
KeyBindings default_keys();

struct Settings {
  float volume = 0.8f;  // 0..1, of all sounds
  QualityChoice quality = QualityChoice::automatic;
  float text_scale = 1.0f;       // kTextScale[0]..kTextScale[1]
  bool reduced_flashes = false;  // no bursts of light, no pulses
  bool reduced_shake = false;    // a camera that stands
  bool distinct_teams = false;   // teams told apart by pattern and shape, colours for all eyes
  Language language = Language::automatic;
  View view = View::seat;
  RodsShown rods = RodsShown::as_on_the_table;
  bool automatic_rod = false;  // assists, each by itself
  bool goalie_follows = false;
  bool aim = false;
  bool vibration = true;       // a gamepad shakes when a man of its rods hits the ball
  bool questionnaire = true;   // may be asked for after a match
  bool record_matches = true;  // read by whatever starts the server, as ./play does
  // Of each handle outside the screen against its rod in the picture, along the table [m]: for the
  // view from above on a cabinet. kHandleOffset at most either way.
  std::array<float, 8> handle_offset{};
  KeyBindings keys = default_keys();
  // Of the people at this window, who are known by them in results; empty: "player", "player 2" ...
  std::array<std::string, kNamedPeople> names;

  bool operator==(const Settings&) const = default;
};
inline constexpr std::array<float, 2> kTextScale{0.8f, 1.6f};
inline constexpr float kHandleOffset = 0.060f;  // [m]

struct ReadSettings {
  Settings settings;
  std::vector<std::string> problems;  // one sentence each: line, what is wrong, what to write
};
// Of whoever is the so-and-so-many-th person here, from 0.
std::string name_of_person(const Settings& settings, std::size_t place);

ReadSettings parse_settings(std::string_view text);
std::string format_settings(const Settings& settings);

// As the file and the settings screen have them: "slide_away"; "Up". Empty: no such key.
const char* name_of(Action action);
std::string name_of_key(int key);
int key_of_name(std::string_view name);  // 0: no such key

// $XDG_CONFIG_HOME/space-foosball/client.conf, or ~/.config/...; empty without either.
std::string settings_path();
// A file that is not there is no problem: the defaults.
ReadSettings load_settings(const std::string& path);
// Written beside and then moved over the old one. The error is a sentence.
tl::expected<void, std::string> save_settings(const Settings& settings, const std::string& path);

}  // namespace client
