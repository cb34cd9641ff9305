#include "app/app_impl.h"

namespace client {

// The people who played at this client, with their devices; the cabinet's players by team.
std::vector<SurveyPerson> App::survey_people(std::uint8_t rods) const {
  std::vector<SurveyPerson> people;
  if (!crew_) return people;
  std::uint8_t cabinet = 0;
  for (std::size_t rod = 0; rod < drawn_.rods.size(); ++rod) {
    if (drawn_.rods[rod].source == number(wire::RodSource::cabinet))
      cabinet |= static_cast<std::uint8_t>(rods & 1u << rod);
  }
  const auto names = names_at_rods(seats_, *crew_);
  const auto& table = foosball::table_spec(static_cast<foosball::Layout>(drawn_.layout));
  const auto add = [&](std::uint8_t asked, DeviceSet devices) {
    for (std::size_t rod = 0; rod < drawn_.rods.size(); ++rod) {
      if ((asked >> rod & 1) == 0) continue;
      const bool own = names[rod].translate || !seats_.own_names[rod].empty();
      const bool named = devices != 0 && own;
      people.push_back({table.rods[rod].team, asked, devices, named ? names[rod].text : "",
                        named ? names[rod].number : 0});
      return;
    }
  };
  for (const Crew::Hands& hands : crew_->hands())
    add(static_cast<std::uint8_t>(hands.rods & rods & ~cabinet), crew_->devices_of(hands.device));
  for (int team = 0; team < foosball::kTeams; ++team) {
    std::uint8_t own = 0;
    for (const int rod : foosball::rods_of_team(table, team))
      own |= static_cast<std::uint8_t>(cabinet & 1u << rod);
    add(own, 0);
  }
  return people;
}

// The report that arrived since the match was played is the report of that match.
void App::follow_report() {
  report_ = connection_->report();
  if (report_ && drawn_.screen == number(wire::Screen::play)) report_before_ = report_->match;
}

// Starts the questionnaire after the last goal's replay; a new match ends it.
void App::follow_survey(std::int64_t now) {
  const auto screen = static_cast<wire::Screen>(drawn_.screen);
  const bool between = screen == wire::Screen::end || screen == wire::Screen::logo;
  if (!sample_.any || status_.link != Link::joined || !(between || drawn_.attract)) survey_.close();
  const auto asked = connection_->questionnaire();
  if (!asked || asked->match == surveyed_) return;
  // The message may be ahead of the picture. Once characters are selected again, it is too late.
  if (screen == wire::Screen::selection && !drawn_.attract) surveyed_ = asked->match;
  if (!between || replay_ || menu_.open()) return;
  surveyed_ = asked->match;
  if (settings_.questionnaire) survey_.ask(asked->match, survey_people(asked->rods), now);
}

// False: nobody is asked.
bool App::take_survey_input(std::int64_t now) {
  if (!survey_.open()) return false;
  const auto take = [&](DeviceSet devices) { return window_->input().take(devices); };
  const Survey::Outcome outcome = survey_.update(take, sample_.any ? &sample_.state : nullptr, now);
  for (const wire::Answers& answers : outcome.answers)
    connection_->answer(crew_ ? crew_->session() : 0, answers);
  if (outcome.never) {
    settings_.questionnaire = false;
    change_settings();
  }
  return true;
}

}  // namespace client
