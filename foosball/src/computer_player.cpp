#include "foosball/computer_player.h"

#include <cmath>

#include "computer_sight.h"
#include "random.h"
#include "rod_tactics.h"

namespace foosball {
namespace {

// The rod that works the screens: the midfield, in the middle of what the player sees.
constexpr int kScreenRod = static_cast<int>(Line::midfield);
constexpr AxisLimits kCalmSlide{0.5, 8.0};
constexpr AxisLimits kCalmSwing{8.0, 80.0};

}  // namespace

struct ComputerPlayer::Impl {
  explicit Impl(const ComputerPlayerDesc& d)
      : team(d.team == 0 ? 0 : 1),
        temper(temper_of(std::isfinite(d.skill) ? d.skill : 0.0)),
        random(d.seed),
        opens_match(d.opens_match),
        sight(team, static_cast<int>(temper.delay / kTick)) {}

  int team;
  Temper temper;
  Random random;
  bool opens_match;
  ComputerSight sight;
  std::vector<RodTactics> rods;  // from its own goal outwards
  Layout layout = Layout::tournament;
  Screen screen = Screen::logo;
  int wanted_character = 0;
  double spin_to = 0.0;

  void play(const MatchView& view, RodTargets& targets);
  void come_to(const MatchView& view);
  void hold_or_adopt(const MatchView& view);
  void work_logo(const MatchView& view);
  void work_selection(const MatchView& view);
  void push(double seconds);
};

void ComputerPlayer::Impl::play(const MatchView& view, RodTargets& targets) {
  come_to(view);
  sight.look(view);
  const TableSpec& table = table_spec(view.layout);
  if (!view.paused) {
    switch (view.screen) {
      case Screen::logo:
        work_logo(view);
        break;
      case Screen::selection:
        work_selection(view);
        break;
      default:
        for (RodTactics& rod : rods) rod.play(table, sight.now(), temper, random);
    }
  }
  const auto indices = rods_of_team(table, team);
  for (std::size_t line = 0; line < rods.size(); ++line) {
    const HandAxis& slide = rods[line].slide();
    const HandAxis& swing = rods[line].swing();
    RodTarget& target = targets[indices[line]];
    target = {team_slide(team, slide.position()), team_swing(team, swing.position()),
              team_slide(team, slide.rate()), team_swing(team, swing.rate()), true};
    if (view.paused) target.slide_rate = target.angle_rate = 0.0;
  }
}

// A new table or a new screen.
void ComputerPlayer::Impl::come_to(const MatchView& view) {
  if (rods.empty() || layout != view.layout) {
    layout = view.layout;
    rods.clear();
    for (const int rod : rods_of_team(table_spec(layout), team)) rods.emplace_back(team, rod);
  }
  if (screen != view.screen && view.screen == Screen::selection) {
    wanted_character = random.below(view.characters);
    spin_to = rods[kScreenRod].swing().position();
  }
  screen = view.screen;
  hold_or_adopt(view);
}

// Takes each rod over where it is: at first, and when something else has moved it far off.
void ComputerPlayer::Impl::hold_or_adopt(const MatchView& view) {
  const auto indices = rods_of_team(table_spec(layout), team);
  for (std::size_t line = 0; line < rods.size(); ++line) {
    RodTactics& rod = rods[line];
    const RodState& state = view.rods[indices[line]];
    const double slide = team_slide(team, state.slide);
    const double swing = team_swing(team, state.angle);
    const bool far = std::fabs(slide - rod.slide().position()) > 0.15 ||
                     std::fabs(swing - rod.swing().position()) > vp::kPi;
    if (!rod.adopted() || far) rod.adopt(slide, swing);
  }
}

// Draws the rod back, pushes, and lets it return; again every two seconds until it is heard.
void ComputerPlayer::Impl::push(double seconds) {
  const double phase = std::fmod(seconds, 2.0);
  const double goal = phase < 0.3 ? 0.0 : phase < 0.7 ? 0.06 : 0.0;
  // In the team's frame a push is towards +y for either team.
  rods[kScreenRod].slide().move(goal, kCalmSlide);
}

void ComputerPlayer::Impl::work_logo(const MatchView& view) {
  constexpr double kLookAtLogo = 0.5;  // [s]
  if (opens_match && view.screen_seconds > kLookAtLogo) push(view.screen_seconds - kLookAtLogo);
}

void ComputerPlayer::Impl::work_selection(const MatchView& view) {
  constexpr double kLookAround = 0.4;                       // [s]
  constexpr double kOneChoice = 2.0 * vp::kPi / 3.0 + 0.1;  // a little beyond a third of a turn
  if (view.confirmed[team] || view.screen_seconds < kLookAround) {
    rods[kScreenRod].slide().move(0.0, kCalmSlide);
    return;
  }
  HandAxis& swing = rods[kScreenRod].swing();
  if (view.character[team] == wanted_character) return push(view.screen_seconds - kLookAround);
  const bool settled = std::fabs(swing.position() - spin_to) < 0.01;
  if (settled) spin_to += kOneChoice;
  swing.move(spin_to, kCalmSwing);
}

ComputerPlayer::ComputerPlayer(const ComputerPlayerDesc& desc)
    : impl_(std::make_unique<Impl>(desc)) {}
ComputerPlayer::~ComputerPlayer() = default;
ComputerPlayer::ComputerPlayer(ComputerPlayer&&) noexcept = default;
ComputerPlayer& ComputerPlayer::operator=(ComputerPlayer&&) noexcept = default;

void ComputerPlayer::play(const MatchView& view, RodTargets& targets) {
  impl_->play(view, targets);
}

}  // namespace foosball
