// The computer player with levels and styles: combines sight, screens and mind.
#include <cmath>
#include <optional>

#include "computer_forecast.h"
#include "computer_impl.h"
#include "computer_mind.h"
#include "computer_screens.h"

namespace foosball {
namespace {

class LevelPlayer final : public ComputerPlayer::Impl {
 public:
  LevelPlayer(const ComputerPlayerDesc& d, const Temperament& t)
      : team_(d.team == 0 ? 0 : 1),
        random_(d.seed),
        screens_(team_, d.opens_match),
        sight_(team_, static_cast<int>(std::lround(t.delay / kTick))),
        mind_(team_, t, d.seed) {
    if (t.forecast_ticks > 0) {
      forecast_.emplace(team_, static_cast<int>(std::lround(t.delay / kTick)), t.forecast_ticks);
    }
  }

  void play(const MatchView& view, RodTargets& targets, std::uint8_t rods) override;
  PlayedPass passed() const override { return mind_.passed(); }

 private:
  void come_to(const MatchView& view);
  void hold_or_adopt(const MatchView& view);
  bool whole_team() const { return lines_ == kAllLines; }
  void think(const MatchView& view);
  void act(const MatchView& view, bool at_screen, RodTargets& targets);
  void let_go();

  int team_;
  Random random_;
  ComputerScreens screens_;
  ComputerSight sight_;
  ComputerMind mind_;
  std::optional<BallForecast> forecast_;
  std::uint8_t lines_ = 0, before_ = 0;  // its lines now and in the previous tick, as bits by Line
  Screen screen_ = Screen::logo;
};

void LevelPlayer::play(const MatchView& view, RodTargets& targets, std::uint8_t rods) {
  if (forecast_) forecast_->set_table(view.layout, view.bodies, view.tuning);
  lines_ = lines_of(view.layout, team_, rods);
  if (lines_ == 0) return let_go();
  mind_.keep_to(lines_);
  come_to(view);
  sight_.look(view);
  const bool at_screen = !view.paused && ComputerScreens::worked_at(view.screen);
  if (at_screen) {
    ComputerRod& own = mind_.rods()[ComputerScreens::kRod];
    if (whole_team()) screens_.work(view, own.slide(), own.swing());
    mind_.rest();
  } else if (!view.paused) {
    think(view);
  }
  act(view, at_screen, targets);
  if (!forecast_) return;
  if (view.paused || at_screen) forecast_->forget();
  forecast_->act(targets, rods);
}

void LevelPlayer::think(const MatchView& view) {
  std::optional<BallGuess> ball;
  if (forecast_) {
    forecast_->see(sight_.seen());
    ball = forecast_->ball();
  }
  mind_.play(sight_.seen(), view.tuning, view.next_server == team_, ball);
}

void LevelPlayer::act(const MatchView& view, bool at_screen, RodTargets& targets) {
  for (int line = 0; line < 4; ++line) {
    if (!mind_.may_hold(line)) continue;
    ComputerRod& rod = mind_.rods()[line];
    const bool screen_rod = whole_team() && line == ComputerScreens::kRod;
    RodTarget& target = targets[rod.index()];
    target = {team_slide(team_, rod.slide().position()), team_swing(team_, rod.swing().position()),
              team_slide(team_, rod.slide().rate()), team_swing(team_, rod.swing().rate()),
              at_screen ? screen_rod : mind_.holds(line)};
    if (view.paused) target.slide_rate = target.angle_rate = 0.0;
  }
}

// Without rods, discards its knowledge: it would be out of date later.
void LevelPlayer::let_go() {
  if (before_ == 0) return;
  before_ = 0;
  sight_.forget();
  mind_.rest();
  if (forecast_) forecast_->forget();
}

// Handles a new screen; at the start of play also new characters.
void LevelPlayer::come_to(const MatchView& view) {
  const bool play_begins = screen_ != view.screen && view.screen == Screen::play;
  if (before_ == 0 || play_begins) mind_.set_table(view.layout, view.bodies);
  screen_ = view.screen;
  screens_.see(view, mind_.rods()[ComputerScreens::kRod].swing().position(), random_);
  hold_or_adopt(view);
  before_ = lines_;
}

// Takes over a rod at its current position when it becomes its own, or when something else has
// moved it far away.
void LevelPlayer::hold_or_adopt(const MatchView& view) {
  for (int line = 0; line < 4; ++line) {
    ComputerRod& rod = mind_.rods()[line];
    const RodState& state = view.rods[rod.index()];
    const double slide = team_slide(team_, state.slide);
    const double swing = team_swing(team_, state.angle);
    const bool far = std::fabs(slide - rod.slide().position()) > 0.15 ||
                     std::fabs(swing - rod.swing().position()) > vp::kPi;
    if ((before_ >> line & 1) == 0 || far) rod.adopt(slide, swing);
  }
}

}  // namespace

std::unique_ptr<ComputerPlayer::Impl> make_level_player(const ComputerPlayerDesc& desc) {
  Temperament t = temperament_of(desc.player.level, desc.player.style);
  if (desc.judgment) t.judgment = *desc.judgment;
  return std::make_unique<LevelPlayer>(desc, t);
}

}  // namespace foosball
