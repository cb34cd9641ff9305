#include "client/survey.h"

#include <algorithm>

#define N_(english) english  // for xgettext: render/translate.h

namespace client {
namespace {

// By question: docs/questionnaire.md. The same as results::kQuestionnaire; a test compares them.
constexpr std::array<const char*, wire::kQuestionCount> kStatements{
    N_("Playing was fun."),
    N_("I knew at once how to move the figures."),
    N_("The figures did what my hands did."),
    N_("The ball moved as I expected it to."),
    N_("I could always see where the ball was, and how high."),
    N_("I thought of the game only, not of its controls.")};

enum Consent : int { consent_no, consent_yes, consent_never };

// The score of a key; 0: no score key.
int score_of_key(int key) {
  return key >= '1' && key <= '0' + wire::kMaxScore ? key - '0' : 0;
}

}  // namespace

void Survey::ask(std::uint32_t match, std::vector<SurveyPerson> people, std::int64_t now_us) {
  match_ = match;
  people_.clear();
  for (SurveyPerson& person : people) {
    Asked asked;
    asked.person = std::move(person);
    asked.since_us = asked.changed_us = now_us;
    people_.push_back(std::move(asked));
  }
}

// While a panel ignores input, its devices keep their previous function.
DeviceSet Survey::devices(std::int64_t now_us) const {
  DeviceSet devices = 0;
  for (const Asked& asked : people_) {
    if (asked.stage != kThanks && !deaf(asked, now_us))
      devices = static_cast<DeviceSet>(devices | asked.person.devices);
  }
  return devices;
}

void Survey::go_to(Asked& asked, int stage, std::int64_t now_us) {
  asked.stage = stage;
  asked.chosen = stage >= 0 && stage < kThanks ? asked.scores[static_cast<std::size_t>(stage)] : 0;
  asked.changed = false;
  asked.changed_us = now_us;
}

bool Survey::deaf(const Asked& asked, std::int64_t now_us) {
  return now_us - asked.since_us < kDeafUs;
}

Survey::Outcome Survey::update(const Take& take, const wire::Snapshot* scene, std::int64_t now_us) {
  Outcome outcome;
  for (Asked& asked : people_) {
    const SurveyPerson& person = asked.person;
    InputEvents events = person.cabinet() ? InputEvents{} : take(person.devices);
    const int wheel = events.wheel, key = events.any_key;
    events.wheel = 0;
    events.mouse_forward = 0.0;
    MenuSteps steps = asked.hand.steps(events, person.cabinet() ? scene : nullptr,
                                       person.cabinet() ? person.team : -1, now_us);
    steps.right += wheel;
    if (person.cabinet()) steps = {.right = steps.down};  // slides go on to the match
    if (!deaf(asked, now_us)) step(asked, steps, key, now_us, outcome);
  }
  std::erase_if(people_, [](const Asked& asked) { return asked.over; });
  if (outcome.never) close();
  return outcome;
}

void Survey::step(Asked& asked, const MenuSteps& steps, int key, std::int64_t now_us,
                  Outcome& outcome) {
  const std::int64_t since = now_us - asked.changed_us;
  if (asked.stage == kThanks) {
    asked.over = since >= kThanksUs;
    return;
  }
  if (steps.back || since >= kIdleUs) {
    asked.over = true;
    return;
  }
  const bool consent = asked.stage == kConsent;
  const int max = consent ? consent_never : static_cast<int>(wire::kMaxScore);
  int chosen = std::clamp(asked.chosen + steps.right, 0, max);
  if (!consent && score_of_key(key) > 0) chosen = score_of_key(key);
  if (chosen != asked.chosen) {
    asked.chosen = chosen;
    asked.changed = true;
    asked.changed_us = now_us;
  }
  if (steps.down < 0 && asked.stage > 0) return go_to(asked, asked.stage - 1, now_us);
  const bool stood =
      asked.person.cabinet() && asked.changed && now_us - asked.changed_us >= kStandUs;
  if (steps.confirm || stood) confirm(asked, now_us, outcome);
}

void Survey::confirm(Asked& asked, std::int64_t now_us, Outcome& outcome) {
  if (asked.stage == kConsent) {
    outcome.never = outcome.never || asked.chosen == consent_never;
    asked.over = asked.chosen != consent_yes;
    return go_to(asked, 0, now_us);
  }
  asked.scores[static_cast<std::size_t>(asked.stage)] = static_cast<std::uint8_t>(asked.chosen);
  go_to(asked, asked.stage + 1, now_us);
  if (asked.stage != kThanks) return;
  const bool any = std::ranges::any_of(asked.scores, [](std::uint8_t score) { return score > 0; });
  if (any) outcome.answers.push_back({match_, asked.person.rods, asked.scores});
  asked.over = !any;
}

std::vector<SurveyPanel> Survey::panels(std::int64_t now_us) const {
  std::vector<SurveyPanel> panels;
  for (const Asked& asked : people_) {
    SurveyPanel panel;
    panel.team = asked.person.team;
    panel.name = asked.person.name;
    panel.number = asked.person.number;
    panel.chosen = asked.chosen;
    panel.cabinet = asked.person.cabinet();
    if (panel.cabinet && asked.changed)
      panel.standing = std::min(
          1.0f, static_cast<float>(now_us - asked.changed_us) / static_cast<float>(kStandUs));
    if (asked.stage == kConsent) {
      panel.text = N_("Six short questions about this match?");
    } else if (asked.stage == kThanks) {
      panel.kind = SurveyPanel::Kind::thanks;
      panel.text = N_("Thank you!");
    } else {
      panel.kind = SurveyPanel::Kind::statement;
      panel.question = asked.stage;
      panel.text = kStatements[static_cast<std::size_t>(asked.stage)];
    }
    panels.push_back(std::move(panel));
  }
  return panels;
}

}  // namespace client
