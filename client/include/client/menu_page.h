// What a page of the menu shows, and the steps by which it is worked, whatever a person has in
// hand.
#pragma once

#include <memory>
#include <string>
#include <vector>

namespace client {

struct MenuRow {
  std::string label, value;  // English; the screen translates
  bool translate_value = true;
  int number = 0;           // after the label; 0: none
  std::string prefix = {};  // before the label, as it is
  bool translate_label = true;
  bool fixed = false;    // cannot be changed by this person
  float share = -1.0f;   // 0..1: where the value lies in its range; negative: no bar
  float usual = -1.0f;   // ... and where its default does
  int value_number = 0;  // after the value; 0: none
  bool typed = false;    // by letters, from Enter to Enter
};

// One step at a time: what a person asks of a menu in a frame.
struct MenuSteps {
  int down = 0, right = 0;  // negative: up, left
  bool confirm = false, back = false;
  std::string text{};  // typed, as InputEvents::text
};

struct DeviceView;  // client/devices_menu.h

struct MenuPage {
  std::string title;          // English
  std::vector<MenuRow> rows;  // empty: closed
  int chosen = 0;
  std::string note;                               // about the chosen row: English, translated
  std::string detail;                             // ... and after it, as it is
  std::string problem;                            // what went wrong, as it is
  std::shared_ptr<const DeviceView> device = {};  // shown below the rows; null: none
};

}  // namespace client
