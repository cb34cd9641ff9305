// The questionnaire after a match, for each person at this client by itself: consent first, then
// six statements, each to be agreed to or not. No drawing here.
//
// Worked as the selection screen is: spin to choose, push to confirm. A cabinet's rods only spin,
// and what has stood still for kStandUs is confirmed: to push one begins the next match. Nothing of
// it is kept unless the person agreed and came to the end; nobody waits for it: whoever does
// nothing for kIdleUs is asked no more, and a new match ends it.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "client/devices.h"
#include "client/input_events.h"
#include "client/settings_menu.h"
#include "wire/control.h"
#include "wire/limits.h"
#include "wire/snapshot.h"

namespace client {

struct SurveyPerson {
  int team = 0;
  std::uint8_t rods = 0;  // that are asked about, by bit
  DeviceSet devices = 0;  // in this person's hands; none: rods of the cabinet
  std::string name;       // of the device, where several are asked: English
  int number = 0;         // after it; 0: none
  bool cabinet() const { return devices == 0; }
};

// What one person sees.
struct SurveyPanel {
  enum class Kind : std::uint8_t { consent, statement, thanks };
  Kind kind = Kind::consent;
  int team = 0;
  std::string name = {};
  int number = 0;
  const char* text = "";  // English: what is asked
  int question = 0;       // statement: which, from 0
  int chosen = 0;         // consent: 0 no, 1 yes, 2 never; statement: 0 none, 1 .. 5
  bool cabinet = false;   // how it is confirmed
  float standing = 0.0f;  // cabinet: share of kStandUs that the choice has stood
};

class Survey {
 public:
  static constexpr std::int64_t kDeafUs = 700'000;  // the hand is still in the match
  static constexpr std::int64_t kStandUs = 2'500'000;
  static constexpr std::int64_t kIdleUs = 20'000'000;
  static constexpr std::int64_t kThanksUs = 2'000'000;

  void ask(std::uint32_t match, std::vector<SurveyPerson> people, std::int64_t now_us);
  void close() { people_.clear(); }
  bool open() const { return !people_.empty(); }
  // Devices whose hands answer, and do nothing else.
  DeviceSet devices(std::int64_t now_us) const;

  struct Outcome {
    std::vector<wire::Answers> answers;
    bool never = false;  // somebody wants to be asked no more
  };
  // One frame. take: what was done with these devices; scene: null while there is none.
  using Take = std::function<InputEvents(DeviceSet)>;
  Outcome update(const Take& take, const wire::Snapshot* scene, std::int64_t now_us);

  std::vector<SurveyPanel> panels(std::int64_t now_us) const;

 private:
  struct Asked {
    SurveyPerson person;
    MenuHand hand;
    int stage = kConsent;  // or which question, from 0; kThanks
    int chosen = 0;
    std::array<std::uint8_t, wire::kQuestionCount> scores{};
    std::int64_t since_us = 0, changed_us = 0;
    bool changed = false;  // at this stage, by the person
    bool over = false;
  };
  static constexpr int kConsent = -1, kThanks = static_cast<int>(wire::kQuestionCount);
  static void go_to(Asked& asked, int stage, std::int64_t now_us);
  static bool deaf(const Asked& asked, std::int64_t now_us);
  void step(Asked& asked, const MenuSteps& steps, int key, std::int64_t now_us, Outcome& outcome);
  void confirm(Asked& asked, std::int64_t now_us, Outcome& outcome);

  std::uint32_t match_ = 0;
  std::vector<Asked> people_;
};

}  // namespace client
