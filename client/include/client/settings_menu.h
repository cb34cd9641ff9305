// The settings screen as rows that steps select and change. MenuSteps has one form for keys, mouse,
// gamepad and rods. No drawing here.
#pragma once

#include <string>
#include <vector>

#include "client/input_events.h"
#include "client/menu_page.h"
#include "client/settings.h"
#include "wire/snapshot.h"

namespace client {

// Converts a frame's events to steps: arrows, wheel, mouse motion, a gamepad's D-pad and a team's
// rods. Spinning any rod by kSpinStep goes to the next row; sliding it by kSlideStep changes the
// value. A held direction repeats after kHoldUs.
class MenuHand {
 public:
  static constexpr double kMouseStep = 60.0;  // [px]
  static constexpr double kSpinStep = 0.7;    // [rad]
  static constexpr double kSlideStep = 0.04;  // [m]
  static constexpr std::int64_t kHoldUs = 400'000, kRepeatUs = 60'000;
  // scene: null if there is none; team: -1 for a person without rods.
  MenuSteps steps(const InputEvents& events, const wire::Snapshot* scene, int team,
                  std::int64_t now_us = 0);
  void restart();

 private:
  // Number of steps that a held direction makes now.
  struct Held {
    int way = 0;
    std::int64_t next_us = 0;
    int steps(int held, std::int64_t now_us);
  };
  Held held_down_, held_right_;
  double mouse_down_ = 0.0, mouse_right_ = 0.0;
  bool rods_known_ = false;
  std::array<double, 8> slide_{}, angle_{};
};

class SettingsMenu {
 public:
  bool open() const { return open_; }
  void toggle();
  int row() const { return row_; }
  void select(int row) { row_ = row; }                    // precondition: the row exists
  bool at_name() const;                                   // of a person, which is typed
  bool waits_for_key() const { return open_ && waits_; }  // or for letters
  std::vector<MenuRow> rows(const Settings& settings) const;
  // key: pressed in this frame, 0: none; used by a row of the controls that waits for a key. A row
  // of a name takes letters until Enter. True if the settings changed.
  bool step(const MenuSteps& steps, int key, Settings& settings);

 private:
  bool change(int way, Settings& settings);
  bool bind(int key, Settings& settings);
  bool write(const MenuSteps& steps, Settings& settings);

  bool open_ = false, waits_ = false;
  int row_ = 0;
  std::string draft_;  // the name being typed
};

}  // namespace client
