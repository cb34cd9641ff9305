// What a page of the menu shows, and the steps that operate it from any input device.
#pragma once

#include <memory>
#include <string>
#include <vector>

namespace client {

struct MenuRow {
  std::string label, value;  // English; translated when drawn
  bool translate_value = true;
  int number = 0;           // after the label; 0: none
  std::string prefix = {};  // before the label; not translated
  bool translate_label = true;
  bool fixed = false;    // this person cannot change it
  float share = -1.0f;   // 0..1: the value as a fraction of its range; negative: no bar
  float usual = -1.0f;   // the same for the default value
  int value_number = 0;  // after the value; 0: none
  bool typed = false;    // edited by typing, from Enter to Enter
};

// A person's menu input in one frame, as single steps.
struct MenuSteps {
  int down = 0, right = 0;  // negative: up, left
  bool confirm = false, back = false;
  std::string text{};  // typed text, as in InputEvents::text
};

struct DeviceView;  // client/devices_menu.h

struct MenuPage {
  std::string title;          // English
  std::vector<MenuRow> rows;  // empty: closed
  int chosen = 0;
  std::string note;     // about the chosen row: English, translated when drawn
  std::string detail;   // after the note; not translated
  std::string problem;  // an error; not translated
  std::shared_ptr<const DeviceView> device = {};  // shown below the rows; null: none
};

}  // namespace client
