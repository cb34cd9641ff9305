#include "client/tuning_menu.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <string_view>

#include "client/settings.h"
#include "profile/tuning_profile.h"
#include "wire/enums.h"

#define N_(english) english  // for xgettext: render/translate.h

namespace client {
namespace {

enum Row : int { row_profile, row_load, row_save, row_defaults, first_value };
constexpr int kSlots = 5;  // names for profiles that do not exist yet

// 1, 2 or 5 times a power of ten, about a hundredth of the range.
double step_of(const foosball::TuningField& field) {
  const double about = (field.max - field.min) / 100.0;
  const double power = std::pow(10.0, std::floor(std::log10(about)));
  const double mantissa = about / power;
  return power * (mantissa < 1.5 ? 1.0 : mantissa < 3.5 ? 2.0 : mantissa < 7.5 ? 5.0 : 10.0);
}

double stepped(const foosball::TuningField& field, double value, int way) {
  const double step = step_of(field);
  // Integer multiples of the step, rounded to short decimals: no 0.30000000000000004.
  char text[32];
  std::snprintf(text, sizeof text, "%.6g", step * std::round(value / step + way));
  return std::clamp(std::strtod(text, nullptr), field.min, field.max);
}

// In units that give values of a readable size.
struct ShownUnit {
  std::string_view unit;
  const char* shown;
  double factor;
};
constexpr std::array<ShownUnit, 4> kShownUnits{{{"m", "mm", 1e3},
                                                {"kg", "g", 1e3},
                                                {"kg m^2", "kg cm\u00B2", 1e4},
                                                {"m/s^2", "m/s\u00B2", 1.0}}};

ShownUnit shown_unit(const char* unit) {
  const auto* found = std::ranges::find(kShownUnits, std::string_view(unit), &ShownUnit::unit);
  return found != kShownUnits.end() ? *found : ShownUnit{unit, unit, 1.0};
}

std::string number_text(double value) {
  char text[32];
  std::snprintf(text, sizeof text, "%.5g", value);
  return text;
}

std::string value_text(double value, const foosball::TuningField& field) {
  const ShownUnit unit = shown_unit(field.unit);
  const std::string number = number_text(value * unit.factor);
  return *unit.shown == '\0' ? number : number + " " + unit.shown;
}

float share_of(const foosball::TuningField& field, double value) {
  return static_cast<float>((value - field.min) / (field.max - field.min));
}

}  // namespace

std::string tuning_directory() {
  const std::string settings = settings_path();
  if (settings.empty()) return {};
  return (std::filesystem::path(settings).parent_path() / "tuning").string();
}

TuningMenu::TuningMenu(std::string directory) : directory_(std::move(directory)) {
  find_profiles();
}

void TuningMenu::update(std::uint64_t session, const std::optional<foosball::Tuning>& reported,
                        bool may_change) {
  if (session != session_ || !may_change) wants_ = {};
  session_ = session;
  reported_ = reported;
  may_change_ = may_change && reported.has_value();
  for (std::size_t i = 0; reported && i < wants_.size(); ++i) {
    if (wants_[i] && wants_[i]->value == reported.value().*foosball::kTuningFields[i].value)
      wants_[i].reset();
  }
}

void TuningMenu::find_profiles() {
  const std::string now = profile_ < profiles_.size() ? profiles_[profile_] : std::string();
  profiles_.clear();
  std::error_code error;
  for (std::filesystem::directory_iterator it(directory_, error), end; !error && it != end;
       it.increment(error)) {
    std::error_code unknown;
    if (it->path().extension() == ".toml" && it->is_regular_file(unknown) && profiles_.size() < 256)
      profiles_.push_back(it->path().stem().string());
  }
  for (int slot = 1; slot <= kSlots; ++slot) {
    const std::string name = "profile-" + std::to_string(slot);
    if (std::ranges::find(profiles_, name) == profiles_.end()) profiles_.push_back(name);
  }
  std::ranges::sort(profiles_);
  const auto same = std::ranges::find(profiles_, now);
  profile_ = same != profiles_.end() ? static_cast<std::size_t>(same - profiles_.begin()) : 0;
}

int TuningMenu::rows() const {
  return first_value + foosball::kTuningValues;
}

foosball::Tuning TuningMenu::wanted() const {
  foosball::Tuning tuning = reported_.value_or(foosball::Tuning{});
  for (std::size_t i = 0; i < wants_.size(); ++i) {
    if (wants_[i]) tuning.*foosball::kTuningFields[i].value = wants_[i]->value;
  }
  return tuning;
}

std::string TuningMenu::path() const {
  return (std::filesystem::path(directory_) / (profiles_[profile_] + ".toml")).string();
}

MenuPage TuningMenu::page(int chosen) const {
  MenuPage page;
  page.title = N_("Tuning");
  page.chosen = chosen;
  std::error_code error;
  const bool there = !directory_.empty() && std::filesystem::is_regular_file(path(), error);
  page.rows = {{.label = N_("Profile"), .value = profiles_[profile_], .translate_value = false},
               {.label = N_("Load the profile"),
                .value = there ? "" : N_("not saved yet"),
                .fixed = !may_change_ || !there},
               {.label = N_("Save as this profile"), .value = "", .fixed = directory_.empty()},
               {.label = N_("All values to their defaults"), .value = "", .fixed = !may_change_}};
  const foosball::Tuning now = wanted(), usual;
  for (const foosball::TuningField& field : foosball::kTuningFields) {
    const double value = now.*field.value, standard = usual.*field.value;
    MenuRow row{.label = field.name,
                .value = reported_ ? value_text(value, field) : "...",
                .translate_value = false,
                .prefix = value == standard ? "" : "*",
                .translate_label = false,
                .fixed = !may_change_};
    row.share = share_of(field, value);
    row.usual = share_of(field, standard);
    page.rows.push_back(row);
  }
  const int index = chosen - first_value;
  if (index >= 0 && index < foosball::kTuningValues) {
    const foosball::TuningField& field = foosball::kTuningFields[static_cast<std::size_t>(index)];
    page.note = field.meaning;
    const double factor = shown_unit(field.unit).factor;
    page.detail = value_text(usual.*field.value, field) + "  [" + number_text(factor * field.min) +
                  " .. " + number_text(factor * field.max) + "]";
  } else if (!may_change_ && chosen != row_save) {
    page.note = N_("Only the host changes the values; you see them as they are.");
  }
  if (!done_.empty()) page.detail = done_;
  page.problem = problem_;
  return page;
}

void TuningMenu::want(int index, double value) {
  const auto i = static_cast<std::size_t>(index);
  if (reported_ && reported_.value().*foosball::kTuningFields[i].value == value) {
    wants_[i].reset();
  } else {
    wants_[i] = Want{value, 0, 0};
  }
}

void TuningMenu::want_all(const foosball::Tuning& tuning) {
  for (int i = 0; i < foosball::kTuningValues; ++i)
    want(i, tuning.*foosball::kTuningFields[static_cast<std::size_t>(i)].value);
}

void TuningMenu::load() {
  const auto tuning = profile::load_tuning(path());
  if (!tuning) {
    problem_ = tuning.error();
    return;
  }
  want_all(*tuning);
  done_ = path();
}

void TuningMenu::save() {
  if (const auto saved = profile::save_tuning(wanted(), path()); !saved) {
    problem_ = saved.error();
    return;
  }
  done_ = path();
}

void TuningMenu::step(int row, const MenuSteps& steps) {
  if (steps.down != 0 || steps.right != 0 || steps.confirm) problem_.clear(), done_.clear();
  if (row == row_profile) {
    const auto count = static_cast<int>(profiles_.size());
    const int to = static_cast<int>(profile_) + steps.right + (steps.confirm ? 1 : 0);
    profile_ = static_cast<std::size_t>(((to % count) + count) % count);
  }
  if (row == row_save && steps.confirm && !directory_.empty()) save();
  if (!may_change_) return;
  if (row == row_load && steps.confirm) load();
  if (row == row_defaults && steps.confirm) want_all(foosball::Tuning{});
  const int index = row - first_value;
  if (index < 0 || index >= foosball::kTuningValues) return;
  const foosball::TuningField& field = foosball::kTuningFields[static_cast<std::size_t>(index)];
  if (steps.right != 0) want(index, stepped(field, wanted().*field.value, steps.right));
  if (steps.confirm) want(index, foosball::Tuning{}.*field.value);
}

std::vector<wire::MatchRequest> TuningMenu::requests(std::int64_t now_us) {
  if (now_us - last_us_ < kEveryUs) return {};
  for (std::size_t looked = 0; looked < wants_.size(); ++looked) {
    const std::size_t i = (next_ + looked) % wants_.size();
    std::optional<Want>& want = wants_[i];
    if (!want || (want->tries > 0 && now_us - want->asked_us < kAgainUs)) continue;
    if (want->tries == kTries) {
      problem_ = std::string(foosball::kTuningFields[i].name) + ": the server did not take it";
      want.reset();
      continue;
    }
    ++want->tries;
    want->asked_us = last_us_ = now_us;
    next_ = i + 1;
    return {{number(wire::RequestKind::tune), 0, static_cast<std::uint8_t>(i), want->value}};
  }
  return {};
}

}  // namespace client
