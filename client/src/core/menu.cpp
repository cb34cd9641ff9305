#include "client/menu.h"

#include <algorithm>
#include <utility>

#include "wire/enums.h"

#define N_(english) english  // for xgettext: render/translate.h

namespace client {
namespace {

enum RecordingsRow : int { row_watch, row_record, recordings_rows };

MenuPage recordings_page(const Settings& settings, int row) {
  MenuPage page;
  page.rows = {{N_("Watch recorded matches"), ""},
               {N_("Record what is played"), settings.record_matches ? N_("on") : N_("off")}};
  page.note = row == row_record
                  ? N_("from the next start of the game on; the oldest recordings are deleted, "
                       "except those that you keep or share")
                  : N_("opens the list: watch, slow motion, goals, share; the match waits");
  return page;
}

}  // namespace

void Menu::toggle(Page page) {
  open_ = !open_ || page != page_;
  if (settings_.open() != (open_ && page == Page::settings)) settings_.toggle();
  if (open_ && page != page_) row_ = 1;
  page_ = page;
  row_ = std::max(row_, 1);
  if (page == Page::tuning) tuning_.find_profiles();
}

void Menu::go_to(Page page) {
  open_ = false;
  page_ = page;
  toggle(page);
  row_ = 0;
}

int Menu::rows(const Context& context) const {
  int rows = 0;
  if (page_ == Page::settings) rows = static_cast<int>(settings_.rows(context.settings).size());
  if (page_ == Page::seats && context.crew != nullptr) rows = seats_.rows(context.seats);
  if (page_ == Page::tuning) rows = tuning_.rows();
  if (page_ == Page::recordings) rows = recordings_rows;
  if (page_ == Page::game) rows = game_.rows();
  if (page_ == Page::controllers) rows = devices_.rows();
  return rows + 1;
}

Menu::Outcome Menu::step(const MenuSteps& steps, int key, const Context& context) {
  Outcome outcome;
  if (!open_) return outcome;
  if (!waits_for_key()) {
    if (steps.back) {
      toggle(page_);
      return outcome;
    }
    const int count = rows(context);
    row_ = ((std::min(row_, count - 1) + steps.down) % count + count) % count;
  }
  MenuSteps inside = steps;
  inside.down = 0;
  if (row_ == 0) {
    const int way = steps.right != 0 ? steps.right : steps.confirm ? 1 : 0;
    if (way != 0)
      go_to(static_cast<Page>(((static_cast<int>(page_) + way) % kPages + kPages) % kPages));
    return outcome;
  }
  if (page_ == Page::settings) {
    if (!settings_.waits_for_key()) settings_.select(row_ - 1);
    outcome.settings_changed = settings_.step(inside, key, context.settings);
  } else if (page_ == Page::seats && context.crew != nullptr) {
    outcome.asked = seats_.step(context.seats, row_ - 1, inside, *context.crew);
  } else if (page_ == Page::tuning) {
    tuning_.step(row_ - 1, inside);
  } else if (page_ == Page::game) {
    if (game_.step(row_ - 1, inside))
      outcome.asked.requests.push_back({number(wire::RequestKind::restart), 0, 0});
  } else if (page_ == Page::recordings) {
    const bool changes = inside.right % 2 != 0 || inside.confirm;
    outcome.watch_recordings = row_ - 1 == row_watch && inside.confirm;
    outcome.settings_changed = row_ - 1 == row_record && changes;
    if (outcome.settings_changed)
      context.settings.record_matches = !context.settings.record_matches;
  }
  return outcome;
}

MenuPage Menu::page(const Context& context) const {
  constexpr std::array<const char*, kPages> kTitles{
      N_("Settings"), N_("Seats"), N_("Tuning"), N_("Recordings"), N_("Game"), N_("Controllers")};
  MenuPage page;
  if (!open_) return page;
  if (page_ == Page::settings) page.rows = settings_.rows(context.settings);
  if (page_ == Page::settings && settings_.at_name())
    page.note =
        N_("Press Enter, type the name, press Enter again. Results and ratings use it from the "
           "next match on.");
  if (page_ == Page::seats && context.crew != nullptr)
    page = seats_.page(context.seats, *context.crew, row_ - 1);
  if (page_ == Page::tuning) page = tuning_.page(row_ - 1);
  if (page_ == Page::recordings) page = recordings_page(context.settings, row_ - 1);
  if (page_ == Page::game) page = game_.page(row_ - 1);
  if (page_ == Page::controllers) page = devices_.page(row_ - 1);
  page.title = kTitles[static_cast<std::size_t>(page_)];
  page.rows.insert(page.rows.begin(), MenuRow{.label = N_("Page"), .value = page.title});
  page.chosen = row_;
  return page;
}

}  // namespace client
