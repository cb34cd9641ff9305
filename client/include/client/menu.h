// The menu: pages of settings, seats, tuning, recordings, the game and controllers. Keys, mouse,
// gamepad and rods operate it in the same way. Its first row selects the page.
#pragma once

#include <optional>

#include "client/devices_menu.h"
#include "client/game_menu.h"
#include "client/input_events.h"
#include "client/menu_page.h"
#include "client/seats_menu.h"
#include "client/settings_menu.h"
#include "client/tuning_menu.h"

namespace client {

class Menu {
 public:
  enum class Page : std::uint8_t { settings, seats, tuning, recordings, game, controllers };
  static constexpr int kPages = 6;

  explicit Menu(std::string profiles) : tuning_(std::move(profiles)) {}

  bool open() const { return open_; }
  bool shows(Page page) const { return open_ && page_ == page; }
  // The page's key was pressed: opens the page, or closes the menu if it shows this page.
  void toggle(Page page);
  bool waits_for_key() const {
    return open_ && page_ == Page::settings && settings_.waits_for_key();
  }
  TuningMenu& tuning() { return tuning_; }
  GameMenu& game() { return game_; }
  DevicesMenu& devices() { return devices_; }

  struct Context {
    Settings& settings;
    const SeatsView& seats;
    Crew* crew;  // null: not joined
  };
  struct Outcome {
    bool settings_changed = false;
    bool watch_recordings = false;  // open the list of recordings
    SeatsAsked asked;
  };
  // key: pressed in this frame; 0: none.
  Outcome step(const MenuSteps& steps, int key, const Context& context);
  MenuPage page(const Context& context) const;  // no rows: closed

 private:
  int rows(const Context& context) const;
  void go_to(Page page);

  bool open_ = false;
  Page page_ = Page::settings;
  int row_ = 0;  // 0: the row that selects the page
  SettingsMenu settings_;
  SeatsMenu seats_;
  TuningMenu tuning_;
  GameMenu game_;
  DevicesMenu devices_;
};

}  // namespace client
