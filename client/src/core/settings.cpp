#include "client/settings.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstdio>
#include <sstream>

#include "wire/control.h"
#include "wire/text.h"

namespace client {
namespace {

constexpr std::array<const char*, kActions> kActionNames{
    "slide_away", "slide_near", "spin_right", "spin_left",    "rod_1", "rod_2",
    "rod_3",      "rod_4",      "next_rod",   "previous_rod", "push",  "pause",
    "automatic",  "camera",     "settings",   "help",         "seats", "tuning",
    "time_out",   "recordings", "game",       "controllers",  "feed"};

struct NamedKey {
  const char* name;
  int key;
};
// Letters, digits and F1 to F12 follow a naming rule.
constexpr NamedKey kNamedKeys[] = {
    {"Space", 32},       {"Apostrophe", 39},   {"Comma", 44},         {"Minus", 45},
    {"Period", 46},      {"Slash", 47},        {"Semicolon", 59},     {"Equal", 61},
    {"BracketLeft", 91}, {"Backslash", 92},    {"BracketRight", 93},  {"Grave", 96},
    {"Enter", 257},      {"Tab", 258},         {"Backspace", 259},    {"Insert", 260},
    {"Delete", 261},     {"Right", 262},       {"Left", 263},         {"Down", 264},
    {"Up", 265},         {"PageUp", 266},      {"PageDown", 267},     {"Home", 268},
    {"End", 269},        {"KeypadEnter", 335}, {"ShiftLeft", 340},    {"ControlLeft", 341},
    {"AltLeft", 342},    {"ShiftRight", 344},  {"ControlRight", 345}, {"AltRight", 346}};
constexpr int kF1 = 290, kKeypad0 = 320;

std::string sentence(std::initializer_list<std::string_view> parts) {
  std::string text;
  for (const std::string_view part : parts) text.append(part);
  return text;
}

std::string_view trimmed(std::string_view text) {
  const auto first = text.find_first_not_of(" \t\r");
  if (first == std::string_view::npos) return {};
  return text.substr(first, text.find_last_not_of(" \t\r") - first + 1);
}

bool read_float(std::string_view text, float low, float high, float& value) {
  float read = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), read);
  if (error != std::errc() || end != text.data() + text.size()) return false;
  if (!std::isfinite(read) || read < low || read > high) return false;
  value = read;
  return true;
}

bool read_flag(std::string_view text, bool& value) {
  if (text != "yes" && text != "no") return false;
  value = text == "yes";
  return true;
}

template <class Enum, std::size_t N>
bool read_word(std::string_view text, const std::array<const char*, N>& words, Enum& value) {
  const auto found = std::find(words.begin(), words.end(), text);
  if (found == words.end()) return false;
  value = static_cast<Enum>(found - words.begin());
  return true;
}

constexpr std::array<const char*, 3> kQualityValues{"auto", "low", "high"};
constexpr std::array<const char*, kViews> kViewValues{"seat", "above", "follow", "spectator"};
constexpr std::array<const char*, kRodsShown> kRodsValues{"table", "yes", "no"};
constexpr std::array<const char*, kLanguages> kLanguageValues{"auto", "en", "ko", "de"};

bool read_keys(std::string_view text, std::array<int, 2>& keys) {
  std::array<int, 2> read{};
  std::istringstream words{std::string(text)};
  std::string word;
  for (std::size_t i = 0; words >> word; ++i) {
    const int key = i < read.size() ? key_of_name(word) : 0;
    if (key == 0) return false;
    read[i] = key;
  }
  keys = read;
  return true;
}

bool read_offsets(std::string_view text, std::array<float, 8>& offsets) {
  std::array<float, 8> read{};
  std::istringstream words{std::string(text)};
  std::string word;
  std::size_t count = 0;
  for (; words >> word; ++count) {
    float mm = 0;
    if (count >= read.size() || !read_float(word, -1e3f * kHandleOffset, 1e3f * kHandleOffset, mm))
      return false;
    read[count] = 1e-3f * mm;
  }
  if (count != read.size()) return false;
  offsets = read;
  return true;
}

// Empty: parsed. Otherwise the valid values.
std::string read_setting(std::string_view name, std::string_view value, Settings& s) {
  const auto flag = [&](bool& into) { return read_flag(value, into) ? "" : "yes or no"; };
  if (name == "volume") return read_float(value, 0, 1, s.volume) ? "" : "a number from 0 to 1";
  if (name == "quality")
    return read_word(value, kQualityValues, s.quality) ? "" : "auto, low or high";
  if (name == "text_scale")
    return read_float(value, kTextScale[0], kTextScale[1], s.text_scale)
               ? ""
               : "a number from 0.8 to 1.6";
  if (name == "reduced_flashes") return flag(s.reduced_flashes);
  if (name == "reduced_shake") return flag(s.reduced_shake);
  if (name == "distinct_teams") return flag(s.distinct_teams);
  if (name == "language")
    return read_word(value, kLanguageValues, s.language) ? "" : "auto, en, ko or de";
  if (name == "view")
    return read_word(value, kViewValues, s.view) ? "" : "seat, above, follow or spectator";
  if (name == "rods") return read_word(value, kRodsValues, s.rods) ? "" : "table, yes or no";
  if (name == "hide_rods") {  // written by versions with only two choices
    bool hide = false;
    if (!read_flag(value, hide)) return "yes or no";
    s.rods = hide ? RodsShown::off : RodsShown::as_on_the_table;
    return "";
  }
  if (name == "automatic_rod") return flag(s.automatic_rod);
  if (name == "goalie_follows") return flag(s.goalie_follows);
  if (name == "aim") return flag(s.aim);
  if (name == "vibration") return flag(s.vibration);
  if (name == "questionnaire") return flag(s.questionnaire);
  if (name == "record_matches") return flag(s.record_matches);
  if (name == "handle_offset_mm")
    return read_offsets(value, s.handle_offset) ? "" : "eight numbers from -60 to 60";
  if (name.starts_with("name.")) {
    for (std::size_t i = 0; i < s.names.size(); ++i) {
      if (name.substr(5) != std::to_string(i + 1)) continue;
      if (!wire::is_clean_text(value, wire::kMaxName)) return "a name of at most 64 bytes";
      s.names[i] = value;
      return "";
    }
  }
  if (name.starts_with("key.")) {
    for (std::size_t i = 0; i < kActionNames.size(); ++i) {
      if (name.substr(4) != kActionNames[i]) continue;
      return read_keys(value, s.keys[i]) ? "" : "none, one or two names of keys, as in \"Up W\"";
    }
  }
  return "one of the names that the game writes";
}

}  // namespace

KeyBindings default_keys() {
  KeyBindings keys{};
  const auto set = [&](Action action, const char* first, const char* second = "") {
    keys[index_of(action)] = {key_of_name(first), key_of_name(second)};
  };
  set(Action::slide_away, "Up", "W");
  set(Action::slide_near, "Down", "S");
  set(Action::spin_right, "Right", "D");
  set(Action::spin_left, "Left", "A");
  set(Action::rod_1, "1");
  set(Action::rod_2, "2");
  set(Action::rod_3, "3");
  set(Action::rod_4, "4");
  set(Action::next_rod, "PageUp", "E");
  set(Action::previous_rod, "PageDown", "Q");
  set(Action::push, "Enter", "Space");
  set(Action::pause, "P");
  set(Action::automatic, "Tab");
  set(Action::camera, "C");
  set(Action::settings, "F2", "O");
  set(Action::help, "F1", "H");
  set(Action::seats, "F3");
  set(Action::tuning, "F4");
  set(Action::time_out, "T");
  set(Action::recordings, "F5");
  set(Action::game, "F6");
  set(Action::controllers, "F7");
  set(Action::feed, "F");
  return keys;
}

const char* name_of(Action action) {
  return kActionNames[index_of(action)];
}

std::string name_of_key(int key) {
  if ((key >= 'A' && key <= 'Z') || (key >= '0' && key <= '9'))
    return std::string(1, static_cast<char>(key));
  char text[16] = "";
  if (key >= kF1 && key < kF1 + 12) std::snprintf(text, sizeof text, "F%d", key - kF1 + 1);
  if (key >= kKeypad0 && key < kKeypad0 + 10)
    std::snprintf(text, sizeof text, "Keypad%d", key - kKeypad0);
  if (text[0] != '\0') return text;
  for (const NamedKey& named : kNamedKeys) {
    if (named.key == key) return named.name;
  }
  return {};
}

int key_of_name(std::string_view name) {
  for (int key = 32; key < 347; ++key) {
    const std::string of_key = name_of_key(key);
    if (!of_key.empty() && of_key == name) return key;
  }
  return 0;
}

std::string name_of_person(const Settings& settings, std::size_t place) {
  if (place < settings.names.size() && !settings.names[place].empty()) return settings.names[place];
  return place == 0 ? "player" : "player " + std::to_string(place + 1);
}

ReadSettings parse_settings(std::string_view text) {
  ReadSettings read;
  for (int line = 1; !text.empty(); ++line) {
    const auto end = std::min(text.find('\n'), text.size());
    const std::string_view whole = trimmed(text.substr(0, end));
    text.remove_prefix(std::min(end + 1, text.size()));
    if (whole.empty() || whole[0] == '#') continue;
    const auto equals = whole.find('=');
    const auto report = [&](const std::string& cure) {
      if (read.problems.size() < 8)
        read.problems.push_back(sentence({"line ", std::to_string(line), ": ", cure}));
    };
    if (equals == std::string_view::npos) {
      report("write \"name = value\"");
      continue;
    }
    const std::string_view name = trimmed(whole.substr(0, equals));
    const std::string wanted = read_setting(name, trimmed(whole.substr(equals + 1)), read.settings);
    if (!wanted.empty()) report(sentence({"\"", name.substr(0, 40), "\" wants ", wanted}));
  }
  return read;
}

std::string format_settings(const Settings& s) {
  std::ostringstream out;
  const auto yes_no = [](bool on) { return on ? "yes" : "no"; };
  out << "# Space Foosball: settings of the renderer, one a line. The game writes this file.\n";
  out << "volume = " << s.volume << "\n";
  out << "quality = " << kQualityValues[static_cast<std::size_t>(s.quality)] << "\n";
  out << "text_scale = " << s.text_scale << "\n";
  out << "reduced_flashes = " << yes_no(s.reduced_flashes) << "\n";
  out << "reduced_shake = " << yes_no(s.reduced_shake) << "\n";
  out << "distinct_teams = " << yes_no(s.distinct_teams) << "\n";
  out << "language = " << kLanguageValues[static_cast<std::size_t>(s.language)] << "\n";
  out << "view = " << kViewValues[static_cast<std::size_t>(s.view)] << "\n";
  out << "rods = " << kRodsValues[static_cast<std::size_t>(s.rods)] << "\n";
  out << "automatic_rod = " << yes_no(s.automatic_rod) << "\n";
  out << "goalie_follows = " << yes_no(s.goalie_follows) << "\n";
  out << "aim = " << yes_no(s.aim) << "\n";
  out << "vibration = " << yes_no(s.vibration) << "\n";
  out << "questionnaire = " << yes_no(s.questionnaire) << "\n";
  out << "record_matches = " << yes_no(s.record_matches) << "\n";
  out << "handle_offset_mm =";
  for (const float offset : s.handle_offset) out << " " << std::lround(1e3f * offset);
  out << "\n";
  for (std::size_t i = 0; i < s.names.size(); ++i)
    out << "name." << i + 1 << " = " << s.names[i] << "\n";
  for (std::size_t i = 0; i < s.keys.size(); ++i) {
    out << "key." << kActionNames[i] << " =";
    for (const int key : s.keys[i]) {
      if (key != 0) out << " " << name_of_key(key);
    }
    out << "\n";
  }
  return out.str();
}

}  // namespace client
