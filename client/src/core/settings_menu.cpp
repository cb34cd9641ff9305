#include "client/settings_menu.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <utility>

#include "foosball/table.h"
#include "wire/control.h"
#include "wire/text.h"

#define N_(english) english  // for xgettext: render/translate.h

namespace client {
namespace {

enum Row : int {
  row_volume,
  row_quality,
  row_text,
  row_language,
  row_view,
  row_rods,
  row_teams,
  row_flashes,
  row_shake,
  row_automatic,
  row_goalie,
  row_aim,
  row_vibration,
  row_questionnaire,
  first_name,
  first_offset = first_name + static_cast<int>(kNamedPeople),
  first_key = first_offset + 8,
  row_count = first_key + kActions,
};

constexpr std::array<const char*, kActions> kActionLabels{N_("Slide away"),
                                                          N_("Slide near"),
                                                          N_("Spin right"),
                                                          N_("Spin left"),
                                                          N_("Goalie"),
                                                          N_("Defence"),
                                                          N_("Midfield"),
                                                          N_("Attack"),
                                                          N_("Next rod"),
                                                          N_("Previous rod"),
                                                          N_("Push"),
                                                          N_("Pause"),
                                                          N_("Automatic rod on, off"),
                                                          N_("Camera"),
                                                          N_("Settings"),
                                                          N_("All keys"),
                                                          N_("Seats"),
                                                          N_("Tuning"),
                                                          N_("Time-out"),
                                                          N_("Recordings"),
                                                          N_("Game"),
                                                          N_("Controllers"),
                                                          N_("Training: next man")};
constexpr std::array<const char*, 3> kQualities{N_("automatic"), N_("low"), N_("high")};
constexpr std::array<const char*, kLanguages> kLanguageNames{N_("as the system"), "English",
                                                             "한국어", "Deutsch"};
constexpr std::array<const char*, kViews> kViewNames{N_("seat"), N_("from above (cabinet)"),
                                                     N_("follow the ball"), N_("spectator")};
constexpr std::array<const char*, kRodsShown> kRodsNames{N_("as on the table"), N_("on"),
                                                         N_("off")};

template <class Enum>
void turn(Enum& value, int way, int count) {
  value = static_cast<Enum>((static_cast<int>(value) + way % count + count) % count);
}

std::string percent(float share) {
  return std::to_string(std::lround(100.0f * share)) + " %";
}

const char* on_off(bool on) {
  return on ? N_("on") : N_("off");
}

std::string keys_text(const std::array<int, 2>& keys) {
  std::string text = name_of_key(keys[0]);
  if (keys[1] != 0) text.append(text.empty() ? "" : ", ").append(name_of_key(keys[1]));
  return text.empty() ? "-" : text;
}

int whole_steps(double& sum, double step) {
  const double steps = std::trunc(sum / step);
  sum -= steps * step;
  return static_cast<int>(std::clamp(steps, -3.0, 3.0));
}

}  // namespace

void MenuHand::restart() {
  *this = MenuHand();
}

int MenuHand::Held::steps(int held, std::int64_t now_us) {
  if (held != way) {
    way = held;
    next_us = now_us + kHoldUs;
    return 0;
  }
  if (way == 0 || now_us < next_us) return 0;
  next_us = now_us + kRepeatUs;
  return way;
}

MenuSteps MenuHand::steps(const InputEvents& events, const wire::Snapshot* scene, int team,
                          std::int64_t now_us) {
  const auto pressed = [&](Action action) { return events.presses[index_of(action)]; };
  MenuSteps steps;
  steps.down = pressed(Action::slide_near) - pressed(Action::slide_away) - events.wheel;
  steps.right = pressed(Action::spin_right) - pressed(Action::spin_left);
  steps.down -= events.pad_up;
  steps.right += events.pad_right;
  const auto held = [](double key, int pad) { return pad != 0 ? pad : static_cast<int>(key); };
  steps.down += held_down_.steps(-held(events.key_slide, events.held_up), now_us);
  steps.right += held_right_.steps(held(events.key_spin, events.held_right), now_us);
  mouse_down_ -= events.mouse_forward;
  mouse_right_ += events.mouse_right;
  steps.down += whole_steps(mouse_down_, kMouseStep);
  steps.right += whole_steps(mouse_right_, kMouseStep);
  steps.confirm = events.push || events.pad_push;
  steps.back = events.back || events.pad_back || events.pad_pause || events.pad_menu ||
               pressed(Action::settings) % 2 != 0;
  if (scene == nullptr || team < 0) return steps;
  const auto& table = foosball::table_spec(static_cast<foosball::Layout>(scene->layout));
  for (std::size_t i = 0; i < scene->rods.size(); ++i) {
    if (table.rods[i].team != team) continue;
    const wire::RodSnapshot& rod = scene->rods[i];
    if (!rods_known_) {
      slide_[i] = rod.slide;
      angle_[i] = rod.angle;
    }
    double slid = foosball::push_sign(team) * (rod.slide - slide_[i]);
    double spun = -foosball::attack_sign(team) * (rod.angle - angle_[i]);
    const int right = whole_steps(slid, kSlideStep), down = whole_steps(spun, kSpinStep);
    slide_[i] += foosball::push_sign(team) * right * kSlideStep;
    angle_[i] -= foosball::attack_sign(team) * down * kSpinStep;
    steps.right += right;
    steps.down += down;
  }
  rods_known_ = true;
  return steps;
}

void SettingsMenu::toggle() {
  open_ = !open_;
  waits_ = false;
}

std::vector<MenuRow> SettingsMenu::rows(const Settings& s) const {
  std::vector<MenuRow> rows{
      {N_("Volume"), percent(s.volume), false},
      {N_("Quality"), kQualities[static_cast<std::size_t>(s.quality)]},
      {N_("Text size"), percent(s.text_scale), false},
      {N_("Language"), kLanguageNames[static_cast<std::size_t>(s.language)]},
      {N_("View"), kViewNames[static_cast<std::size_t>(s.view)]},
      {N_("Rods in the picture"), kRodsNames[static_cast<std::size_t>(s.rods)]},
      {N_("Teams by pattern and shape"), on_off(s.distinct_teams)},
      {N_("Reduced flashes"), on_off(s.reduced_flashes)},
      {N_("Reduced shake"), on_off(s.reduced_shake)},
      {N_("Assist: automatic rod"), on_off(s.automatic_rod)},
      {N_("Assist: goalie follows"), on_off(s.goalie_follows)},
      {N_("Assist: aim"), on_off(s.aim)},
      {N_("Vibration of gamepads"), on_off(s.vibration)},
      {N_("Questions after a match"), on_off(s.questionnaire)},
  };
  for (std::size_t i = 0; i < s.names.size(); ++i) {
    const bool written = waits_ && row_ == first_name + static_cast<int>(i);
    rows.push_back({N_("Name of player"), written ? draft_ + "_" : name_of_person(s, i), false,
                    static_cast<int>(i) + 1});
    rows.back().typed = true;
  }
  for (std::size_t i = 0; i < s.handle_offset.size(); ++i) {
    rows.push_back({N_("Handle offset of rod"),
                    std::to_string(std::lround(1e3f * s.handle_offset[i])) + " mm", false,
                    static_cast<int>(i) + 1});
  }
  for (std::size_t i = 0; i < kActionLabels.size(); ++i) {
    const bool asked = waits_ && row_ == first_key + static_cast<int>(i);
    rows.push_back({kActionLabels[i], asked ? N_("press a key ...") : keys_text(s.keys[i]), asked});
  }
  return rows;
}

bool SettingsMenu::change(int way, Settings& s) {
  const auto stepped = [&](float& value, float step, float low, float high) {
    value =
        std::clamp(step * std::round((value + static_cast<float>(way) * step) / step), low, high);
  };
  const auto flip = [&](bool& flag) { flag = way % 2 != 0 ? !flag : flag; };
  switch (row_) {
    case row_volume:
      stepped(s.volume, 0.1f, 0.0f, 1.0f);
      break;
    case row_quality:
      turn(s.quality, way, 3);
      break;
    case row_text:
      stepped(s.text_scale, 0.1f, kTextScale[0], kTextScale[1]);
      break;
    case row_language:
      turn(s.language, way, kLanguages);
      break;
    case row_view:
      turn(s.view, way, kViews);
      break;
    case row_rods:
      turn(s.rods, way, kRodsShown);
      break;
    case row_teams:
      flip(s.distinct_teams);
      break;
    case row_flashes:
      flip(s.reduced_flashes);
      break;
    case row_shake:
      flip(s.reduced_shake);
      break;
    case row_automatic:
      flip(s.automatic_rod);
      break;
    case row_goalie:
      flip(s.goalie_follows);
      break;
    case row_aim:
      flip(s.aim);
      break;
    case row_vibration:
      flip(s.vibration);
      break;
    case row_questionnaire:
      flip(s.questionnaire);
      break;
    default:
      if (row_ >= first_key) return false;
      stepped(s.handle_offset[static_cast<std::size_t>(row_ - first_offset)], 0.001f,
              -kHandleOffset, kHandleOffset);
  }
  return true;
}

// Removes the key from all other actions, so that it has one meaning.
bool SettingsMenu::bind(int key, Settings& settings) {
  if (name_of_key(key).empty()) return false;
  for (auto& keys : settings.keys) {
    for (int& bound : keys) bound = bound == key ? 0 : bound;
  }
  auto& keys = settings.keys[static_cast<std::size_t>(row_ - first_key)];
  keys = {key, keys[0] == 0 ? keys[1] : keys[0]};
  return true;
}

bool SettingsMenu::at_name() const {
  return row_ >= first_name && row_ < first_offset;
}

// Adds letters, until Enter or Esc.
bool SettingsMenu::write(const MenuSteps& steps, Settings& settings) {
  if (steps.back) waits_ = false;
  for (const char letter : steps.text) {
    if (!waits_) break;
    if (letter == '\r') {
      waits_ = false;
      std::string& name = settings.names[static_cast<std::size_t>(row_ - first_name)];
      const std::string before =
          std::exchange(name, draft_.empty() ? "" : wire::clean_name(draft_));
      return name != before;
    }
    if (letter != '\b') {
      draft_ += letter;
      continue;
    }
    // The continuation bytes of a UTF-8 character are 10xxxxxx.
    while (!draft_.empty() && (static_cast<unsigned char>(draft_.back()) & 0xC0u) == 0x80u)
      draft_.pop_back();
    if (!draft_.empty()) draft_.pop_back();
  }
  draft_ = wire::clean_text(draft_, wire::kMaxName);
  return false;
}

bool SettingsMenu::step(const MenuSteps& steps, int key, Settings& settings) {
  if (!open_) return false;
  if (waits_ && at_name()) return write(steps, settings);
  if (waits_) {
    if (steps.back || key != 0) waits_ = false;
    return key != 0 && bind(key, settings);
  }
  if (steps.back) {
    open_ = false;
    return false;
  }
  row_ = ((row_ + steps.down) % row_count + row_count) % row_count;
  if (at_name()) {
    waits_ = steps.confirm;
    draft_ = settings.names[static_cast<std::size_t>(row_ - first_name)];
    return false;
  }
  if (steps.confirm && row_ >= first_key) {
    waits_ = true;
    return false;
  }
  const int way = steps.right != 0 ? steps.right : steps.confirm ? 1 : 0;
  return way != 0 && change(way, settings);
}

}  // namespace client
