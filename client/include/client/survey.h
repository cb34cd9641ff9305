// The questionnaire after a match, separate for each person at this client: consent first, then six
// statements to agree or disagree with. No drawing here.
//
// It is operated like the selection screen: spin to choose, push to confirm. On a cabinet a person
// only spins the rods, and a choice unchanged for kStandUs is confirmed, because a push there
// begins the next match. Answers are sent only if the person consented and reached the end. Nobody
// has to wait: a person without input for kIdleUs is no longer asked, and a new match ends the
// questionnaire.
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
  std::uint8_t rods = 0;  // rods that are asked about, by bit
  DeviceSet devices = 0;  // this person's devices; none: rods of the cabinet
  std::string name;       // of the device, if several people are asked: English
  int number = 0;         // after the name; 0: none
  bool cabinet() const { return devices == 0; }
};

// What one person sees.
struct SurveyPanel {
  enum class Kind : std::uint8_t { consent, statement, thanks };
  Kind kind = Kind::consent;
  int team = 0;
  std::string name = {};
  int number = 0;
  const char* text = "";  // English: the question
  int question = 0;       // statement: index from 0
  int chosen = 0;         // consent: 0 no, 1 yes, 2 never; statement: 0 none, 1 .. 5
  bool cabinet = false;   // how the choice is confirmed
  float standing = 0.0f;  // cabinet: fraction of kStandUs that the choice has been unchanged
};

class Survey {
 public:
  static constexpr std::int64_t kDeafUs = 700'000;  // no input: person still in the match
  static constexpr std::int64_t kStandUs = 2'500'000;
  static constexpr std::int64_t kIdleUs = 20'000'000;
  static constexpr std::int64_t kThanksUs = 2'000'000;

  void ask(std::uint32_t match, std::vector<SurveyPerson> people, std::int64_t now_us);
  void close() { people_.clear(); }
  bool open() const { return !people_.empty(); }
  // Devices whose input goes to the questionnaire only.
  DeviceSet devices(std::int64_t now_us) const;

  struct Outcome {
    std::vector<wire::Answers> answers;
    bool never = false;  // a person does not want to be asked again
  };
  // Processes one frame. take: returns the input events of these devices; scene: null if there is
  // none.
  using Take = std::function<InputEvents(DeviceSet)>;
  Outcome update(const Take& take, const wire::Snapshot* scene, std::int64_t now_us);

  std::vector<SurveyPanel> panels(std::int64_t now_us) const;

 private:
  struct Asked {
    SurveyPerson person;
    MenuHand hand;
    int stage = kConsent;  // kConsent, the question's index from 0, or kThanks
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
